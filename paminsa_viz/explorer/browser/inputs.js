/**
 * Runs in the head of the page: every input sends its newest value, at most once in each picture of
 * the browser.
 *
 * viser sends one message of all inputs every 50 ms: a robot that is dragged would move 20 times a
 * second, and of two inputs set within that time the first would be lost.
 */
(() => {
  "use strict";
  const HIDDEN_PERIOD = 100; // a tab that is not seen has no pictures [ms]
  const newest = new Map(); // of an input's uuid, the value that is still to be sent
  const ours = new Set(); // uuids of inputs whose values are sent here
  let raw = null; // viser's own sender
  let isWaiting = false;

  const flush = () => {
    for (const [uuid, value] of newest)
      raw?.({ type: "GuiUpdateMessage", uuid, updates: { value } });
    newest.clear();
  };
  const next = () => {
    let isDone = false;
    const go = () => {
      if (isDone) return;
      isDone = true;
      isWaiting = newest.size > 0;
      flush();
      if (isWaiting) next();
    };
    requestAnimationFrame(go);
    setTimeout(go, HIDDEN_PERIOD);
  };
  const take = (uuid, value) => {
    ours.add(uuid);
    newest.set(uuid, value);
    if (isWaiting) return;
    isWaiting = true;
    flush();
    next();
  };
  /** What viser sends later of a value has been sent here; all else comes after the values. */
  const send = (message) => {
    if (message.type === "GuiUpdateMessage" && ours.has(message.uuid)) return;
    flush();
    raw(message);
  };

  window.paminsaInputs = { works: () => raw !== null };
  window.paminsaContext.whenFound(({ guiActions, mutable }) => {
    const update = guiActions?.updateGuiProps;
    if (!update || !mutable?.current) return;
    guiActions.updateGuiProps = (uuid, updates) => {
      update(uuid, updates);
      if ("value" in updates) take(uuid, updates.value);
    };
    raw = mutable.current.sendMessage;
    // viser gives itself another sender with every connection.
    Object.defineProperty(mutable.current, "sendMessage", {
      configurable: true, enumerable: true, get: () => send, set: (sender) => { raw = sender; },
    });
  });
})();
