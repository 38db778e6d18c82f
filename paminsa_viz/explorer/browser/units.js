/**
 * Puts the unit of an input behind its field: of a label `x [mm]`, the name is seen before it; and
 * sets symbols such as `m_B3`, `m₂` and `k` as variables, with their subscripts, also on buttons, in
 * lists and in tooltips.
 *
 * The style sheet shows name and unit from attributes; a name with subscripts is an element beside
 * the label. The label's own text stays as it is, unseen:
 * it names the field for screen readers, and viser may write it again. Where there is no field to
 * put the unit behind, the label is seen as it is.
 */
(() => {
  "use strict";
  window.paminsaUnits?.stop();
  const LONG = { "N·m/rad": "long-units", "N·m·s/rad": "longer-units" };
  const LABEL = /^(.*\S)\s*\[(\S+)\]$/;
  /** Name and unit of a label; without a unit, neither. */
  const split = (text) => {
    const [, name, unit] = text.match(LABEL) ?? [];
    return { name, unit };
  };
  const set = (element, name, text) => {
    if (text) element.setAttribute(name, text);
    else element.removeAttribute(name);
  };
  // A variable: a letter with its index, `m_B3` or `m₂`, or one that stands alone.
  const SYMBOL = /(?<![\p{L}\p{N}])(?:([A-Za-z])(?:_([A-Za-z0-9]+)|([₀-₉]+))|([EGIJgkrtxyzθ])(?![\p{L}\p{N}]))/gu;
  const onLine = (digits) => digits.replace(/[₀-₉]/g, (digit) => digit.charCodeAt(0) - 0x2080);
  const typeset = (label, name, host = label.parentElement) => {
    let shown = host.querySelector(":scope > .pv-symbol");
    if (name.search(SYMBOL) < 0) {
      shown?.remove();
      label.removeAttribute("data-paminsa-unseen");
      return;
    }
    if (!shown) {
      shown = document.createElement("span");
      shown.className = "pv-symbol";
      shown.setAttribute("aria-hidden", "true");
      if (label.control) shown.onclick = () => label.click(); // as the label does that it stands for
      if (host === label) label.append(shown);
      else label.after(shown);
    }
    label.dataset.paminsaUnseen = "";
    const plain = document.createElement("i");
    plain.textContent = name;
    const html = plain.innerHTML.replace(SYMBOL, (_, letter, below, digits, alone) =>
      alone ? `<i>${alone}</i>` : `<i>${letter}</i><sub>${below ?? onLine(digits)}</sub>`);
    if (shown.innerHTML !== html) shown.innerHTML = html;
  };
  const { watch } = window.paminsaMarks;
  const BUTTON = ".mantine-Flex-root > .mantine-Button-root .mantine-Button-label"; // of a row
  const OPTION = ".mantine-Select-option > span:not(.pv-symbol)";
  watch(`${BUTTON}, ${OPTION}`, (label) => typeset(label, label.textContent.trim()));
  watch('[role="tooltip"]', (tooltip) => { // not notices, which may hold names of columns, x_mm
    const text = [...tooltip.childNodes].find((node) => node.nodeType === Node.TEXT_NODE);
    if (text) typeset(tooltip, text.data, tooltip);
  });
  // What is chosen of a list is the value of an input, which the page writes into its attribute too.
  const CHOSEN = "input.mantine-Select-input";
  const choose = (input) => typeset(input, input.value);
  const chosen = new MutationObserver((changes) => {
    for (const { target } of changes) if (target.matches(CHOSEN)) choose(target);
  });
  chosen.observe(document.body, { attributeFilter: ["value"], subtree: true });
  watch(CHOSEN, choose);
  window.paminsaUnits = { split, stop: () => chosen.disconnect() };
  watch("p > label[for]", (label) => {
    const row = label.closest('[data-paminsa-mark~="row"]');
    const field = row?.lastElementChild;
    if (!field || field.contains(label)) return;
    const text = label.textContent.trim();
    if (!field.querySelector(".mantine-NumberInput-root")) return typeset(label, text);
    const { name, unit } = split(text);
    set(label, "data-paminsa-name", name);
    typeset(label, name ?? text);
    // Boxes of sliders stand below each other, so that one without a unit leaves its place free.
    set(field, "data-paminsa-unit", unit ?? (field.querySelector("[role=slider]") && " "));
    if (unit in LONG) window.paminsaMarks.mark(row.parentElement.parentElement, LONG[unit], label);
  });
})();
