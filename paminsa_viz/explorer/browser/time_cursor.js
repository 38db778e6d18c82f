/**
 * The time cursor: a line through all charts of a place, and the time that is under the pointer.
 *
 * `hostOf` and `plotOf` are those of figures.js.
 */
window.paminsaTimeCursor = (config) => {
  "use strict";
  const { every, send, hostOf, plotOf } = config;

  // Charts are looked for again and again: the page makes, widens and zooms them.
  let cursor = { slot: "", time: null };
  const charts = () => {
    const host = hostOf(document.querySelector(`[data-paminsa-slot="${cursor.slot}"]`));
    return Object.values(window.__viserTestpoints?.uplots || {})
      .map((entry) => entry.chart)
      .filter((chart) => host?.contains(chart.root));
  };
  const lineOf = (chart) => {
    const known = chart.over.querySelector(".paminsa-time-cursor");
    if (known) return known;
    const line = document.createElement("div");
    line.className = "paminsa-time-cursor";
    chart.over.appendChild(line);
    let down = null;
    chart.over.addEventListener("mousedown", (event) => { down = event.clientX; });
    chart.over.addEventListener("mouseup", (event) => {
      if (event.button !== 0 || down === null || Math.abs(event.clientX - down) > 3) return;
      const box = chart.over.getBoundingClientRect();
      window.paminsa.send("time", chart.posToVal(event.clientX - box.left, "x"));
    });
    return line;
  };
  // A chart that is zoomed shows a piece of the time, which is marked wherever the motion is seen.
  let piece = "null";
  const tellPiece = () => {
    let found = null;
    for (const { data: [times], scales: { x } } of charts()) {
      const first = times?.[0], last = times?.[times.length - 1];
      if (x.min > first || x.max < last) found = { from: Math.max(x.min, first), to: Math.min(x.max, last) };
    }
    const text = JSON.stringify(found);
    if (text !== piece && send("piece", found)) piece = text;
  };
  const drawCursor = () => {
    if (!cursor.slot) return;
    if (charts().length) tellPiece();
    for (const chart of charts()) {
      const line = lineOf(chart);
      const x = cursor.time === null ? NaN : chart.valToPos(cursor.time, "x");
      const inside = x >= -1 && x <= chart.over.clientWidth + 1;
      line.style.display = inside ? "" : "none";
      if (inside) line.style.transform = `translateX(${x}px)`;
    }
  };
  every(200, drawCursor);
  const show = (slot, time) => {
    cursor = { slot, time };
    drawCursor();
  };
  const timeUnder = ({ target, clientX }) => {
    const time = plotOf(target)?._hoverdata?.[0]?.customdata;
    if (typeof time === "number") return time;
    const chart = target.closest?.(".uplot") && charts().find((each) => each.over.contains(target));
    return chart ? chart.posToVal(clientX - chart.over.getBoundingClientRect().left, "x") : null;
  };
  return { show, timeUnder };
};
