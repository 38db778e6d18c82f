/**
 * Links: what follows the # of the address is a share code and what is shown, which the page opens and
 * keeps up to date.
 *
 * Runs in the head of the page: viser takes the address of the server from that of the page, where
 * no # may be, and writes it anew. So the code is taken out first, and put back once viser has begun.
 * An address that this tab has written itself is no link to open: after a reload the tab's own store
 * knows more than the code does.
 */
(() => {
  "use strict";
  const KEY = "@STORE@_link";
  const LONGEST = Number("@LONGEST@"); // one character more than is read, so that it is refused
  const DELAY = 300; // browsers refuse an address that is written in quick succession
  const coded = () => {
    let text = window.location.hash.slice(1, LONGEST + 1);
    try {
      text = decodeURIComponent(text);
    } catch (error) {
      console.warn(error);
    }
    return /^\s*PMZ/.test(text) ? text : "";
  };
  // The newest first. A reload just after an address was written may still load the one before.
  const MOST = 3;
  let written = [];
  try {
    written = (sessionStorage.getItem(KEY) ?? "").split("\n");
  } catch (error) {
    console.warn(error);
  }
  const isReload = performance.getEntriesByType("navigation")[0]?.type === "reload";
  const foreign = (own) => (own.includes(coded()) ? "" : coded());
  const write = (hash) => {
    const { pathname, search } = window.location;
    window.history.replaceState(window.history.state, "", `${pathname}${search}${hash}`);
  };
  let waiting = foreign(isReload ? written : written.slice(0, 1));
  let removed = window.location.hash;
  if (window.location.href.includes("#")) write(""); // one that nothing follows too
  const take = () => {
    if (removed && !window.location.hash) write(removed);
    removed = "";
    const code = waiting;
    waiting = "";
    return code;
  };
  window.addEventListener("hashchange", () => {
    waiting = foreign(written.slice(0, 1));
    window.paminsa?.openLink();
  });

  let timer = 0;
  let wrote = false; // since the page was opened
  const follow = (code) => {
    clearTimeout(timer);
    timer = setTimeout(() => {
      written = [...new Set([code, ...written])].slice(0, MOST);
      try {
        write(`#${encodeURI(code)}`);
        wrote = true;
        sessionStorage.setItem(KEY, written.join("\n"));
      } catch (error) {
        console.warn(error);
      }
    }, DELAY);
  };
  // Without what follows a ?: it says how this page is shown, and may be an access token.
  const to = (code) => `${window.location.href.split(/[?#]/)[0]}#${encodeURI(code)}`;
  /** Return whether viser leaves the address as it was written, null where nothing was yet. */
  const keeps = () => (wrote ? Boolean(window.location.hash) : null);
  window.paminsaLinks = { take, follow, to, keeps };
})();
