/** The maps of static torques: what is solved, drawn, pointed at and saved. */
const CELLS = 161; // cells of a map along each side
const WHILE_MOVED = 81; // the same while something is moved
const WHERE_SLOW = 41; // the same where that takes long
const SLOW = 30; // time of three maps from which they are made coarser while moved [ms]

/**
 * Make the maps. `current` gives the robot and its document, `move` puts the platform somewhere,
 * with the name of what moves it, `begin` starts another change.
 */
const createMaps = ({ current, move, begin }) => {
  const canvases = [];
  const titles = [];
  let solved = null; // the maps' pictures, and the torque that ends their colors
  let key = "";
  let perCell = 0; // time of three maps for one of their cells [ms]

  // No singular circle is larger than the radii together.
  const extent = () => {
    const m = current().robot.mechanism;
    return Math.min(paminsaWorkspaceCircle(m), m.base_radius + m.platform_radius) || 0.1;
  };
  const singularRadius = () => {
    const { robot, doc } = current();
    const m = robot.mechanism;
    return Math.sqrt(Math.max(0, m.base_radius ** 2 + m.platform_radius ** 2
      - 2 * m.base_radius * m.platform_radius * Math.cos(doc.pose[2])));
  };
  const differs = () => Boolean(current().doc.reference) && find("kind").value === "difference";
  const reference = () => robotOf(current().doc.reference, current().doc.knee);
  const symbol = (index) => `${differs() ? "Δ" : ""}τ${"₁₂₃"[index]}`;
  /** Return the maps that are chosen, n cells along each side. */
  const chosenMaps = (n) => {
    const { robot, doc } = current();
    const [, , theta, z] = doc.pose;
    const maps = solveMaps(robot, theta, z, extent(), n);
    if (!differs()) return maps;
    const other = solveMaps(reference(), theta, z, extent(), n);
    return maps.map((map, index) => map.map((value, cell) => value - other[index][cell]));
  };
  const solve = (moving) => {
    const { robot, doc } = current();
    const n = !moving ? CELLS : perCell * WHILE_MOVED ** 2 > SLOW ? WHERE_SLOW : WHILE_MOVED;
    const wanted = JSON.stringify([doc.design, doc.load_frame, doc.knee, doc.pose[2], doc.pose[3], n,
      differs() && doc.reference]);
    if (wanted === key) return;
    const start = performance.now();
    const maps = chosenMaps(n);
    perCell = (performance.now() - start) / n ** 2;
    const limit = colorLimit(maps, 10 ** -robot.spare.torque);
    solved = { limit, pictures: maps.map((each) => pictureOf(each, n, limit)) };
    key = wanted;
  };

  const placeIn = (canvas, event) => {
    const box = canvas.getBoundingClientRect();
    return [
      extent() * (2 * (event.clientX - box.left) / box.width - 1),
      extent() * (1 - 2 * (event.clientY - box.top) / box.height),
    ];
  };
  const writeHover = (index, [x, y]) => {
    const { robot, doc } = current();
    const pose = [x, y, doc.pose[2], doc.pose[3]];
    const found = solvePose(robot, pose);
    const other = differs() ? solvePose(reference(), pose).torques[index] : 0;
    const value = found.ok ? `${number(found.torques[index] - other, 3 + robot.spare.torque)} N·m` : "out of reach";
    find("hover").textContent =
      `x ${millimeters(robot, x)} mm, y ${millimeters(robot, y)} mm: ${symbol(index)} ${value}`;
  };
  [0, 1, 2].forEach((index) => {
    const figure = document.createElement("figure");
    const title = document.createElement("figcaption");
    const canvas = document.createElement("canvas");
    canvas.setAttribute("role", "img");
    figure.append(title, canvas);
    find("maps").append(figure);
    canvases.push(canvas);
    titles.push(title);
    const go = (event) => {
      const [x, y] = placeIn(canvas, event).map((value) => Number(value.toFixed(6)));
      move({ 0: x, 1: y }, `map.${index}`);
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      begin();
      go(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) go(event);
      writeHover(index, placeIn(canvas, event));
    });
  });

  /** Draw the maps; return what the floor of the 3D view shows of them. */
  const draw = (torques, moving) => {
    solve(moving);
    const { pictures, limit } = solved;
    const spare = current().robot.spare.torque;
    const [radius, singular] = [extent(), singularRadius()];
    canvases.forEach((canvas, index) => {
      titles[index].textContent = `${symbol(index)}: ±${number(limit, 1 + spare)} N·m`;
      canvas.setAttribute("aria-label", `Map of the static torque of M${index + 1}; `
        + `${number(torques[index], 3 + spare)} N·m at the pose`);
    });
    // All texts are written by now: each size that is read after a text has the page laid out again.
    canvases.forEach((canvas, index) => {
      const { context, width } = contextOf(canvas);
      drawMap(context, width, pictures[index], current().doc.pose, radius, singular);
    });
    return { pictures, radius, singular };
  };

  /** Return the maps for a file: light, of one size, with what they are of. */
  const forFile = () => {
    const { robot, doc } = current();
    const [side, gap, line] = [480, 16, 24];
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [3 * side + 4 * gap, side + 4 * line];
    const context = canvas.getContext("2d");
    const wasDark = isDark();
    document.documentElement.classList.remove("dark"); // not seen: nothing is drawn in between
    context.fillStyle = colorOf("paper");
    context.fillRect(0, 0, canvas.width, canvas.height);
    const write = (text, left, row) => {
      context.fillStyle = colorOf("ink");
      context.font = "16px system-ui, sans-serif";
      context.fillText(text, left, row, canvas.width - left - gap);
    };
    solved.pictures.forEach((picture, index) => {
      const left = gap + index * (side + gap);
      write(titles[index].textContent, left, line - 6);
      context.setTransform(1, 0, 0, 1, left, line);
      drawMap(context, side, picture, doc.pose, extent(), singularRadius());
      context.setTransform(1, 0, 0, 1, 0, 0);
    });
    const [x, y, theta, z] = doc.pose;
    const less = differs() ? `, less those of “${doc.reference.name}”` : "";
    write(`Static torques of “${doc.name}”${less}; ${doc.knee} knee, θ = ${number(DEGREES * theta, 2)}°, `
      + `z = ${millimeters(robot, z)} mm. Circle: pose x = ${millimeters(robot, x)} mm, y = ${millimeters(robot, y)} mm.`,
    gap, side + 2 * line);
    const edge = number(1e3 * extent(), robot.spare.place);
    write(`x and y from −${edge} to ${edge} mm. Blue: negative, `
      + `red: positive. Gray: out of reach. Dashed: singular. ${PAGE.madeBy}.`, gap, side + 3 * line);
    document.documentElement.classList.toggle("dark", wasDark);
    return canvas;
  };
  return { draw, forFile };
};
