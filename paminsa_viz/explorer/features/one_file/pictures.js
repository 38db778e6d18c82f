/** Pictures of the page in one file: the maps of static torques, with axes and color bar. */
const colorOf = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`);

// Pictures that are filled cell by cell are quicker where the processor has them.
const IN_MEMORY = { willReadFrequently: true };

const PAPER = 700; // width on paper [px]

/** Return a canvas's context and its size in page pixels, as sharp as the screen or sharper. */
const contextOf = (canvas, width = canvas.clientWidth, height = canvas.clientHeight, least = 1) => {
  const ratio = Math.max(window.devicePixelRatio || 1, least);
  const wanted = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== wanted[0] || canvas.height !== wanted[1])
    [canvas.width, canvas.height] = wanted;
  const context = canvas.getContext("2d", IN_MEMORY);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
};

/** The colors of the served page's maps, three bytes each: below the range, in it, beyond it. */
const COLORS = Uint8Array.from(PAGE.colors.match(/../g), (byte) => parseInt(byte, 16));
const STEPS = COLORS.length / 3 - 2;

/** Return a map as a picture, clear where the robot cannot be; `limit` ends the colors [N m]. */
const pictureOf = (values, n, limit) => {
  const picture = new ImageData(n, n);
  for (let index = 0; index < n * n; index++) {
    const value = values[index];
    if (!Number.isFinite(value)) continue;
    const step = Math.floor(0.5 * STEPS * (value / limit + 1));
    const color = 3 * (1 + Math.max(-1, Math.min(STEPS, step)));
    const row = n - 1 - Math.floor(index / n);
    const place = 4 * (row * n + index % n);
    for (let part = 0; part < 3; part++) picture.data[place + part] = COLORS[color + part];
    picture.data[place + 3] = 255;
  }
  return picture;
};

/** Return the colors of the range as a picture of one row. */
const stepsPicture = () => {
  const picture = new ImageData(STEPS, 1);
  picture.data.forEach((_, place) => {
    picture.data[place] = place % 4 === 3 ? 255 : COLORS[3 * (1 + (place >> 2)) + place % 4];
  });
  return picture;
};

/** Return a picture on a canvas of its own, to be drawn in any size. */
const canvasOf = (picture) => {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [picture.width, picture.height];
  canvas.getContext("2d", IN_MEMORY).putImageData(picture, 0, 0);
  return canvas;
};

/** Return contour lines as the path of the zero level and that of the others, in a unit square. */
const pathsOf = (contours) => [true, false].map((isZero) => {
  const path = new Path2D();
  for (const { pieces } of contours.filter(({ level }) => (level === 0) === isZero)) {
    for (let at = 0; at < pieces.length; at += 4) {
      path.moveTo(pieces[at], 1 - pieces[at + 1]);
      path.lineTo(pieces[at + 2], 1 - pieces[at + 3]);
    }
  }
  return path;
});

/**
 * Return where three maps and their color bar lie, as in the served page: side by side, or in two
 * rows where that is too narrow. Axes end at ±`edge` [mm], whose digits need room; `em` is the size
 * of the letters, `most` the largest side of a map.
 */
const layoutOf = (width, most, em, edge) => {
  const isWide = width >= 42 * em;
  const columns = isWide ? 3 : 2;
  const gap = 0.95 * em;
  const digits = 0.64 * em * Math.max(0, edge.toFixed(0).length - 3);
  const before = 4.7 * em + digits;
  const free = width - before - (isWide ? 6.4 : 0.8) * em - (columns - 1) * gap;
  const side = Math.max(Math.min(free / columns, most), 4 * em);
  const first = before + Math.max(0, free - columns * side) / 2;
  const panels = [0, 1, 2].map((index) => ({
    left: first + index % columns * (side + gap),
    top: 1.9 * em + Math.floor(index / columns) * (side + 1.9 * em),
    isFirst: index % columns === 0, isLowest: index + columns > 2,
  }));
  const { left, top } = panels[columns - 1];
  const bar = isWide ? { left: left + side + 0.85 * em, top, width: 0.95 * em, height: side }
    : { left: left + 0.125 * side, top: top + side + 3.95 * em, width: 0.75 * side, height: 0.95 * em };
  return { height: Math.ceil(panels[2].top + side + 3.4 * em), em, edge, digits, side, panels, bar, isWide };
};

const letter = (draw, text, x, y, align) => {
  draw.textAlign = align;
  draw.fillText(text, x, y);
};

/** Draw the color bar with pointed ends, from -limit to limit [N m]. */
const drawColorBar = (draw, { em, bar: { left, top, width, height }, isWide }, limit, colors) => {
  const [length, across] = isWide ? [height, width] : [width, height];
  const tip = 0.8 * em / (1 + 1.6 * em / length);
  const inside = length - 2 * tip;
  draw.save();
  if (isWide) draw.transform(0, -1, 1, 0, left, top + height); // along the bar, then across it
  else draw.translate(left, top);
  for (const [code, base, end] of [[0, tip, 0], [STEPS + 1, length - tip, length]]) {
    draw.fillStyle = `rgb(${COLORS.subarray(3 * code, 3 * code + 3).join()})`;
    draw.beginPath();
    for (const [x, y] of [[base, 0], [end, 0.5], [base, 1]]) draw.lineTo(x, y * across);
    draw.fill();
  }
  draw.imageSmoothingEnabled = false;
  draw.drawImage(drawColorBar.steps ||= canvasOf(stepsPicture()), tip, 0, inside, across);
  draw.beginPath();
  for (const [x, y] of [[tip, 0], [length - tip, 0], [length, 0.5], [length - tip, 1], [tip, 1], [0, 0.5]])
    draw.lineTo(x, y * across);
  draw.closePath();
  draw.stroke();
  draw.restore();
  const count = Math.max(2, Math.min(8, Math.floor(length / em / (isWide ? 2.2 : 3.2))));
  for (const value of multiples(-limit, limit, dividingStep(limit, count))) {
    const along = tip + inside * (0.5 + 0.5 * value / limit);
    const [x, y] = isWide ? [left + width, top + height - along] : [left + along, top + height];
    draw.fillStyle = colors.ink;
    draw.fillRect(x, y, isWide ? 0.27 * em : 0.07 * em, isWide ? 0.07 * em : 0.27 * em);
    draw.fillStyle = colors.soft_ink;
    if (isWide) letter(draw, roundText(value), x + 0.45 * em, y + 0.36 * em, "left");
    else letter(draw, roundText(value), x, y + 1.3 * em, "center");
  }
  if (isWide) letter(draw, "[N·m]", left, top - 0.6 * em, "left");
  else letter(draw, "[N·m]", left + width / 2, top + height + 2.6 * em, "center");
};

/** Draw the frame of a map with numbers and labels: those that no neighbor has. */
const drawAxes = (draw, { em, edge, digits, side }, { left, top, isFirst, isLowest }, colors) => {
  const least = (3.2 * em + digits) / side * 2 * edge;
  draw.strokeRect(left, top, side, side);
  for (const value of multiples(-0.84 * edge, 0.84 * edge, roundFrom(least, [1, 2, 2.5, 4, 5]))) {
    const [x, y] = [0.5 + 0.5 * value / edge, 0.5 - 0.5 * value / edge].map((share) => share * side);
    draw.fillStyle = colors.ink;
    draw.fillRect(left + x, top + side, 0.07 * em, 0.27 * em);
    draw.fillRect(left, top + y, -0.27 * em, 0.07 * em);
    draw.fillStyle = colors.soft_ink;
    if (isLowest) letter(draw, roundText(value), left + x, top + side + 1.3 * em, "center");
    if (isFirst) letter(draw, roundText(value), left - 0.45 * em, top + y + 0.36 * em, "right");
  }
  if (isLowest) letter(draw, "x [mm]", left + side / 2, top + side + 2.6 * em, "center");
  if (!isFirst) return;
  draw.save();
  draw.translate(left - 3.4 * em - digits, top + side / 2);
  draw.rotate(-Math.PI / 2);
  letter(draw, "y [mm]", 0, 0, "center");
  draw.restore();
};

/** Draw a circle on a light one, which is seen on any color. */
const drawCircle = (draw, x, y, radius, width, dash = []) => {
  draw.beginPath();
  draw.arc(x, y, radius, 0, 2 * Math.PI);
  for (const [color, wide, pattern] of [["#ffffff", 1.7 * width, []], [PAGE.ink, width, dash]]) {
    draw.strokeStyle = color;
    draw.lineWidth = wide;
    draw.setLineDash(pattern);
    draw.stroke();
  }
  draw.setLineDash([]);
};

/** Draw the inside of a map: cells, hatched where there are none, contours, the circle and marks. */
const drawMap = (draw, { em, side }, { left, top }, { cells, lines }, { extent, singular, pose, pointed }, colors) => {
  draw.save();
  draw.beginPath();
  draw.rect(left, top, side, side);
  draw.fillStyle = colors.reachless;
  draw.fill();
  draw.clip();
  draw.translate(left, top);
  draw.beginPath();
  for (let start = 0; start < 2 * side; start += 0.75 * em) {
    draw.moveTo(start, 0);
    draw.lineTo(0, start);
  }
  draw.strokeStyle = colors.hatch;
  draw.lineWidth = 0.06 * em;
  draw.stroke();
  draw.imageSmoothingEnabled = false;
  draw.drawImage(cells, 0, 0, side, side);
  draw.strokeStyle = PAGE.ink;
  lines.forEach((line, index) => {
    const path = new Path2D();
    path.addPath(line, new DOMMatrix([side, 0, 0, side, 0, 0]));
    draw.lineWidth = [0.1, 0.05][index] * em;
    draw.stroke(path);
  });
  const at = ([x, y]) => [side * (0.5 + 0.5 * x / extent), side * (0.5 - 0.5 * y / extent)];
  if (singular > 0)
    drawCircle(draw, side / 2, side / 2, 0.5 * side * singular / extent, 0.11 * em, [0.42 * em, 0.31 * em]);
  draw.beginPath();
  draw.arc(...at(pose), 0.4 * em, 0, 7);
  draw.fillStyle = "#ffffff";
  draw.fill();
  drawCircle(draw, ...at(pose), 0.29 * em, 0.1 * em);
  drawCircle(draw, ...at(pose), 0.05 * em, 0.1 * em);
  if (pointed) drawCircle(draw, ...at(pointed), 0.43 * em, 0.13 * em);
  draw.restore();
};

/**
 * Draw the maps with axes and color bar. `maps` has the cells of each on a canvas, its contour
 * lines, its name and its color; `shown` what they have in common: the torque `limit` that ends the colors [N m], half
 * of a map's side `extent`, the radius of the `singular` circle, the `pose` and the `pointed`
 * place, which may be null [m].
 */
const drawMaps = (draw, layout, maps, shown) => {
  const { em, side, panels } = layout;
  const colors = Object.fromEntries(["ink", "soft_ink", "reachless", "hatch"].map((name) => [name, colorOf(name)]));
  draw.font = `bold ${1.15 * em}px system-ui, sans-serif`;
  maps.forEach((map, index) => {
    const { left, top } = panels[index];
    drawMap(draw, layout, panels[index], map, shown, colors);
    draw.fillStyle = colorOf(map.color);
    letter(draw, map.name, left + side / 2, top - 0.5 * em, "center");
  });
  draw.font = `${em}px system-ui, sans-serif`; // once: a font takes longer than a map
  draw.strokeStyle = colors.ink;
  draw.lineWidth = 0.07 * em;
  for (const panel of panels) drawAxes(draw, layout, panel, colors);
  drawColorBar(draw, layout, shown.limit, colors);
};
