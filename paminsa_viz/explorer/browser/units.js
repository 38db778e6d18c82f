/**
 * Puts the unit of an input behind its field: of a label `x [mm]`, the name is seen before it; and
 * sets symbols such as `m_B3` with their subscripts.
 *
 * The style sheet shows name and unit from attributes; a name with subscripts is an element beside
 * the label. The label's own text stays as it is, unseen:
 * it names the field for screen readers, and viser may write it again. Where there is no field to
 * put the unit behind, the label is seen as it is.
 */
(() => {
  "use strict";
  const LONG = { "N·m/rad": "long-units", "N·m·s/rad": "longer-units" };
  const LABEL = /^(.*\S)\s*\[(\S+)\]$/;
  /** Name and unit of a label; without a unit, neither. */
  const split = (text) => {
    const [, name, unit] = text.match(LABEL) ?? [];
    return { name, unit };
  };
  window.paminsaUnits = { split };
  const set = (element, name, text) => {
    if (text) element.setAttribute(name, text);
    else element.removeAttribute(name);
  };
  const SYMBOL = /\b([A-Za-z])_([A-Za-z0-9]+)/;
  const typeset = (label, name) => {
    let shown = label.parentElement.querySelector(":scope > .pv-symbol");
    if (!SYMBOL.test(name)) {
      shown?.remove();
      label.removeAttribute("data-paminsa-unseen");
      return;
    }
    if (!shown) {
      shown = document.createElement("span");
      shown.className = "pv-symbol";
      shown.setAttribute("aria-hidden", "true");
      label.after(shown);
    }
    label.dataset.paminsaUnseen = "";
    const plain = document.createElement("i");
    plain.textContent = name;
    const html = plain.innerHTML.replace(new RegExp(SYMBOL, "g"), "<i>$1</i><sub>$2</sub>");
    if (shown.innerHTML !== html) shown.innerHTML = html;
  };
  window.paminsaMarks.watch("p > label[for]", (label) => {
    const row = label.closest('[data-paminsa-mark~="row"]');
    const field = row?.lastElementChild;
    if (!field || field.contains(label) || !field.querySelector(".mantine-NumberInput-root")) return;
    const text = label.textContent.trim();
    const { name, unit } = split(text);
    set(label, "data-paminsa-name", name);
    typeset(label, name ?? text);
    // Boxes of sliders stand below each other, so that one without a unit leaves its place free.
    set(field, "data-paminsa-unit", unit ?? (field.querySelector("[role=slider]") && " "));
    if (unit in LONG) window.paminsaMarks.mark(row.parentElement.parentElement, LONG[unit], label);
  });
})();
