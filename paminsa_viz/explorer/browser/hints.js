/**
 * Tooltips of buttons, which viser takes and does not show: those of inputs alone are shown.
 *
 * A button may come after its tooltip, and again when it was hidden meanwhile.
 */
(() => {
  "use strict";
  const hints = new Map(); // by the id of the button
  const show = (button) => {
    const text = hints.get(button?.id);
    if (text !== undefined && button.title !== text) button.title = text;
  };
  window.paminsaMarks.watch("button[id]", show);
  const set = (id, text) => {
    hints.set(id, text);
    show(document.getElementById(id));
  };
  window.paminsaHints = { set };
})();
