/**
 * Puts the unit of an input behind its field: of a label `x [mm]`, the name is seen before it.
 *
 * The style sheet shows name and unit from attributes. The label's own text stays as it is, unseen:
 * it names the field for screen readers, and viser may write it again. Where there is no field to
 * put the unit behind, the label is seen as it is.
 */
(() => {
  "use strict";
  const LABEL = /^(.*\S)\s*\[(\S+)\]$/;
  const set = (element, name, text) => {
    if (text) element.setAttribute(name, text);
    else element.removeAttribute(name);
  };
  window.paminsaMarks.watch("p > label[for]", (label) => {
    const row = label.closest('[data-paminsa-mark~="row"]');
    const field = row?.lastElementChild;
    if (!field || field.contains(label) || !field.querySelector(".mantine-NumberInput-root")) return;
    const [, name, unit] = label.textContent.trim().match(LABEL) ?? [];
    set(label, "data-paminsa-name", name);
    set(field, "data-paminsa-unit", unit);
  });
})();
