/** Pictures of the page in one file: the maps of static torques. */
const colorOf = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`);

// Pictures that are filled cell by cell are quicker where the processor has them.
const IN_MEMORY = { willReadFrequently: true };

/** Return a canvas's context and its size in page pixels, as sharp as the screen. */
const contextOf = (canvas) => {
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
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

/**
 * Return the torque at the ends of the colors: three times that of the middle cell [N m]. What
 * rounding leaves of a balanced robot has no colors; `one` is a torque of the robot's size [N m].
 */
const colorLimit = (maps, one) => {
  const all = new Float64Array(maps.reduce((sum, map) => sum + map.length, 0));
  maps.reduce((at, map) => (all.set(map, at), at + map.length), 0);
  const sizes = all.map(Math.abs).filter(Number.isFinite).sort();
  const limit = sizes.length ? 3 * sizes[sizes.length >> 1] : 0;
  return limit > 1e-9 * one ? limit : one;
};

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

/** Draw a map's picture into a square, with the pose on it and the singular circle. */
const drawMap = (draw, side, picture, mark, radius, singular) => {
  const cells = drawMap.cells ||= document.createElement("canvas");
  cells.width = cells.height = picture.width;
  cells.getContext("2d", IN_MEMORY).putImageData(picture, 0, 0);
  draw.fillStyle = colorOf("reachless");
  draw.fillRect(0, 0, side, side);
  draw.imageSmoothingEnabled = false;
  draw.drawImage(cells, 0, 0, side, side);
  const half = side / 2;
  draw.strokeStyle = "#000000";
  draw.lineWidth = 1.5;
  if (singular > 0) {
    draw.beginPath();
    draw.arc(half, half, half * singular / radius, 0, 7);
    draw.strokeStyle = "#ffffff"; // between the dashes: black alone is lost on the dark theme
    draw.stroke();
    draw.strokeStyle = "#000000";
    draw.setLineDash([4, 3]);
    draw.stroke();
    draw.setLineDash([]);
  }
  draw.beginPath();
  draw.arc(half * (1 + mark[0] / radius), half * (1 - mark[1] / radius), 5, 0, 7);
  draw.fillStyle = "#ffffff";
  draw.fill();
  draw.stroke();
};
