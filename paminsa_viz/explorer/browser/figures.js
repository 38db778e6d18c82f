/**
 * Figures of the page: how wide their places are, and clicks on maps and on Plotly figures.
 */
window.paminsaFigures = (config) => {
  "use strict";
  const { every, send, signal } = config;

  // --- places: which are visible, and how wide ----------------------------------------------
  const hostOf = (mark) => mark?.parentElement?.parentElement;
  let reported = "";
  let again = 0;
  every(200, () => {
    const found = { ratio: window.devicePixelRatio };
    for (const mark of document.querySelectorAll("[data-paminsa-slot]")) {
      const host = hostOf(mark);
      if (!host) continue;
      const visible = host.clientHeight > 0 && host.getClientRects().length > 0;
      const width = host.clientWidth;
      found[mark.dataset.paminsaSlot] = visible ? width : 0;
    }
    const now = JSON.stringify(found);
    if (now !== reported) {
      reported = now;
      again = 3;
    }
    if (again > 0 && send("slots", found)) again -= 1;
  });

  // --- clicks -------------------------------------------------------------------------------
  // A press counts if the figure itself is under the pointer, not what lies over it. Where it is let
  // go says nothing: while a figure is pressed, Plotly lays a cover over the window.
  const plotOf = (element) => {
    const plot = element.closest?.(".js-plotly-plot");
    return plot?._fullLayout?._plots ? plot : null;
  };
  // Maps are read in the frame that came with their picture.
  const mapOf = (element) => {
    const map = element.dataset?.paminsaPicture;
    const marks = map && element.closest('[data-paminsa-mark~="maps"]')?.querySelector("[data-paminsa-frame]");
    return marks && { map, ...JSON.parse(marks.dataset.paminsaFrame), box: marks.getBoundingClientRect() };
  };
  const placeInMap = ({ map, edges, panels, box }, place) => {
    const [left, right, bottom, top] = edges;
    for (const [panel, [start, head, width, height]] of panels.entries()) {
      const across = ((place[0] - box.left) / box.width - start) / width;
      const down = ((place[1] - box.top) / box.height - head) / height;
      if (across < 0 || down < 0 || across > 1 || down > 1) continue;
      return { map, panel, x: left + across * (right - left), y: top - down * (top - bottom) };
    }
    return null;
  };
  let pressed = null;
  const onPointer = (event) => {
    const place = [event.clientX, event.clientY];
    if (event.type === "pointerdown") {
      const { target } = event;
      pressed = event.button === 0 && { map: mapOf(target), plot: plotOf(target), place };
      return;
    }
    if (!pressed) return;
    const { map, plot, place: start } = pressed;
    pressed = null;
    if (Math.hypot(place[0] - start[0], place[1] - start[1]) > 4) return;
    if (map) {
      const found = placeInMap(map, start);
      if (found) send("click", { title: map.map, x: found.x, y: found.y });
      return;
    }
    if (!plot) return;
    const title = String(plot._fullLayout.meta || "");
    const box = plot.getBoundingClientRect();
    for (const { xaxis, yaxis } of Object.values(plot._fullLayout._plots)) {
      const x = place[0] - box.left - xaxis._offset;
      const y = place[1] - box.top - yaxis._offset;
      if (x < 0 || y < 0 || x > xaxis._length || y > yaxis._length) continue;
      send("click", { title, x: xaxis.p2d(x), y: yaxis.p2d(y) });
      return;
    }
  };
  for (const kind of ["pointerdown", "pointerup"])
    document.addEventListener(kind, onPointer, { capture: true, signal });

  const placeUnder = ({ target, clientX, clientY }) => {
    const map = mapOf(target);
    return map ? placeInMap(map, [clientX, clientY]) : null;
  };
  return { hostOf, plotOf, placeUnder };
};
