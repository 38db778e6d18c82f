/**
 * The page's side of a session: everything in a browser tab that viser has no interface for.
 *
 * Here are its messages and what it says when it begins; each of the other parts has a script of its
 * own. Names of viser, Plotly, uPlot and Mantine that are not public are read in these scripts and in
 * page.css; self_test.js names them.
 */
(config) => {
  "use strict";
  window.paminsa?.stop(); // a tab that has connected again is set up again
  const stopped = new AbortController();
  const { signal } = stopped;
  const timers = [];
  const every = (period, run) => timers.push(setInterval(run, period));
  const viewer = () => window.__viserMutable || {};

  // --- messages to the server ---------------------------------------------------------------
  // They are the text of a hidden input. It holds only the newest text, and one that follows
  // another at once would take its place before it is read: so each repeats the last few.
  const recent = [];
  let count = 0;
  // A tab that connects again has the inputs of another session long before its script comes: till
  // then there is no inbox, and what the page shows is not what was left open.
  const isCurrent = () => {
    const inputs = window.paminsaContext?.get()?.useGuiConfig;
    return !inputs || inputs.get(config.inbox) !== undefined;
  };
  const send = (kind, data) => {
    if (!viewer().sendMessage || !isCurrent()) return false;
    recent.push([++count, kind, data]);
    while (recent.length > 4) recent.shift();
    const updates = { value: JSON.stringify(recent) };
    viewer().sendMessage({ type: "GuiUpdateMessage", uuid: config.inbox, updates });
    return true;
  };
  const retry = (attempt, period) => {
    if (!signal.aborted && !attempt()) setTimeout(() => retry(attempt, period), period);
  };

  // A folded panel takes what it holds off the page, and the view needs its colors still.
  retry(() => {
    const sheet = document.body.querySelector("style[data-paminsa]");
    if (!sheet) return false;
    document.head.querySelector("style[data-paminsa]")?.remove();
    document.head.append(sheet);
    return true;
  }, 50);

  // --- its parts ----------------------------------------------------------------------------
  const search = ".mantine-Spotlight-search";
  const page = { every, retry, send, viewer, search, signal };
  const docks = window.paminsaDocks({ ...page, foldedDock: config.foldedDock });
  const tabs = window.paminsaTabs({
    ...page,
    key: `${config.storeKey}_tabs`,
    names: config.tabs,
    isWhole: () => docks.isWhole() && isCurrent(),
  });
  window.paminsaFiles({ ...page, largest: config.largestFile });
  window.paminsaFocus(page);
  window.paminsaFolders(page);
  window.paminsaKeys(page);
  window.paminsaLost(page);
  const palette = window.paminsaPalette(page);
  const figures = window.paminsaFigures(page);
  const time = window.paminsaTimeCursor({ ...page, ...figures });
  window.paminsaCursor?.follow({ ...page, placeUnder: figures.placeUnder, timeUnder: time.timeUnder });
  window.paminsaSelfTest({ ...page, missingAfter: config.missingAfter });

  // --- what it says when it begins ----------------------------------------------------------
  let saved = null;
  try {
    saved = sessionStorage.getItem(config.storeKey);
  } catch (error) {
    console.warn(error);
  }
  // The camera counts the view's own pixels, of which a sharp screen has several for each of these.
  const sendSize = () => send("window", [window.innerWidth, window.innerHeight]);
  let resized = 0;
  window.addEventListener("resize", () => {
    clearTimeout(resized);
    resized = setTimeout(sendSize, 200);
  }, { signal });

  retry(() => viewer().canvas && send("graphics", window.paminsaDrawing?.named() ?? ""), 200);

  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const sendScheme = () => send("scheme", dark.matches);
  dark.addEventListener("change", () => retry(sendScheme, 50), { signal });

  // What has been sent so far is in the next picture of the browser; a tab in the background has none.
  const tell = (kind, latest) => {
    let isTold = false;
    const run = () => {
      if (isTold) return;
      isTold = true;
      retry(() => send(kind, null), 50);
    };
    setTimeout(run, latest);
    return run;
  };
  const whenIdle = window.requestIdleCallback || ((run) => setTimeout(run, 200));
  const painted = tell("painted", 1000);
  const shown = tell("shown", 2000);
  requestAnimationFrame(() => requestAnimationFrame(painted));
  requestAnimationFrame(() => whenIdle(shown, { timeout: 1000 }));

  const save = (text) => {
    try {
      sessionStorage.setItem(config.storeKey, text);
    } catch (error) {
      console.warn(error);
    }
  };

  // A link goes before what was kept, which is then offered and not written over it.
  let link = "";
  const sendLink = () => {
    link = window.paminsaLinks?.take() || link;
    if (!link) return true;
    if (!send("link", link)) return false;
    const shown = new URLSearchParams(link.split("&").slice(1).join("&"));
    const linked = ["section", "beside"].map((key) => shown.get(key)).filter(Boolean);
    if (linked.length) tabs.want(linked); // and not what the tab has kept
    link = "";
    return true;
  };
  // The scheme last: a theme that was chosen and kept goes before that of the browser.
  retry(() => sendSize() && sendLink() && send("hello", saved) && sendScheme(), 50);
  const openLink = () => retry(sendLink, 50);

  // --- title --------------------------------------------------------------------------------
  const setTitle = (name) => {
    document.title = [name, config.title].filter(Boolean).join(" - ");
  };

  // --- buttons in texts ---------------------------------------------------------------------
  // What is pressed may lie in an element that carries the message, such as a row of a table.
  document.addEventListener("click", (event) => {
    const found = event.target.closest?.("[data-paminsa-send]");
    if (found) send(found.dataset.paminsaSend, found.dataset.paminsaValue);
  }, { signal });

  // --- legend of the 3D view ----------------------------------------------------------------
  const showLegend = (html) => retry(() => {
    const place = viewer().canvas?.parentElement;
    if (!place) return false;
    let box = document.querySelector(".pv-legend");
    if (!box) {
      box = document.createElement("div");
      box.className = "pv-legend";
      box.setAttribute("role", "note");
      box.setAttribute("aria-label", "Legend of the 3D view");
      place.appendChild(box);
    }
    box.innerHTML = html;
    return true;
  }, 200);

  // --- what others call ---------------------------------------------------------------------
  const stop = () => {
    stopped.abort();
    timers.forEach(clearInterval);
  };
  const tour = (steps, again) => window.paminsaTour?.(steps, again);
  const copy = (what, text) => window.paminsaClipboard?.give(what, text);
  const followLink = (code) => window.paminsaLinks?.follow(code);
  const copyLink = (code) => copy("Link", window.paminsaLinks?.to(code) || code);
  const focusInput = (names) => window.paminsaNames?.focus(names);
  const say = (text) => window.paminsaNames?.say(text);
  const showPlace = (place) => window.paminsaCursor?.show(place);
  const showPiece = (places) => window.paminsaCursor?.showPiece(places);
  const showReadout = (html) => window.paminsaCursor?.showReadout(html);
  const renderOnDemand = (animation) => window.paminsaDrawing?.renderOnDemand(animation);
  const releaseTheme = () => window.paminsaFirstPaint?.release();
  window.paminsa = {
    stop, whole: docks.whole, tour, copy, focusInput, say, send, save, openTab: tabs.open, setTitle,
    showTime: time.show, showLegend, renderOnDemand, releaseTheme, openLink, followLink, copyLink,
    answerTyped: palette.answer, showPlace, showPiece, showReadout,
  };
}
