/**
 * A guided tour: a card next to what it explains, with a ring around that.
 *
 * It is no modal dialog: the page can be used while it is open. Once ended it does not come again
 * by itself in this browser, nor in a page that is opened for reproducible pictures (fixedDpr).
 */
(() => {
  "use strict";
  const KEY = "paminsa_viz_tour";
  const GAP = 14;
  const EDGE = 8;
  let close = () => {};

  const seen = () => {
    try {
      return localStorage.getItem(KEY) !== null;
    } catch {
      return true; // without a store it would come with every page
    }
  };
  const remember = () => {
    try {
      localStorage.setItem(KEY, "done");
    } catch (error) {
      console.warn(error);
    }
  };

  const boxOf = (step) => {
    let element = document.querySelector(step.selector);
    if (step.tab)
      element = [...document.querySelectorAll('[role="tab"]')]
        .find((tab) => tab.textContent.trim() === step.tab);
    if (step.heading)
      element = [...document.querySelectorAll("body *")]
        .find((each) => !each.querySelector("*:not(svg, svg *)") && each.textContent.trim() === step.heading
          && !each.closest("[role=tab], style, script"));
    if (step.host) element = element?.parentElement?.parentElement;
    const box = element?.getBoundingClientRect();
    return box && box.width > 0 && box.height > 0 ? box : null;
  };

  // Where there is room: beside it, below or above it; never over it unless there is none.
  const place = (box, width, height) => {
    const { innerWidth, innerHeight } = window;
    const clamp = (value, most) => Math.max(EDGE, Math.min(value, most - EDGE));
    const y = clamp(box.top + Math.min(24, box.height / 4), innerHeight - height);
    const x = clamp(box.left, innerWidth - width);
    const candidates = [
      [box.left - GAP - width, y], [box.right + GAP, y],
      [x, box.bottom + GAP], [x, box.top - GAP - height],
    ];
    const fits = ([left, top]) => left >= EDGE && top >= EDGE
      && left + width <= innerWidth - EDGE && top + height <= innerHeight - EDGE;
    return candidates.find(fits) || [clamp(box.right, innerWidth - width), innerHeight - height - EDGE];
  };

  const make = (name, props = {}, ...children) => {
    const element = Object.assign(document.createElement(name), props);
    element.append(...children);
    return element;
  };

  // Parts of the page come late; one that is not there after five seconds is left out.
  const start = (steps, again, attempts = 25) => {
    const pictures = new URLSearchParams(location.search).has("fixedDpr");
    if (!again && (seen() || pictures)) return;
    // What a step is about may be in a tab that is not open.
    for (const step of steps) if (step.opens && !boxOf(step)) window.paminsa?.openTab(step.opens);
    const shown = steps.filter(boxOf);
    if (shown.length < steps.length && attempts > 0) {
      setTimeout(() => start(steps, again, attempts - 1), 200);
      return;
    }
    close();
    const before = document.activeElement;
    if (!shown.length) return;
    let at = 0;
    const count = make("span", { className: "pv-tour-count" });
    const title = make("b", { id: "paminsa-tour-title" });
    const text = make("p", { id: "paminsa-tour-text" });
    const skip = make("button", { type: "button", textContent: "End tour" });
    const back = make("button", { type: "button", textContent: "Back" });
    const next = make("button", { type: "button" });
    const row = make("div", { className: "pv-tour-row" }, skip, count, back, next);
    const card = make("div", { className: "pv-tour" }, title, text, row);
    card.dataset.testid = "tour";
    card.setAttribute("role", "dialog");
    card.setAttribute("aria-labelledby", title.id);
    card.setAttribute("aria-describedby", text.id);
    const ring = make("div", { className: "pv-tour-ring" });
    document.body.append(ring, card);

    const follow = () => {
      const box = boxOf(shown[at]);
      if (!box) return;
      const [left, top] = place(box, card.offsetWidth, card.offsetHeight);
      Object.assign(card.style, { left: `${left}px`, top: `${top}px` });
      Object.assign(ring.style, {
        left: `${box.left}px`, top: `${box.top}px`, width: `${box.width}px`, height: `${box.height}px`,
      });
    };
    const show = (index) => {
      at = index;
      if (shown[at].opens) window.paminsa?.openTab(shown[at].opens);
      title.textContent = shown[at].title;
      text.textContent = shown[at].text;
      count.textContent = `${at + 1} of ${shown.length}`;
      back.disabled = at === 0;
      next.textContent = at === shown.length - 1 ? "Done" : "Next";
      follow();
      next.focus({ preventScroll: true });
    };
    const move = (by) => {
      if (at + by >= shown.length) close();
      else if (at + by >= 0) show(at + by);
    };
    const timer = setInterval(follow, 250);
    window.addEventListener("resize", follow);
    close = () => {
      clearInterval(timer);
      window.removeEventListener("resize", follow);
      card.remove();
      ring.remove();
      remember();
      close = () => {};
      if (before?.isConnected) before.focus?.({ preventScroll: true });
    };
    skip.onclick = () => close();
    back.onclick = () => move(-1);
    next.onclick = () => move(1);
    card.addEventListener("keydown", (event) => {
      event.stopPropagation(); // the page's own keys are for the page
      if (event.key === "Escape") close();
      if (event.key === "ArrowRight") move(1);
      if (event.key === "ArrowLeft") move(-1);
    });
    show(0);
  };
  window.paminsaTour = start;
})();
