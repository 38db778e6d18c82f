/**
 * Hides what lies over the robot while a slider or the view is dragged: the tour's card, and notices
 * that were there before. They are shown again at rest.
 */
(() => {
  "use strict";
  const COVERS = ".pv-tour, .pv-tour-ring, .mantine-Notification-root";
  const HIDDEN = "pv-hidden-while-dragged";
  const SHOWN_AFTER = 600; // without a movement [ms]
  let timer = 0;
  const show = () => {
    timer = 0;
    document.querySelectorAll(`.${HIDDEN}`).forEach((cover) => cover.classList.remove(HIDDEN));
  };
  const hide = ({ target }) => {
    if (target.closest?.(COVERS)) return;
    if (!timer) document.querySelectorAll(COVERS).forEach((cover) => cover.classList.add(HIDDEN));
    clearTimeout(timer);
    timer = setTimeout(show, SHOWN_AFTER);
  };
  window.addEventListener("pointermove", (event) => event.buttons && hide(event), true);
  window.addEventListener("keydown", (event) => {
    const isSlider = event.target.closest?.("[role=slider]");
    if (isSlider && /^(Arrow|Page|Home$|End$)/.test(event.key)) hide(event);
  }, true);
})();
