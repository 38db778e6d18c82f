/** Folders open and close by keys as well: viser leaves their heads out of the order of the Tab key. */
(() => {
  "use strict";
  const OPEN = "svg.tabler-icon-chevron-up";
  // A folder that opens or closes has another icon, which comes as a new element.
  window.paminsaMarks.watch(`svg.tabler-icon-chevron-down, ${OPEN}`, (icon) => {
    const head = icon.parentElement;
    if (head.closest("button, a")) return;
    head.tabIndex = 0;
    head.setAttribute("role", "button");
    head.setAttribute("aria-expanded", String(icon.matches(OPEN)));
    head.onkeydown = (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault(); // the space would scroll
      head.click();
    };
  });
})();
