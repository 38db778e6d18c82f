/** Folders: by keys as well as by the pointer, and open with all that they hold. */
window.paminsaFolders = (config) => {
  "use strict";
  const { signal } = config;

  // viser leaves their heads out of the order of the Tab key. A folder that opens or closes has
  // another icon, which comes as a new element.
  const OPEN = "svg.tabler-icon-chevron-up";
  window.paminsaMarks.watch(`svg.tabler-icon-chevron-down, ${OPEN}`, (icon) => {
    const head = icon.parentElement;
    if (head.closest("button, a")) return;
    head.tabIndex = 0;
    head.setAttribute("role", "button");
    const isOpen = icon.matches(OPEN);
    head.setAttribute("aria-expanded", String(isOpen));
    if (!isOpen) window.paminsaMarks.mark(head.parentElement, "shut-folder", icon);
    head.onkeydown = (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault(); // the space would scroll
      head.click();
    };
  });

  // Mantine (issue 9160) leaves one in another shut, though its arrow says it is open, if it was
  // filled while the one around it was shut: once that has opened, it gets its height.
  document.addEventListener("transitionend", ({ target, propertyName }) => {
    if (propertyName !== "height" || target.style.overflow === "hidden") return;
    for (const inner of target.querySelectorAll('div[style*="height: 0px"]')) {
      const open = inner.previousElementSibling?.querySelector(OPEN);
      if (open && !inner.getAnimations().length) Object.assign(inner.style, { height: "", overflow: "" });
    }
  }, { signal });
};
