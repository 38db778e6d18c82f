/**
 * Marks that the style sheets select: what an input, its row and its container hold.
 *
 * viser gives them neither names nor classes. `:has()` would find them too, but with every picture
 * of a drag the browser would try all such rules on all of the page again. Here an element gets its
 * marks once, in `data-paminsa-mark`, before the browser first draws it.
 */
(() => {
  "use strict";
  window.paminsaMarks?.stop();
  const MARK = "data-paminsa-mark";

  // --- what is there, and what comes --------------------------------------------------------
  const watched = []; // [selector, function]
  let all = ":not(*)"; // any of their selectors
  const run = (element) => {
    for (const [selector, call] of watched) if (element.matches(selector)) call(element);
  };
  const runIn = (node) => {
    if (node.nodeType !== Node.ELEMENT_NODE) return;
    if (node.matches(all)) run(node);
    for (const element of node.querySelectorAll(all)) run(element);
  };
  /** Call a function with every element of the page, now and when it comes or its text changes. */
  const watch = (selector, call) => {
    watched.push([selector, call]);
    all = watched.map(([each]) => each).join();
    for (const element of document.querySelectorAll(selector)) call(element);
  };

  // --- marks --------------------------------------------------------------------------------
  const marked = new Map(); // element: {mark: the elements that it is marked for}
  const write = (element, marks) => {
    const text = Object.keys(marks).join(" ");
    if (element.getAttribute(MARK) !== text) element.setAttribute(MARK, text);
  };
  const mark = (element, name, source) => {
    if (!element) return;
    const marks = marked.get(element) ?? {};
    (marks[name] ??= new Set()).add(source);
    marked.set(element, marks);
    write(element, marks);
  };
  const unmark = () => {
    for (const [element, marks] of marked) {
      for (const [name, sources] of Object.entries(marks)) {
        for (const source of sources) if (!element.contains(source)) sources.delete(source);
        if (!sources.size) delete marks[name];
      }
      write(element, marks);
      if (!element.isConnected) marked.delete(element);
    }
  };
  const above = (element, levels) => (levels ? above(element?.parentElement, levels - 1) : element);

  // What is found, how many levels above it the mark is put, and its name. One level above a text
  // is its entry, two is the container of the entry.
  const MARKS = [
    [".pv-strip", 1, "strip"],
    [".pv-heading", 1, "heading"],
    [".pv-layers", 1, "hidden"],
    [".pv-button-row", 1, "hidden"],
    ["[data-paminsa-address]", 1, "hidden"],
    [".pv-button-row", 2, "button-row"],
    [".pv-layers", 2, "layers"],
    [".pv-map-caption", 1, "map-caption"],
    [".pv-map-markers", 1, "map-markers"],
    ["img", 2, "picture"],
    ["[data-paminsa-slot]", 1, "slot"],
    ["[data-paminsa-slot]", 2, "figure"],
    ["[data-paminsa-inputs]", 2, "maps"],
    ['[data-paminsa-inputs="below"]', 2, "maps-below"],
    ['[data-paminsa-inputs="inside"]', 2, "maps-inside"],
    ['[data-paminsa-slot="motion"]', 2, "motion-plots"],
    [".uplot-container", 1, "chart"],
    [".paminsa-whole, .paminsa-numbers, .paminsa-limits", 1, "whole"],
    [".paminsa-playback", 2, "playback"],
    [".paminsa-limits", 2, "limits"],
    ['[data-testid="motion-points"]', 2, "motion-points"],
    ["p > label[for]", 2, "label"],
    ["p > label[for]", 3, "row"],
    ["p > label[for]:empty", 2, "no-label"],
  ];
  for (const [selector, levels, name] of MARKS)
    watch(selector, (found) => mark(above(found, levels), name, found));

  // Rows of tabs, by the name of one of them: on a phone they have no title.
  const ROWS_OF_TABS = { Robot: "workspaces", Manufacture: "inner-tabs", "Torque maps": "dock-tabs" };
  const FIRST_TABS = ["Robot", "Pose", "Path", "Loads", "Requirements", "Logs"];
  const nameOf = (tab) => tab.title || tab.textContent.trim();
  const isFirst = (tab) => FIRST_TABS.includes(nameOf(tab));
  watch('[role="tab"]', (tab) => {
    const name = ROWS_OF_TABS[nameOf(tab)];
    if (name) mark(tab.parentElement, name, tab);
    if (isFirst(tab)) mark(tab.parentElement, "tabs", tab);
  });

  // Rows of inputs, and the entries they are in, by what they hold.
  const ROWS = { checkbox: '[type="checkbox"]', slider: '[role="slider"]', number: ".mantine-NumberInput-root" };
  watch(".mantine-Flex-root", (row) => {
    mark(row.parentElement, "row-entry", row);
    for (const [name, selector] of Object.entries(ROWS)) {
      const found = row.querySelector(selector);
      if (!found) continue;
      mark(row, `${name}-row`, found);
      mark(row.parentElement, `${name}-entry`, found);
    }
  });
  // The strip stays where it is while the rest scrolls, and below it workspaces and sections: out of
  // all boxes that would take them along.
  const heights = new ResizeObserver(([{ target }]) => {
    const { height } = target.getBoundingClientRect(); // rounded up, it would leave a gap
    document.documentElement.style.setProperty("--pv-strip-height", `${Math.floor(height)}px`);
  });
  watch('.pv-strip, [role="tab"]', (found) => {
    // All of them each time: a slow page can bring tabs before the strip.
    if (found.matches('[role="tab"]') && !isFirst(found)) return;
    const strip = document.querySelector(".pv-strip");
    const view = strip?.closest(".mantine-ScrollArea-viewport");
    if (!view) return;
    for (const part of [strip, ...[...view.querySelectorAll('[role="tab"]')].filter(isFirst)]) {
      const first = part === strip ? part.parentElement : above(part, 2);
      for (let box = first; box !== view; box = box.parentElement) mark(box, "around-strip", part);
    }
    mark(view, "below-strip", strip);
    heights.observe(strip.parentElement);
  });

  const observer = new MutationObserver((changes) => {
    let removed = false;
    const targets = new Set();
    for (const { target, addedNodes, removedNodes } of changes) {
      addedNodes.forEach(runIn);
      removed ||= removedNodes.length > 0;
      targets.add(target.nodeType === Node.TEXT_NODE ? target.parentElement : target);
    }
    for (const target of targets) if (target?.matches(all)) run(target);
    if (removed) unmark();
  });
  observer.observe(document.body, { childList: true, characterData: true, subtree: true });

  window.paminsaMarks = { watch, mark, stop: () => { observer.disconnect(); heights.disconnect(); } };
})();
