/** The maps of static torques: what is solved, drawn, pointed at and saved. */
const CELLS = 161; // cells of a map along each side
const WHILE_MOVED = 81; // the same while something is moved
const WHERE_SLOW = 41; // the same where that takes long, and of a pinned design for its colors
const SLOW = 30; // time of three maps from which they are made coarser while moved [ms]
const LETTERS = 11; // their size [px]
const SHARE = 0.27; // largest side of a map, of the window's height
const DRAGGED = 6; // from here on a finger drags the robot [px]
const MAP_COLORS = ["m1", "m2", "m3"];

/**
 * Make the maps. `current` gives the robot and its document, `move` puts the platform somewhere,
 * with the name of what moves it, `begin` starts another change.
 */
const createMaps = ({ current, move, begin }) => {
  const canvas = find("map");
  let solved = null; // the maps' pictures and cells, and the torque that ends their colors
  let key = "";
  let perCell = 0; // time of three maps for one of their cells [ms]
  let layout = null;
  let onPaper = false;
  let pointed = null; // the place that is read [m]
  let held = null; // the pointer that moves the robot, once it is no scroll of the page

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
  const mapsOf = (robot, n) => {
    const [, , theta, z] = current().doc.pose;
    return solveMaps(robot, theta, z, extent(), n);
  };
  /** Return the maps that are chosen, n cells along each side. */
  const chosenMaps = (n) => {
    const maps = mapsOf(current().robot, n);
    if (!differs()) return maps;
    const other = mapsOf(reference(), n);
    return maps.map((map, index) => map.map((value, cell) => value - other[index][cell]));
  };
  /** Return the end of the colors: where a design is pinned, of both, so that they compare. */
  const limitOf = (maps, one) => {
    const own = colorLimit(maps, one);
    if (!current().doc.reference || differs()) return own;
    return Math.max(own, colorLimit(mapsOf(reference(), WHERE_SLOW), one));
  };
  const solve = (moving) => {
    const { robot, doc } = current();
    const n = !moving ? CELLS : perCell * WHILE_MOVED ** 2 > SLOW ? WHERE_SLOW : WHILE_MOVED;
    const wanted = JSON.stringify([doc.design, doc.load_frame, doc.knee, doc.pose[2], doc.pose[3], n,
      doc.reference, differs()]);
    if (wanted === key) return;
    const start = performance.now();
    const maps = chosenMaps(n);
    perCell = (performance.now() - start) / n ** 2;
    const one = 10 ** -robot.spare.torque;
    // While something is moved the colors mean what they did: maps are seen to grow or fade.
    const limit = moving && solved ? solved.limit : limitOf(maps, one);
    const pictures = maps.map((each) => pictureOf(each, n, limit));
    const isZero = maps.every((map) => map.every((value) => !(Math.abs(value) > 1e-9 * one)));
    const contours = maps.map((each) => contourLines(each, n, limit, singularRadius() / (2 * extent())));
    solved = { limit, pictures, cells: pictures.map(canvasOf), lines: contours.map(pathsOf), isZero };
    key = wanted;
  };
  const named = () => solved.cells.map((cells, index) =>
    ({ cells, lines: solved.lines[index], name: symbol(index), color: MAP_COLORS[index] }));
  const seen = () => ({ limit: solved.limit, extent: extent(), singular: singularRadius(), pose: current().doc.pose });

  // --- the place that is read -----------------------------------------------------------------
  const round = (value) => Number(value.toFixed(6));
  /** Return the place of a map under a pointer, at most at its edge; null outside of the maps. */
  const placeIn = (event, near) => {
    if (!layout) return null;
    const box = canvas.getBoundingClientRect();
    const { side, panels } = layout;
    const at = [event.clientX - box.left, event.clientY - box.top];
    const shares = panels.map(({ left, top }) => [(at[0] - left) / side, (at[1] - top) / side]);
    const outside = (share) => Math.max(...share.map((part) => Math.abs(part - 0.5)));
    const share = shares.reduce((best, each) => (outside(each) < outside(best) ? each : best));
    if (outside(share) > 0.5 && !near) return null;
    const [x, y] = share.map((part) => Math.max(0, Math.min(1, part)));
    return [extent() * (2 * x - 1), extent() * (1 - 2 * y)].map(round);
  };
  const writeRead = () => {
    find("hover").className = pointed ? "read" : "";
    if (!pointed) {
      find("read").textContent = "";
      return;
    }
    const { robot, doc } = current();
    const pose = [...pointed, doc.pose[2], doc.pose[3]];
    const found = solvePose(robot, pose);
    const other = differs() ? solvePose(reference(), pose) : { ok: true, torques: [0, 0, 0] };
    const values = [0, 1, 2].map((index) =>
      `${symbol(index)} = ${number(found.torques[index] - other.torques[index], 3 + robot.spare.torque)}`);
    const why = found.ok ? "out of the pinned design’s reach" : `out of reach: leg ${found.leg}, ${PAGE.limits[found.limit]}`;
    find("read").textContent = `x = ${millimeters(robot, pointed[0])} mm, y = ${millimeters(robot, pointed[1])} mm: `
      + (found.ok && other.ok ? `${values.join(", ")} N·m` : why);
  };
  const read = (place, byKeys = false) => {
    pointed = place;
    find("read").setAttribute("aria-live", byKeys ? "polite" : "off");
    draw();
  };
  const go = ([x, y]) => {
    pointed = [x, y];
    move({ 0: x, 1: y }, "map");
  };
  canvas.addEventListener("pointerdown", (event) => {
    const place = event.button === 0 && placeIn(event);
    if (!place) return;
    held = { x: event.clientX, y: event.clientY, isDrag: event.pointerType !== "touch" };
    if (!held.isDrag) return; // it may be a scroll, which moves no robot
    canvas.setPointerCapture(event.pointerId);
    begin();
    go(place);
  });
  canvas.addEventListener("pointermove", (event) => {
    const [dx, dy] = held ? [event.clientX - held.x, event.clientY - held.y] : [0, 0];
    if (held && !held.isDrag && Math.hypot(dx, dy) > DRAGGED) {
      // Up and down a finger scrolls a page that is higher than the screen.
      if (Math.abs(dx) > Math.abs(dy) || getComputedStyle(canvas).touchAction === "none") {
        held.isDrag = true;
        begin();
      } else held = null;
    }
    if (held?.isDrag) go(placeIn(event, true));
    else if (!held && event.pointerType !== "touch") read(placeIn(event));
  });
  canvas.addEventListener("pointerup", (event) => {
    if (held && !held.isDrag) {
      begin();
      go(placeIn(event, true));
    }
    held = null;
  });
  canvas.addEventListener("pointercancel", () => {
    held = null;
  });
  canvas.addEventListener("pointerleave", (event) => {
    if (event.pointerType === "mouse" && !held) read(null);
  });
  canvas.addEventListener("blur", () => read(null));
  canvas.addEventListener("keydown", (event) => {
    const along = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Enter" && pointed) {
      begin();
      go(pointed);
    } else if (event.key === "Escape" && pointed) read(null);
    else if (along) {
      const step = roundFrom(extent() / 60, [1, 2, 5]);
      const from = pointed ?? current().doc.pose.slice(0, 2);
      const most = extent();
      read(from.map((part, axis) => Math.max(-most, Math.min(most, round(part + along[axis] * step)))), true);
    } else return;
    event.preventDefault();
  });

  // --- drawing --------------------------------------------------------------------------------
  const draw = () => {
    if (!solved) return;
    writeRead();
    const width = onPaper ? PAPER : find("maps").clientWidth;
    layout = layoutOf(width, Math.max(SHARE * window.innerHeight, 10 * LETTERS), LETTERS, 1e3 * extent());
    const size = `aspect-ratio: ${width} / ${layout.height}; width: ${width}px`;
    // On paper it has the paper's width, by the page's style: WebGL prints nothing once the screen's
    // layout, and the robot's size with it, has changed.
    if (!onPaper && canvas.getAttribute("style") !== size) canvas.setAttribute("style", size);
    const { context } = contextOf(canvas, width, layout.height, onPaper ? 3 : 1);
    drawMaps(context, layout, named(), { ...seen(), pointed });
  };
  const place = () => {
    const { robot, doc } = current();
    const told = `at θ_=_${number(DEGREES * doc.pose[2], 2)}°, z_=_${millimeters(robot, doc.pose[3])}_mm`;
    return told.replaceAll("_", "\u00a0"); // no line ends before a number or its unit
  };
  const less = () => (differs() ? `, difference from “${current().doc.reference.name}”,` : "");

  /** Write and draw the maps; return what the floor of the 3D view shows of them. */
  const show = (torques, moving, paper) => {
    solve(moving);
    onPaper = paper;
    const { robot } = current();
    const title = Object.assign(document.createElement("b"), { textContent: `Static torques${less()}` });
    find("place").replaceChildren(title, ` ${place()}${solved.isZero ? ": 0 everywhere" : ""}`);
    const limit = roundText(solved.limit);
    canvas.setAttribute("aria-label", `Maps of the static torques of M1, M2 and M3${less()} ${place()}, colors from `
      + `−${limit} to ${limit} N·m; at the pose ${torques.slice(0, 3).map((each) => number(each, 3 + robot.spare.torque)).join(", ")} N·m. `
      + "Arrow keys move the place that is read, Enter goes there, Escape ends it.");
    draw();
    return { pictures: solved.pictures, radius: extent(), singular: singularRadius() };
  };

  /** Return the maps for a file: light, of one size, with what they are of. */
  const forFile = () => {
    const { robot, doc } = current();
    const [em, width] = [16, 1500];
    const fileLayout = layoutOf(width, width, em, 1e3 * extent());
    const file = document.createElement("canvas");
    [file.width, file.height] = [width, fileLayout.height + 4.5 * em];
    const context = file.getContext("2d");
    const wasDark = isDark();
    document.documentElement.classList.remove("dark"); // not seen: nothing is drawn in between
    context.fillStyle = colorOf("paper");
    context.fillRect(0, 0, file.width, file.height);
    drawMaps(context, fileLayout, named(), seen());
    const [x, y] = doc.pose.map((each) => millimeters(robot, each));
    [
      `Static torques of “${doc.name}”${less()} ${place()}; ${doc.knee} knee. Ring: pose x = ${x} mm, y = ${y} mm.`,
      `Hatched: not reachable. Dashed: singular positions. Pointed ends of the color bar: beyond its range. ${PAGE.madeBy}.`,
    ].forEach((text, row) => {
      context.fillStyle = colorOf("soft_ink");
      context.textAlign = "left";
      context.fillText(text, em, fileLayout.height + (1.6 + 1.5 * row) * em, width - 2 * em);
    });
    document.documentElement.classList.toggle("dark", wasDark);
    return file;
  };
  return { draw: show, forFile };
};
