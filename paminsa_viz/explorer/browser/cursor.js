/**
 * One cursor for all maps, the motion plots and the scene: where the pointer is in one of them is
 * marked in the others, and a map's value there is written at it. Where the robot is at a time, the
 * mark in the scene and the values the server knows.
 */
(() => {
  "use strict";
  const MARK = "pv-cursor";
  const PERIOD = 50; // between messages [ms]

  const clear = () => document.querySelectorAll(`.${MARK}`).forEach((mark) => mark.remove());

  /** Where a place {x, y} [mm] is in a map, as parts of the width and height of its frame. */
  const inMap = ({ edges: [left, right, bottom, top] }, [start, head, width, height], [x, y]) => {
    const across = (x - left) / (right - left), down = (top - y) / (top - bottom);
    const inside = across >= 0 && across <= 1 && down >= 0 && down <= 1;
    return inside ? [start + across * width, head + down * height] : null;
  };

  /** Mark a place {x, y} [mm] in all panels of all maps but the one under the pointer. */
  const show = (place, pointer = null) => {
    clear();
    if (!place) return;
    for (const markers of document.querySelectorAll("[data-paminsa-frame]")) {
      const box = markers.getBoundingClientRect();
      if (!box.width) continue;
      const frame = JSON.parse(markers.dataset.paminsaFrame);
      for (const panel of frame.panels) {
        const at = inMap(frame, panel, [place.x, place.y]);
        if (!at) break;
        const far = pointer && Math.hypot(
          box.left + at[0] * box.width - pointer[0], box.top + at[1] * box.height - pointer[1]);
        if (pointer && far < 3) continue;
        const mark = document.createElement("u");
        mark.className = MARK;
        mark.style.left = `${100 * at[0]}%`;
        mark.style.top = `${100 * at[1]}%`;
        markers.append(mark);
      }
    }
  };

  // The path of the piece of time that the motion plots show, over all maps: [[x, y], …] [mm].
  let piece = [];
  const SVG = "http://www.w3.org/2000/svg";
  const drawn = new WeakMap(); // of a map's drawing, the piece
  const drawPiece = (markers) => {
    const before = markers.querySelector(".pv-piece");
    if (before ? drawn.get(before) === piece : !piece.length) return; // drawing calls this again
    before?.remove();
    if (!piece.length) return;
    const frame = JSON.parse(markers.dataset.paminsaFrame);
    const drawing = document.createElementNS(SVG, "svg");
    drawn.set(drawing, piece);
    drawing.setAttribute("class", "pv-piece");
    drawing.setAttribute("viewBox", "0 0 1 1");
    drawing.setAttribute("preserveAspectRatio", "none");
    const steps = frame.panels.flatMap((panel) => {
      const places = piece.map((place) => inMap(frame, panel, place));
      return places.map((at, i) => at && `${places[i - 1] ? "L" : "M"}${at[0]} ${at[1]}`);
    });
    for (let layer = 0; layer < 2; layer += 1) { // a light one below
      const line = document.createElementNS(SVG, "path");
      line.setAttribute("d", steps.filter(Boolean).join(""));
      drawing.append(line);
    }
    markers.append(drawing);
  };
  const showPiece = (places) => {
    piece = places;
    document.querySelectorAll("[data-paminsa-frame]").forEach(drawPiece);
  };
  window.paminsaMarks?.watch("[data-paminsa-frame]", drawPiece);

  // What a map says at the pointer, beside it: on the side where there is room.
  let readout = null;
  let pointer = null; // where it is over a map
  const OFF = 12; // from the pointer [px]
  const placeReadout = () => {
    if (!pointer) readout?.remove();
    if (!pointer || !readout?.isConnected) return;
    const { offsetWidth: width, offsetHeight: height } = readout;
    const [x, y] = pointer;
    readout.style.left = `${x + OFF + width > innerWidth ? x - OFF - width : x + OFF}px`;
    readout.style.top = `${y + OFF + height > innerHeight ? y - OFF - height : y + OFF}px`;
  };
  const showReadout = (html) => {
    if (!pointer) return; // it has gone on
    readout ??= document.createElement("div");
    readout.className = "pv-readout";
    readout.dataset.testid = "map-readout";
    readout.innerHTML = html;
    document.body.append(readout);
    placeReadout();
  };

  /**
   * Follow the pointer. `placeUnder` and `timeUnder` say of an event which place of which map [mm]
   * or which time of a motion plot [s] is under it, or null; `send` tells the server.
   */
  const follow = ({ placeUnder, timeUnder, send, signal }) => {
    let last = null; // the newest event, till it is looked at
    let told = "null";
    let timer = 0;
    let next = null;
    const tell = (data) => {
      next = data;
      timer ||= setTimeout(() => {
        timer = 0;
        const text = JSON.stringify(next);
        if (text !== told && send("hover", next)) told = text;
      }, PERIOD);
    };
    const look = () => {
      const event = last;
      last = null;
      const counts = event.type === "pointermove" && !event.buttons; // nothing is dragged
      const place = counts ? placeUnder(event) : null;
      const time = counts && !place ? timeUnder(event) : null;
      pointer = place && [event.clientX, event.clientY];
      placeReadout();
      if (place) show(place, pointer);
      else if (time === null) clear();
      const found = place ?? (time === null ? null : { time });
      if (found || told !== "null" || timer) tell(found);
    };
    for (const kind of ["pointermove", "pointerdown", "pointerleave"])
      document.documentElement.addEventListener(kind, (event) => {
        if (kind === "pointerleave" && event.target !== document.documentElement) return;
        if (!last) requestAnimationFrame(look);
        last = event;
      }, { capture: true, passive: true, signal });
  };
  window.paminsaCursor = { follow, show, showPiece, showReadout };
})();
