/**
 * Runs in the head of the page: an attempt to connect again may take its time.
 *
 * viser begins one every second and with it ends the one before. Chromium holds back each by up to
 * five seconds once some ten have failed, so that a page whose server was away for longer would never
 * connect again. Here the next one waits until viser's worker has reported the end of the last one,
 * which it ends itself after five seconds.
 */
(() => {
  "use strict";
  const BEGINS = ["set_server", "retry"];
  const ENDS = ["connected", "closed"];
  const trying = new WeakMap(); // of a worker that connects, whether an attempt goes on
  let isKnown = false;
  const { postMessage } = Worker.prototype;
  Worker.prototype.postMessage = function (message, ...rest) {
    if (BEGINS.includes(message?.type)) {
      if (message.type === "retry" && trying.get(this)) return;
      if (!trying.has(this))
        this.addEventListener("message", ({ data }) => {
          if (ENDS.includes(data?.type)) trying.set(this, false);
        });
      trying.set(this, true);
      isKnown = true;
    }
    postMessage.call(this, message, ...rest);
  };
  window.paminsaReconnect = { works: () => isKnown };
})();
