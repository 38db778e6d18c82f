/**
 * Tooltips of inputs open in the 3D view next to the panel, and so never over a number or a result.
 *
 * Mantine puts them over the input. They are found by their role; `view.css` has them stay at the
 * place that is written here. viser opens them after half a second.
 */
(() => {
  "use strict";
  window.paminsaTooltips?.stop();
  const GAP = 8;
  const canvas = () => window.__viserMutable?.canvas;

  const place = (tooltip) => {
    const anchor = document.querySelector(`[aria-describedby~="${CSS.escape(tooltip.id)}"]`);
    const view = canvas()?.getBoundingClientRect();
    if (!anchor || !view) return;
    const at = anchor.getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: height } = tooltip;
    let x;
    if (at.left >= view.right - 1) x = view.right - width - GAP;
    else if (at.right <= view.left + 1) x = view.left + GAP;
    else return; // over the view itself
    const y = at.top + at.height / 2 - height / 2;
    const within = (value, most) => Math.max(GAP, Math.min(value, most - GAP));
    tooltip.style.setProperty("--pv-left", `${within(x, window.innerWidth - width)}px`);
    tooltip.style.setProperty("--pv-top", `${within(y, window.innerHeight - height)}px`);
    tooltip.dataset.paminsaPlaced = "";
  };

  // Only the page's body and its portals are watched: all else changes with every frame.
  const tooltipsIn = (node) => [
    ...(node.matches?.('[role="tooltip"]') ? [node] : []),
    ...(node.querySelectorAll?.('[role="tooltip"]') || []),
  ];
  const portals = new MutationObserver((changes) => {
    for (const { addedNodes } of changes)
      for (const node of addedNodes) for (const tooltip of tooltipsIn(node)) place(tooltip);
  });
  const watch = (node) => {
    if (!node.matches?.('[data-portal="true"]')) return;
    portals.observe(node, { childList: true, subtree: true });
    for (const tooltip of tooltipsIn(node)) place(tooltip);
  };
  const body = new MutationObserver((changes) => {
    for (const { addedNodes } of changes) addedNodes.forEach(watch);
  });
  body.observe(document.body, { childList: true });
  document.querySelectorAll('body > [data-portal="true"]').forEach(watch);

  const stop = () => {
    portals.disconnect();
    body.disconnect();
  };
  window.paminsaTooltips = { stop };
})();
