/**
 * Docks: how wide they are, which the server keeps for a reload, and when all of the page is there.
 *
 * A dock that covers less of the window than `foldedDock` is folded [px].
 */
window.paminsaDocks = (config) => {
  "use strict";
  const { every, retry, send, viewer, signal, foldedDock } = config;
  let isWhole = false;
  window.addEventListener("resize", () => {
    isWhole = false; // till the server has fitted the docks: their widths are no person's
  }, { signal });

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
      const isFolded = edge < foldedDock;
      if (folded !== undefined && edge !== undefined && isFolded !== folded && --left > 0) return false;
      isWhole = true;
      docks = "";
      reportedDocks = "";
      return true;
    }, 100);
  };
  return { whole, isWhole: () => isWhole };
};
