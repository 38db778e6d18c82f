/** Pictures of the page in one file: the robot as lines, and the maps of static torques. */
const colorOf = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`);

/** Return a canvas's context and its size in page pixels, as sharp as the screen. */
const contextOf = (canvas) => {
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const wanted = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== wanted[0] || canvas.height !== wanted[1])
    [canvas.width, canvas.height] = wanted;
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
};

/** Return the joints of a leg by the paper's numbers, (x, y, z) each [m]. */
const jointsOf = (robot, leg, index) => {
  const { k, base_radius: base, shaft } = robot.mechanism;
  const { rho, r9, zeta, z9 } = leg;
  const at = (r, z) =>
    [base * AXIS_X[index] + r * leg.ux, base * AXIS_Y[index] + r * leg.uy, z];
  return {
    axis: at(0, 0),
    2: at(0, zeta / k + shaft),
    3: at(0, zeta / k),
    4: at(rho / k + (k - 1) / k * r9, zeta / k + (k - 1) / k * z9),
    5: at(rho, zeta),
    7: at(-rho / (k * (k - 1)) - r9 / k, zeta / k - z9 / k),
    8: at(-rho / (k - 1), 0),
    9: at(r9, z9),
  };
};

/** Draw the robot at a pose that it can take, as seen from two angles [rad]. */
const drawRobot = (canvas, robot, pose, solved, view) => {
  const { context: draw, width, height } = contextOf(canvas);
  const m = robot.mechanism;
  const size = m.base_radius + m.stroke + m.crank;
  const scale = Math.min(width, height) / (1.25 * size);
  const [ca, sa, ce, se] = [
    Math.cos(view.turn), Math.sin(view.turn), Math.cos(view.tilt), Math.sin(view.tilt),
  ];
  const middle = (pose[3] + m.shaft) / 2;
  const shown = ([x, y, z]) => [
    width / 2 + scale * (ca * x + sa * y),
    height / 2 - scale * (ce * (z - middle) + se * (ca * y - sa * x)),
  ];
  const line = (points, color, thick) => {
    draw.beginPath();
    points.map(shown).forEach(([x, y], at) => (at ? draw.lineTo(x, y) : draw.moveTo(x, y)));
    draw.strokeStyle = color;
    draw.lineWidth = thick;
    draw.stroke();
  };
  draw.lineJoin = draw.lineCap = "round";
  const circle = (radius, z) => Array.from({ length: 73 }, (_, index) => {
    const angle = index * Math.PI / 36;
    return [radius * Math.cos(angle), radius * Math.sin(angle), z];
  });
  line(circle(m.base_radius, 0), colorOf("faint"), 2);
  const legs = solved.legs.map((leg, index) => jointsOf(robot, leg, index));
  const top = [0, 0, legs[0][2][2]];
  legs.forEach((joint, index) => {
    const color = colorOf(`m${index + 1}`);
    line([top, joint[2], joint[3]], colorOf("m4"), 3);
    line([joint.axis, joint[8]], colorOf("muted"), 4);
    for (const bar of [[4, 3, 7], [9, 4, 5], [7, 8], [8, 9]])
      line(bar.map((name) => joint[name]), color, 5);
    draw.fillStyle = colorOf("ink");
    for (const name of [3, 4, 5, 7, 8, 9]) {
      const [x, y] = shown(joint[name]);
      draw.beginPath();
      draw.arc(x, y, 3, 0, 7);
      draw.fill();
    }
  });
  const fives = legs.map((joint) => joint[5]);
  line([...fives, fives[0]], colorOf("ink"), 6);
};

const COLD = [33, 102, 172];
const HOT = [178, 24, 43];

/** Return the torque at the ends of the colors: three times that of the middle cell [N m]. */
const colorLimit = (maps) => {
  const all = new Float64Array(maps.reduce((sum, map) => sum + map.length, 0));
  maps.reduce((at, map) => (all.set(map, at), at + map.length), 0);
  const sizes = all.map(Math.abs).filter(Number.isFinite).sort();
  return sizes.length ? 3 * sizes[sizes.length >> 1] || 1 : 1;
};

/** Draw a map, its pose and what it shows; `limit` is the torque at the ends of the colors. */
const drawMap = (canvas, values, n, limit, mark, radius, singular) => {
  const { context: draw, width, height } = contextOf(canvas);
  const picture = new ImageData(n, n);
  const none = colorOf("reachless").match(/\w\w/g).map((part) => parseInt(part, 16));
  for (let index = 0; index < n * n; index++) {
    const value = values[index];
    const share = Math.max(-1, Math.min(1, value / limit));
    const end = share < 0 ? COLD : HOT;
    const row = n - 1 - Math.floor(index / n);
    const place = 4 * (row * n + index % n);
    for (let part = 0; part < 3; part++)
      picture.data[place + part] = Number.isFinite(value)
        ? 247 + (end[part] - 247) * Math.abs(share) : none[part];
    picture.data[place + 3] = 255;
  }
  const cells = drawMap.cells ||= document.createElement("canvas");
  cells.width = cells.height = n;
  cells.getContext("2d").putImageData(picture, 0, 0);
  draw.imageSmoothingEnabled = false;
  draw.drawImage(cells, 0, 0, width, height);
  const half = width / 2;
  draw.strokeStyle = "#000000";
  draw.lineWidth = 1.5;
  if (singular > 0) {
    draw.setLineDash([4, 3]);
    draw.beginPath();
    draw.arc(half, half, half * singular / radius, 0, 7);
    draw.stroke();
    draw.setLineDash([]);
  }
  draw.beginPath();
  draw.arc(half * (1 + mark[0] / radius), half * (1 - mark[1] / radius), 5, 0, 7);
  draw.fillStyle = "#ffffff";
  draw.fill();
  draw.stroke();
};
