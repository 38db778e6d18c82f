/**
 * Numbers that are longer than their box are shown rounded, or as 3.8e-8, so that no digit before
 * the point and no power of ten is cut off. The box itself keeps the number with all its digits,
 * and shows it while it has the focus.
 *
 * The style sheet shows `data-paminsa-short`, which is on the wrapper of the input, over its text.
 */
(() => {
  "use strict";
  window.paminsaShortNumbers?.stop();
  const INPUT = "input.mantine-NumberInput-input";
  const SURE = 8; // characters that every box holds: seven digits and a point
  const DIGITS = 15;
  const pen = document.createElement("canvas").getContext("2d");

  /** The longest text of a number that fits, with the most digits; undefined if none does. */
  const shorten = (number, fits) => {
    for (let digits = DIGITS; digits > 0; digits--) {
      const rounded = Number(number.toPrecision(digits));
      const power = rounded.toExponential().replace("e+", "e");
      const found = [String(rounded), power].find((text) => fits(text));
      if (found) return found;
    }
    return undefined;
  };
  const fit = (field) => {
    const { value, parentElement: box } = field; // the field itself is wider as long as it is edited
    const number = value.length > SURE && box.clientWidth ? Number(value) : NaN;
    let short;
    if (Number.isFinite(number)) {
      const { font, paddingLeft, paddingRight } = getComputedStyle(field);
      const around = field.offsetWidth - field.clientWidth + parseFloat(paddingLeft) + parseFloat(paddingRight);
      pen.font = font;
      const fits = (text) => pen.measureText(text).width <= box.clientWidth - around;
      short = fits(value) ? undefined : shorten(number, fits);
    }
    if (short) box.dataset.paminsaShort = short;
    else delete box.dataset.paminsaShort;
  };

  // The page writes a box's number into its attribute too; what a section hides has no size.
  const values = new MutationObserver((changes) => {
    for (const { target } of changes) if (target.matches(INPUT)) fit(target);
  });
  const sizes = new ResizeObserver((changes) => {
    for (const { target } of changes) fit(target.querySelector(INPUT));
  });
  values.observe(document.body, { attributeFilter: ["value"], subtree: true });
  window.paminsaMarks.watch(INPUT, (field) => sizes.observe(field.parentElement));

  window.paminsaShortNumbers = { stop: () => { values.disconnect(); sizes.disconnect(); } };
})();
