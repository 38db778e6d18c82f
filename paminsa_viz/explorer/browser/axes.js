/**
 * Numbers at the axes of uPlot's charts as the page writes all others, see `units.number`.
 *
 * uPlot takes a function for them, which viser cannot send, and else writes them as the browser's
 * language does: 13,200 or 13.200 with a hyphen for the minus sign. viser notes a chart when it has
 * made it, in the task in which it comes into the page, so it is never drawn otherwise.
 */
(() => {
  "use strict";
  const SUPERSCRIPTS = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };
  const number = (value) => {
    const rounded = Number(value.toPrecision(9)); // places of marks are multiples: 0.30000000000000004
    const size = Math.abs(rounded);
    if (rounded && (size >= 1e5 || size < 1e-4)) {
      const [mantissa, exponent] = rounded.toExponential().split("e");
      const power = [...exponent.replace("+", "")].map((char) => SUPERSCRIPTS[char]).join("");
      return `${mantissa.replace("-", "−")}·10${power}`;
    }
    return String(rounded || 0).replace("-", "−");
  };
  const numbers = (_, values) => values.map((value) => (value === null ? "" : number(value)));
  window.paminsaMarks.watch(".uplot", (root) => {
    const known = Object.values(window.__viserTestpoints?.uplots || {});
    const chart = known.map((entry) => entry.chart).find((each) => each.root === root);
    if (!chart || chart.axes[0].values === numbers) return;
    for (const axis of chart.axes) axis.values = numbers;
    chart.redraw(false, true);
  });
})();
