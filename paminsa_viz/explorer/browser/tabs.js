/**
 * Open tabs: only they follow a drag, and a reload opens them again.
 *
 * A tab is known by its path, such as "Accuracy/Drives": inner tabs may have the same name. `key` is
 * where the browser tab keeps what is open, `names` are paths by names that an earlier page may have
 * kept, and `isWhole` says whether all of the page is there.
 */
window.paminsaTabs = (config) => {
  "use strict";
  const { key, names, isWhole, every, send, signal } = config;
  const all = () => [...document.querySelectorAll('[role="tab"]')];
  const rowAround = (tab) => tab.closest('[role="tablist"]');
  const isOpen = (tab) => tab.getAttribute("aria-selected") === "true";
  const nameOf = (tab) => tab.textContent.trim();
  const withOuter = (path) =>
    path.split("/").map((_, index, parts) => parts.slice(0, index + 1).join("/"));
  const outerOf = (path) => path.split("/").slice(0, -1).join("/");

  // Of a hidden row of tabs the page does not say which tab it lies in: that is remembered of when
  // it was seen. Whether a row is seen is asked without its place, which would lay out the page.
  const around = new WeakMap();
  const tablistIn = (box) => [...box.children].find((each) => each.getAttribute("role") === "tablist");
  const pathAround = (row) => {
    const known = around.get(row);
    let isKnown = !known?.isKnown && row.checkVisibility();
    if (known && !isKnown) return known.path;
    const path = [];
    for (let box = row.parentElement?.parentElement; box; box = box.parentElement) {
      const list = tablistIn(box);
      const open = list && [...list.children].find(isOpen);
      if (open) path.unshift(nameOf(open));
      isKnown &&= !list || Boolean(open); // a row that is being built opens its first tab later
    }
    around.set(row, { path, isKnown });
    return path;
  };
  const pathOf = (tab) => {
    const row = rowAround(tab);
    return [...(row ? pathAround(row) : []), nameOf(tab)].join("/");
  };

  const MOST_KEPT = 40;
  let wanted = []; // to be opened; those of a row that is not there yet are waited for
  try {
    const kept = JSON.parse(sessionStorage.getItem(key) || "[]");
    // Names that an earlier page has kept have none of the tabs around them; some of them are others'
    // by now, such as that of the workspace Motion.
    const isEarlier = !kept.some((name) => name.includes("/"));
    wanted = isEarlier ? kept.flatMap((name) => withOuter(names[name] ?? name)) : kept;
  } catch (error) {
    console.warn(error);
  }
  const keep = (paths) => {
    const text = JSON.stringify(paths);
    try {
      if (text !== sessionStorage.getItem(key)) sessionStorage.setItem(key, text);
    } catch (error) {
      console.warn(error);
    }
  };

  let reported = "";
  /** Open what is wanted and there, report what is seen, and keep what is open. */
  const follow = () => {
    const paths = new Map(all().map((tab) => [tab, pathOf(tab)]));
    const open = [...paths.keys()].filter(isOpen);
    const seen = open.filter((tab) => tab.checkVisibility()).map((tab) => paths.get(tab));
    const found = [...paths.keys()].filter((tab) => wanted.includes(paths.get(tab)));
    const closed = found.filter((tab) => !isOpen(tab));
    for (const tab of closed) // those of docks are no buttons, and open by a key
      if (tab.matches("button")) tab.click();
      else tab.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", bubbles: true }));
    // What a row opens by itself is no choice: the server would go to that workspace, and then
    // open in the dock what the next one begins with.
    if (!closed.length && String(seen) !== reported && send("tabs", seen)) reported = String(seen);
    const opened = new Set(found.filter(isOpen).map((tab) => paths.get(tab)));
    wanted = wanted.filter((path) => !opened.has(path)).slice(-MOST_KEPT);
    if (!isWhole()) return; // rows are still to come, and open their first tab
    const rows = new Set([...paths.values()].map(outerOf));
    const waiting = wanted.filter((path) => !rows.has(outerOf(path)));
    keep([...waiting, ...open.map((tab) => paths.get(tab))]);
  };

  // Of tabs that were asked for in a row, only the last one is wanted.
  const dropOthers = (tab, paths = []) => {
    const row = [...rowAround(tab).querySelectorAll('[role="tab"]')].map(pathOf);
    wanted = wanted.filter((path) => paths.includes(path) || !row.includes(path));
  };
  for (const kind of ["pointerdown", "keydown"])
    document.addEventListener(kind, ({ target, isTrusted }) => {
      const tab = isTrusted && target.closest?.('[role="tab"]');
      if (tab) dropOthers(tab);
    }, { capture: true, signal });

  /** Open a tab by its path, and those around it before. */
  const open = (path) => {
    const paths = withOuter(path);
    for (const tab of all()) if (paths.includes(pathOf(tab))) dropOthers(tab, paths);
    // A reload may have left other tabs wanted, of a row that is not there yet.
    const rows = paths.map(outerOf).filter(Boolean);
    const isReplaced = (each) => paths.includes(each) || rows.includes(outerOf(each));
    wanted = [...wanted.filter((each) => !isReplaced(each)), ...paths];
    follow();
  };
  /** Open tabs once they are there, in place of what the browser tab has kept. */
  const want = (paths) => {
    wanted = paths.flatMap(withOuter);
  };
  every(200, follow);
  return { open, want };
};
