/**
 * The page's side of a session: everything in a browser tab that viser has no interface for.
 *
 * All names of viser, Plotly, uPlot and Mantine that are not public are read here and in page.css.
 * `features` names them; one that a release has moved is reported, and the rest goes on.
 */
(config) => {
  "use strict";
  window.paminsa?.stop(); // a tab that has connected again is set up again
  const stopped = new AbortController();
  const timers = [];
  const every = (period, run) => timers.push(setInterval(run, period));
  const viewer = () => window.__viserMutable || {};
  let isWhole = false;

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
    if (!stopped.signal.aborted && !attempt()) setTimeout(() => retry(attempt, period), period);
  };

  // A folded panel takes what it holds off the page, and the view needs its colors still.
  retry(() => {
    const sheet = document.body.querySelector("style[data-paminsa]");
    if (!sheet) return false;
    document.head.querySelector("style[data-paminsa]")?.remove();
    document.head.append(sheet);
    return true;
  }, 50);

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
    isWhole = false; // till the server has fitted the docks: their widths are no person's
    clearTimeout(resized);
    resized = setTimeout(sendSize, 200);
  }, { signal: stopped.signal });

  retry(() => viewer().canvas && send("graphics", window.paminsaDrawing?.named() ?? ""), 200);

  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const sendScheme = () => send("scheme", dark.matches);
  dark.addEventListener("change", () => retry(sendScheme, 50), { signal: stopped.signal });

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

  // --- open tabs, see tabs.js -----------------------------------------------------------------
  const tabs = window.paminsaTabs({
    key: `${config.storeKey}_tabs`,
    names: config.tabs,
    isWhole: () => isWhole && isCurrent(),
    send,
    signal: stopped.signal,
  });
  every(200, tabs.follow);
  window.paminsaFiles({ largest: config.largestFile, send, signal: stopped.signal });

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

  // --- docks: how wide they are, kept for a reload ------------------------------------------
  let docks = "";
  let reportedDocks = "";
  every(400, () => {
    const place = viewer().canvas?.getBoundingClientRect();
    if (!place) return;
    const widths = {
      left: place.left, right: window.innerWidth - place.right, window: window.innerWidth,
    };
    const now = JSON.stringify(widths);
    const steady = now === docks; // not while one is dragged
    const panel = document.querySelector("[data-floating-window]");
    const folded = panel?.querySelector("[data-dock-collapsed]");
    const room = Math.round(place.width) - 20;
    const beyond = panel && !folded ? Math.max(0, panel.offsetWidth - room - 10) : 0;
    const { style } = document.documentElement; // see view.css
    for (const [name, value] of [
      ["--pv-widest-panel", folded ? `${room}px` : "none"],
      ["--pv-panel-shift", `${-beyond}px`],
    ])
      if (style.getPropertyValue(name) !== value) style.setProperty(name, value);
    docks = now;
    const known = !isWhole || now === reportedDocks;
    if (steady && !known && send("docks", widths)) reportedDocks = now;
  });
  // All of the page has been sent, with docks as wide as they are to be: from now on another width
  // is a person's. A busy browser may be late to fold one, which is waited for.
  const whole = (width, folded) => {
    let left = 100;
    retry(() => {
      if (width && width !== window.innerWidth) return true; // meanwhile it has another size
      const edge = viewer().canvas?.getBoundingClientRect().left;
      const isFolded = edge < config.foldedDock;
      if (folded !== undefined && edge !== undefined && isFolded !== folded && --left > 0) return false;
      isWhole = true;
      docks = "";
      reportedDocks = "";
      return true;
    }, 100);
  };

  // --- title --------------------------------------------------------------------------------
  const setTitle = (name) => {
    document.title = [name, config.title].filter(Boolean).join(" - ");
  };

  // --- clicks on maps and on Plotly figures -------------------------------------------------
  // A press counts if the figure itself is under the pointer, not what lies over it. Where it is let
  // go says nothing: while a figure is pressed, Plotly lays a cover over the window.
  const plotOf = (element) => {
    const plot = element.closest?.(".js-plotly-plot");
    return plot?._fullLayout?._plots ? plot : null;
  };
  // Maps are read in the frame that came with their picture.
  const mapOf = (element) => {
    const map = element.dataset?.paminsaPicture;
    const marks = map && element.closest('[data-paminsa-mark~="maps"]')?.querySelector("[data-paminsa-frame]");
    return marks && { map, ...JSON.parse(marks.dataset.paminsaFrame), box: marks.getBoundingClientRect() };
  };
  const placeInMap = ({ map, edges, panels, box }, place) => {
    const [left, right, bottom, top] = edges;
    for (const [panel, [start, head, width, height]] of panels.entries()) {
      const across = ((place[0] - box.left) / box.width - start) / width;
      const down = ((place[1] - box.top) / box.height - head) / height;
      if (across < 0 || down < 0 || across > 1 || down > 1) continue;
      return { map, panel, x: left + across * (right - left), y: top - down * (top - bottom) };
    }
    return null;
  };
  let pressed = null;
  const onPointer = (event) => {
    const place = [event.clientX, event.clientY];
    if (event.type === "pointerdown") {
      const { target } = event;
      pressed = event.button === 0 && { map: mapOf(target), plot: plotOf(target), place };
      return;
    }
    if (!pressed) return;
    const { map, plot, place: start } = pressed;
    pressed = null;
    if (Math.hypot(place[0] - start[0], place[1] - start[1]) > 4) return;
    if (map) {
      const found = placeInMap(map, start);
      if (found) send("click", { title: map.map, x: found.x, y: found.y });
      return;
    }
    if (!plot) return;
    const title = String(plot._fullLayout.meta || "");
    const box = plot.getBoundingClientRect();
    for (const { xaxis, yaxis } of Object.values(plot._fullLayout._plots)) {
      const x = place[0] - box.left - xaxis._offset;
      const y = place[1] - box.top - yaxis._offset;
      if (x < 0 || y < 0 || x > xaxis._length || y > yaxis._length) continue;
      send("click", { title, x: xaxis.p2d(x), y: yaxis.p2d(y) });
      return;
    }
  };
  for (const kind of ["pointerdown", "pointerup"])
    document.addEventListener(kind, onPointer, { capture: true, signal: stopped.signal });

  // --- one cursor, see cursor.js ------------------------------------------------------------
  const placeUnder = ({ target, clientX, clientY }) => {
    const map = mapOf(target);
    return map ? placeInMap(map, [clientX, clientY]) : null;
  };
  const timeUnder = ({ target, clientX }) => {
    const time = plotOf(target)?._hoverdata?.[0]?.customdata;
    if (typeof time === "number") return time;
    const chart = target.closest?.(".uplot") && charts().find((each) => each.over.contains(target));
    return chart ? chart.posToVal(clientX - chart.over.getBoundingClientRect().left, "x") : null;
  };
  window.paminsaCursor?.follow({ placeUnder, timeUnder, send, signal: stopped.signal });

  // --- buttons in texts ---------------------------------------------------------------------
  // What is pressed may lie in an element that carries the message, such as a row of a table.
  document.addEventListener("click", (event) => {
    const found = event.target.closest?.("[data-paminsa-send]");
    if (found) send(found.dataset.paminsaSend, found.dataset.paminsaValue);
  }, { signal: stopped.signal });

  // --- folders in folders -------------------------------------------------------------------
  // Mantine (issue 9160) leaves one shut, though its arrow says it is open, if it was filled while
  // the one around it was shut: once that has opened, it gets its height.
  document.addEventListener("transitionend", ({ target, propertyName }) => {
    if (propertyName !== "height" || target.style.overflow === "hidden") return;
    for (const inner of target.querySelectorAll('div[style*="height: 0px"]')) {
      const open = inner.previousElementSibling?.querySelector(".tabler-icon-chevron-up");
      if (open && !inner.getAnimations().length) Object.assign(inner.style, { height: "", overflow: "" });
    }
  }, { signal: stopped.signal });

  // --- keys in a box ------------------------------------------------------------------------
  // Mantine's keys are dead in a box. These leave it, which takes what was typed, and then work.
  document.addEventListener("keydown", (event) => {
    const { target, key, code, ctrlKey, metaKey, altKey } = event;
    if (altKey || !(ctrlKey || metaKey) || !/^[ks1-5]$/i.test(key)) return;
    if (!target.matches?.("input, textarea") || target.matches(SEARCH)) return;
    event.preventDefault();
    event.stopPropagation();
    target.blur();
    const again = { key, code, ctrlKey, metaKey, bubbles: true, cancelable: true };
    document.documentElement.dispatchEvent(new KeyboardEvent("keydown", again));
  }, { capture: true, signal: stopped.signal });

  // --- arrow keys of a slider or a tab --------------------------------------------------------
  // They would turn the camera as well, which listens at the document.
  document.documentElement.addEventListener("keydown", (event) => {
    const { target, key } = event;
    if (key.startsWith("Arrow") && target.closest?.('[role="slider"], [role="tab"]'))
      event.stopPropagation();
  }, { signal: stopped.signal });

  // --- what is typed into the command palette -----------------------------------------------
  // The server says what a text means as a whole. Its line comes later than the others and has to be
  // selected as the first one then; an Enter before that waits for it.
  const SEARCH = ".mantine-Spotlight-search";
  const commandLines = () => [...document.querySelectorAll(".mantine-Spotlight-action")];
  const typed = { asked: "", answered: "", enter: false };
  const answerTyped = (text, label) => {
    let left = 50;
    retry(() => {
      if (text !== typed.asked) return true;
      const lines = commandLines();
      const here = !label || lines[0]?.textContent.startsWith(label);
      if (!here && --left > 0) return false;
      if (here && label) for (const line of lines)
        if (line === lines[0]) line.dataset.selected = "true";
        else delete line.dataset.selected;
      typed.answered = text;
      if (typed.enter) (lines.find((line) => line.dataset.selected) ?? lines[0])?.click();
      typed.enter = false;
      return true;
    }, 20);
  };
  const onSearch = (event) => {
    if (!event.target.matches?.(SEARCH)) return;
    if (event.type === "input") {
      typed.asked = event.target.value.slice(0, 200);
      typed.enter = false;
      if (!send("typed", typed.asked)) typed.answered = typed.asked;
    } else if (event.key === "Enter" && typed.asked !== typed.answered) {
      typed.enter = true;
      event.preventDefault();
      event.stopPropagation();
    }
  };
  for (const kind of ["input", "keydown"])
    document.addEventListener(kind, onSearch, { capture: true, signal: stopped.signal });

  // --- Esc closes the inspector, where nothing else takes it ----------------------------------
  document.addEventListener("keydown", (event) => {
    const taken = event.defaultPrevented || event.target.closest?.("input, textarea");
    if (event.key === "Escape" && !taken && !document.querySelector('[role="dialog"]'))
      send("escape", null);
  }, { signal: stopped.signal });

  // --- Ctrl+Y, the other key of Redo --------------------------------------------------------
  document.addEventListener("keydown", (event) => {
    const { target, key, ctrlKey, shiftKey, altKey } = event;
    if (!ctrlKey || shiftKey || altKey || key.toLowerCase() !== "y") return;
    if (event.defaultPrevented || target.closest?.("input:not([type=checkbox]), textarea")) return;
    event.preventDefault();
    send("redo", null);
  }, { signal: stopped.signal });

  // --- places for figures: which are visible, and how wide ----------------------------------
  const hostOf = (mark) => mark?.parentElement?.parentElement;
  let reported = "";
  let again = 0;
  every(200, () => {
    const found = { ratio: window.devicePixelRatio };
    for (const mark of document.querySelectorAll("[data-paminsa-slot]")) {
      const host = hostOf(mark);
      if (!host) continue;
      const visible = host.clientHeight > 0 && host.getClientRects().length > 0;
      const width = host.clientWidth;
      found[mark.dataset.paminsaSlot] = visible ? width : 0;
    }
    const now = JSON.stringify(found);
    if (now !== reported) {
      reported = now;
      again = 3;
    }
    if (again > 0 && send("slots", found)) again -= 1;
  });

  // --- time cursor: a line through all charts of a place ------------------------------------
  // Charts are looked for again and again: the page makes, widens and zooms them.
  let cursor = { slot: "", time: null };
  const charts = () => {
    const host = hostOf(document.querySelector(`[data-paminsa-slot="${cursor.slot}"]`));
    return Object.values(window.__viserTestpoints?.uplots || {})
      .map((entry) => entry.chart)
      .filter((chart) => host?.contains(chart.root));
  };
  const lineOf = (chart) => {
    const known = chart.over.querySelector(".paminsa-time-cursor");
    if (known) return known;
    const line = document.createElement("div");
    line.className = "paminsa-time-cursor";
    chart.over.appendChild(line);
    let down = null;
    chart.over.addEventListener("mousedown", (event) => { down = event.clientX; });
    chart.over.addEventListener("mouseup", (event) => {
      if (event.button !== 0 || down === null || Math.abs(event.clientX - down) > 3) return;
      const box = chart.over.getBoundingClientRect();
      window.paminsa.send("time", chart.posToVal(event.clientX - box.left, "x"));
    });
    return line;
  };
  // A chart that is zoomed shows a piece of the time, which is marked wherever the motion is seen.
  let piece = "null";
  const tellPiece = () => {
    let found = null;
    for (const { data: [times], scales: { x } } of charts()) {
      const first = times?.[0], last = times?.[times.length - 1];
      if (x.min > first || x.max < last) found = { from: Math.max(x.min, first), to: Math.min(x.max, last) };
    }
    const text = JSON.stringify(found);
    if (text !== piece && send("piece", found)) piece = text;
  };
  const drawCursor = () => {
    if (!cursor.slot) return;
    if (charts().length) tellPiece();
    for (const chart of charts()) {
      const line = lineOf(chart);
      const x = cursor.time === null ? NaN : chart.valToPos(cursor.time, "x");
      const inside = x >= -1 && x <= chart.over.clientWidth + 1;
      line.style.display = inside ? "" : "none";
      if (inside) line.style.transform = `translateX(${x}px)`;
    }
  };
  every(200, drawCursor);
  const showTime = (slot, time) => {
    cursor = { slot, time };
    drawCursor();
  };

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

  // --- a server that does not answer --------------------------------------------------------
  // viser only dims the page. Short breaks are none: it connects again by itself.
  const LOST_AFTER = 3000;
  let lostSince = 0;
  let lost = null;
  every(500, () => {
    const connected = window.paminsaNumberFields?.connected();
    if (connected !== false) {
      lostSince = 0;
      lost?.remove();
      lost = null;
      return;
    }
    lostSince ||= performance.now();
    if (lost || performance.now() - lostSince < LOST_AFTER) return;
    lost = document.createElement("div");
    lost.className = "pv-lost";
    lost.setAttribute("role", "alert");
    lost.dataset.testid = "lost";
    lost.textContent = "paminsa-viz does not answer: it was stopped, or the connection is lost. "
      + "The page goes on by itself once it runs again; what is set is kept in this tab.";
    document.body.append(lost);
  });

  // --- self-test ----------------------------------------------------------------------------
  // A name that stays missing for long is reported; `UNKNOWN`: nothing here can tell yet.
  const UNKNOWN = Symbol("unknown");
  const onceThere = (selector, test) => (document.querySelector(selector) ? test() : UNKNOWN);
  const features = {
    "graphics card detection (canvas)": () => viewer().canvas,
    "plain background (backgroundMaterial)": () => viewer().backgroundMaterial,
    "rendering on demand (requestRender, __r3f)": () => window.paminsaDrawing?.canDraw(),
    "light before the first picture, pixels of the view (useEnvironment, useDevSettings)": () => {
      const context = window.paminsaContext?.get();
      return context?.useEnvironment && context.useDevSettings;
    },
    "each input's newest value (guiActions, mutable)": () => window.paminsaInputs?.works(),
    "links in the address (replaceState)": () => {
      const keeps = window.paminsaLinks?.keeps();
      return keeps === null ? UNKNOWN : keeps;
    },
    "layout of inputs (mantine-Flex-root)": () =>
      onceThere("[role=slider]", () => document.querySelector(".mantine-Flex-root")),
    "numbers typed as a whole (mantine-NumberInput-input, __reactFiber, useGuiConfig)": () =>
      onceThere("[role=slider]", () => window.paminsaNumberFields?.works()),
    "clicks on figures (_fullLayout)": () =>
      onceThere(".plot-container.plotly", () =>
        document.querySelector(".js-plotly-plot")?._fullLayout?._plots),
    "places of tooltips (mantine-Tooltip-tooltip)": () =>
      onceThere("[role=tooltip]", () => document.querySelector(".mantine-Tooltip-tooltip")),
    "values typed into the palette (mantine-Spotlight-search)": () =>
      onceThere(".mantine-Spotlight-content", () => document.querySelector(SEARCH)),
    "time cursor (uplots)": () => onceThere(".uplot", () => window.__viserTestpoints?.uplots),
  };
  const waited = Object.fromEntries(Object.keys(features).map((name) => [name, 0]));
  every(500, () => {
    const missing = [];
    for (const name of Object.keys(waited)) {
      const found = features[name]();
      if (!found && ++waited[name] > 2 * config.missingAfter) missing.push(name);
      if (found && found !== UNKNOWN) delete waited[name];
    }
    if (missing.length && send("missing", missing)) for (const name of missing) delete waited[name];
  });

  const stop = () => {
    stopped.abort();
    lost?.remove();
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
    stop, whole, tour, copy, focusInput, say, send, save, openTab: tabs.open, setTitle, showTime,
    showLegend, renderOnDemand, releaseTheme, openLink, followLink, copyLink, answerTyped, showPlace,
    showPiece, showReadout,
  };
}
