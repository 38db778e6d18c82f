/** Inputs, numbers and undo of the page in one file. A step is a whole document; links hold one. */
(() => {
  const find = (id) => document.getElementById(id);
  const CELLS = 81; // cells of a map along each side
  const WHILE_MOVED = 41; // the same while something is moved, where the maps are slow
  const SLOW = 30; // time of three maps from which they are made coarser while moved [ms]
  const NEAR = 10; // condition number from which a pose is near a singularity

  let doc = null;
  let robot = null;
  let shown = null; // the last pose that can be taken, with what was solved there
  const back = [];
  const forward = [];
  let moving = false;
  let spent = 0;

  // --- the document ---------------------------------------------------------------------------
  const say = (text) => {
    find("message").textContent = text;
    find("message").hidden = !text;
  };
  let lastSource = "";
  const set = (changed, source = "") => {
    if (changed === doc || JSON.stringify(changed) === JSON.stringify(doc)) return;
    const found = poseProblem(changed.pose)
      || [changed, changed.reference ?? changed].map(problem).find(Boolean);
    if (found) {
      say(`${found}; nothing was changed`);
      draw();
      return;
    }
    say("");
    if (doc && !(source && source === lastSource)) back.push(doc);
    lastSource = source;
    forward.length = 0;
    take(changed);
  };
  const take = (changed) => {
    doc = changed;
    robot = robotOf(doc);
    request();
    follow();
  };
  const undo = (from, to) => {
    if (!from.length) return;
    to.push(doc);
    lastSource = "";
    say("");
    take(from.pop());
  };
  const move = (changes, source) =>
    set({ ...doc, pose: doc.pose.map((value, index) => changes[index] ?? value) }, source);
  const vary = (path, value, source) =>
    set({ ...doc, design: { ...doc.design, [path]: value } }, source);
  /** Return the ends of a pose's slider, as the served page has them. */
  const poseRange = (index, entry) => {
    if (index === 2) return [entry.low, entry.high];
    const { grain, leastSteps } = PAGE;
    if (index < 2) {
      const steps = Math.max(Math.ceil(1e3 * paminsaWorkspaceCircle(robot.mechanism) / grain), leastSteps);
      return [-steps * grain, steps * grain];
    }
    const { low, high } = paminsaPlatformRange(robot.mechanism);
    const least = Math.ceil(1e3 * low / grain) * grain;
    return [least, Math.max(Math.floor(1e3 * high / grain) * grain, least + grain)];
  };
  const setKnee = (knee) => {
    if (knee === doc.knee) return;
    const [x, y, theta, z] = doc.pose;
    const height = valueOf(doc, "geometry.platform_joint_height");
    set({ ...doc, knee, pose: [x, y, theta, -z - 2 * height] });
  };

  // --- links: the address follows the work ----------------------------------------------------
  let timer = 0;
  let address = window.location.hash;
  const follow = () => {
    clearTimeout(timer);
    timer = setTimeout(async () => {
      address = `#${await shareCode(doc)}`;
      try {
        window.history.replaceState(null, "", address);
      } catch (error) {
        console.warn(error); // a browser that lets no file do so
      }
    }, 300);
  };
  const openHash = async () => {
    let code = window.location.hash.slice(1, PAGE.longestCode + 2);
    try {
      code = decodeURIComponent(code);
    } catch (error) {
      console.warn(error);
    }
    if (!/^\s*PMZ/.test(code)) return false;
    try {
      set(await openShareCode(code));
      return true;
    } catch (error) {
      if (!(error instanceof RangeError)) throw error;
      say(`This link was not opened: ${error.message}.`);
      if (doc) follow();
      return false;
    }
  };

  // --- inputs ---------------------------------------------------------------------------------
  const number = (value, digits) => {
    if (!Number.isFinite(value)) return value === Infinity ? "∞" : "–";
    const text = value.toFixed(digits);
    return text.replace("-", Number(text) ? "\u2212" : ""); // zero has no sign
  };
  const decimals = (step) => Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  const fields = [];
  const addSlider = (parent, entry, id, read, write, ends = () => [entry.low, entry.high]) => {
    const row = document.createElement("div");
    row.className = "field";
    row.title = entry.hint ?? "";
    const label = Object.assign(document.createElement("label"), { textContent: entry.label });
    label.htmlFor = id;
    const range = Object.assign(document.createElement("input"), { type: "range", id: `${id}.range` });
    range.setAttribute("aria-label", `${entry.label}, slider`);
    const box = Object.assign(document.createElement("input"), { type: "number", id, step: "any" });
    [range.min, range.max, range.step] = [entry.low, entry.high, entry.step];
    // As the program rounds a number that is read in another unit.
    const toSi = (text) => entry.factor === 1 ? Number(text)
      : Number((Number(text) / entry.factor).toFixed(entry.factor <= 1000 ? 12 : 24));
    range.addEventListener("input", () => {
      moving = true;
      write(toSi(range.value), id);
    });
    range.addEventListener("change", () => {
      moving = false;
      lastSource = "";
      request();
    });
    box.addEventListener("change", () => {
      if (box.value.trim() && Number.isFinite(Number(box.value))) write(toSi(box.value));
      else draw();
    });
    row.append(label, range, box);
    parent.append(row);
    fields.push(() => {
      const value = Number(((read() ?? 0) * entry.factor).toFixed(9));
      const [low, high] = ends();
      range.min = Math.min(low, value);
      range.max = Math.max(high, value);
      range.value = value;
      const text = String(Number(value.toFixed(Math.max(decimals(entry.step), 6))));
      if (document.activeElement !== box || !moving) box.value = text;
      row.classList.toggle("changed", Boolean(entry.path) && entry.path in doc.design);
    });
  };
  PAGE.pose.forEach((entry, index) => addSlider(
    find("pose"), entry, `pose.${index}`, () => doc.pose[index],
    (value, source) => move({ [index]: value }, source), () => poseRange(index, entry),
  ));
  for (const group of PAGE.groups) {
    const box = document.createElement("details");
    box.open = group.open;
    const title = Object.assign(document.createElement("summary"), { textContent: group.title });
    box.append(title);
    for (const entry of group.sliders)
      addSlider(box, entry, entry.path, () => valueOf(doc, entry.path)
        ?? valueOf(doc, "geometry.guide_link_length"),
      (value, source) => vary(entry.path, value, source));
    find("design").append(box);
  }
  find("knee").addEventListener("change", () => setKnee(find("knee").value));
  find("name").addEventListener("change", () => set({ ...doc, name: printable(find("name").value) }));

  // --- buttons --------------------------------------------------------------------------------
  const buttons = {};
  const addButton = (text, hint, run) => {
    const button = Object.assign(document.createElement("button"), {
      type: "button", textContent: text, title: hint,
    });
    button.addEventListener("click", run);
    find("buttons").append(button);
    buttons[text] = button;
  };
  const download = (name, content) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(content);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const stem = () => doc.name.replace(/[^\w.-]+/g, "-").replace(/^[-.]+|[-.]+$/g, "") || "design";
  addButton("Undo", "Undo the last change (Ctrl+Z)", () => undo(back, forward));
  addButton("Redo", "Do again what was undone last (Ctrl+Shift+Z, Ctrl+Y)", () => undo(forward, back));
  addButton("Pin", "Compare torques with this design", () => {
    const { name, design, load_frame: frame, drives } = doc;
    const pinned = { name, design, ...(frame && { load_frame: frame }), ...(drives && { drives }) };
    set({ ...doc, reference: doc.reference ? null : pinned });
  });
  addButton("Balance by m₇", "Set m₇ so that M_p2 = 0: no static torque of M1 to M3 (Eq. 8)", () =>
    vary("joints.j7", balancedMass()));
  addButton("Copy link", "The address of this file with the design; it opens in the file alone", async () => {
    const link = `${window.location.href.split("#")[0]}#${await shareCode(doc)}`;
    try {
      await navigator.clipboard.writeText(link);
      say("The link is on the clipboard.");
    } catch {
      say(link);
    }
  });
  addButton("Copy code", "The share code: it opens behind the # of any page of paminsa-viz", async () => {
    const code = await shareCode(doc);
    try {
      await navigator.clipboard.writeText(code);
      say("The share code is on the clipboard.");
    } catch {
      say(code);
    }
  });
  addButton("Design as TOML", "A design file for paminsa-viz", () => {
    download(`${stem()}.toml`, new Blob([designFile()], { type: "text/plain" }));
    say(doc.requirements ? "The file is without the requirements, which a link or code keeps." : "");
  });
  addButton("Maps as PNG", "The three maps as a picture", () =>
    mapsPicture().toBlob((content) => download(`${stem()}-maps.png`, content)));
  addButton("Light / dark", "Change the colors of the page", () => {
    document.documentElement.classList.toggle("dark");
    request();
  });
  let typed = null; // the field with letters that are not taken yet, which the browser undoes
  document.addEventListener("input", ({ target }) => {
    typed = target.matches("[type=text], [type=number]") ? target : null;
  });
  for (const end of ["change", "focusout"])
    document.addEventListener(end, () => {
      typed = null;
    });
  document.addEventListener("keydown", (event) => {
    const key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || !/^[zy]$/.test(key) || typed === event.target) return;
    event.preventDefault();
    if (event.shiftKey || key === "y") undo(forward, back);
    else undo(back, forward);
  });
  if (window.matchMedia("(prefers-color-scheme: dark)").matches)
    document.documentElement.classList.add("dark");

  /** M_p2 is linear in m_7: -g/k for a kilogram. */
  const balancedMass = () => {
    const slope = -robot.g / robot.mechanism.k;
    return valueOf(doc, "joints.j7") - robot.imbalance / slope;
  };
  const toml = (value) => Array.isArray(value) ? `[${value.map(toml).join(", ")}]`
    : typeof value !== "number" ? JSON.stringify(value)
      : Number.isInteger(value) ? value.toFixed(1) : String(value);
  const designFile = () => {
    const tables = new Map([["", []]]);
    const rows = (table) => tables.get(table) ?? tables.set(table, []).get(table);
    for (const [path, value] of Object.entries(doc.design)) {
      const { table, key } = PAGE.parameters[path];
      rows(table).push(`${key} = ${toml(value)}`);
    }
    if (doc.knee === "upper") rows("geometry").push('knee = "upper"');
    if (doc.load_frame === "platform") rows("load").push('frame = "platform"');
    doc.drives?.forEach((drive, index) => drive && rows(PAGE.driveTables[index]).push(
      ...Object.entries(drive).map(([name, value]) => `${PAGE.driveKeys[name]} = ${toml(value)}`)));
    const head = [
      `# Written by ${PAGE.madeBy}, the page in one file. Without a value it is Appendix 4's.`,
      `name = ${toml(doc.name)}`, `schema_version = ${PAGE.schemaVersion}`,
      ...tables.get(""),
    ];
    tables.delete("");
    const parts = [...tables].map(([table, lines]) => [`\n[${table}]`, ...lines].join("\n"));
    return `${[head.join("\n"), ...parts].join("\n")}\n`;
  };

  // --- maps and the view ----------------------------------------------------------------------
  const canvases = [];
  const titles = [];
  let solvedMaps = null; // maps, and the number of their cells
  // No singular circle is larger than the radii together.
  const extent = () => {
    const m = robot.mechanism;
    return Math.min(paminsaWorkspaceCircle(m), m.base_radius + m.platform_radius) || 0.1;
  };
  const differs = () => Boolean(doc.reference) && find("kind").value === "difference";
  /** Return the maps that are chosen, n cells along each side. */
  const chosenMaps = (n) => {
    const [, , theta, z] = doc.pose;
    const maps = solveMaps(robot, theta, z, extent(), n);
    if (!differs()) return maps;
    const other = solveMaps(robotOf(doc.reference, doc.knee), theta, z, extent(), n);
    return maps.map((map, index) => map.map((value, cell) => value - other[index][cell]));
  };
  const singularRadius = () => {
    const m = robot.mechanism;
    return Math.sqrt(Math.max(0, m.base_radius ** 2 + m.platform_radius ** 2
      - 2 * m.base_radius * m.platform_radius * Math.cos(doc.pose[2])));
  };
  /** Return the maps for a file: light, of one size, with what they are of. */
  const mapsPicture = () => {
    const [side, gap, line] = [480, 16, 24];
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [3 * side + 4 * gap, side + 4 * line];
    const draw = canvas.getContext("2d");
    const wasDark = isDark();
    document.documentElement.classList.remove("dark"); // not seen: nothing is drawn in between
    draw.fillStyle = colorOf("paper");
    draw.fillRect(0, 0, canvas.width, canvas.height);
    const write = (text, left, row) => {
      draw.fillStyle = colorOf("ink");
      draw.font = "16px system-ui, sans-serif";
      draw.fillText(text, left, row, canvas.width - left - gap);
    };
    solvedMaps.pictures.forEach((picture, index) => {
      const left = gap + index * (side + gap);
      write(titles[index].textContent, left, line - 6);
      draw.setTransform(1, 0, 0, 1, left, line);
      drawMap(draw, side, picture, doc.pose, extent(), singularRadius());
      draw.setTransform(1, 0, 0, 1, 0, 0);
    });
    const [x, y, theta, z] = doc.pose;
    const less = differs() ? `, less those of “${doc.reference.name}”` : "";
    write(`Static torques of “${doc.name}”${less}; ${doc.knee} knee, θ = ${number(180 / Math.PI * theta, 2)}°, `
      + `z = ${number(1e3 * z, 1)} mm. Circle: pose x = ${number(1e3 * x, 1)} mm, y = ${number(1e3 * y, 1)} mm.`,
    gap, side + 2 * line);
    write(`x and y from −${number(1e3 * extent(), 0)} to ${number(1e3 * extent(), 0)} mm. Blue: negative, `
      + `red: positive. Gray: out of reach. Dashed: singular. ${PAGE.madeBy}.`, gap, side + 3 * line);
    document.documentElement.classList.toggle("dark", wasDark);
    return canvas;
  };
  const placeIn = (canvas, event) => {
    const box = canvas.getBoundingClientRect();
    return [
      extent() * (2 * (event.clientX - box.left) / box.width - 1),
      extent() * (1 - 2 * (event.clientY - box.top) / box.height),
    ];
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
      lastSource = "";
      go(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) go(event);
      const [x, y] = placeIn(canvas, event);
      const found = solvePose(robot, [x, y, doc.pose[2], doc.pose[3]]);
      const other = differs()
        ? solvePose(robotOf(doc.reference, doc.knee), [x, y, doc.pose[2], doc.pose[3]]).torques[index] : 0;
      const value = found.ok ? `${number(found.torques[index] - other, 3)} N·m` : "out of reach";
      find("hover").textContent =
        `x ${number(1e3 * x, 1)} mm, y ${number(1e3 * y, 1)} mm: ${differs() ? "Δ" : ""}τ${"₁₂₃"[index]} ${value}`;
    });
  });
  const view = createView(find("robot"), {
    shown: () => shown,
    request: () => request(),
    move: (changes) => {
      moving = true;
      move(changes, "handle");
    },
    release: () => {
      moving = false;
      lastSource = "";
    },
  });
  for (const name of Object.keys(PRESETS)) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: name });
    button.addEventListener("click", () => view.look(name));
    find("views").prepend(button);
  }
  find("views").prepend(...[...find("views").querySelectorAll("button")].reverse());
  for (const id of ["floor", "kind"]) find(id).addEventListener("change", () => request());
  for (const id of ["robot", "views"]) find(id).hidden = view.isMissing;
  find("flat").hidden = !view.isMissing;

  // --- numbers --------------------------------------------------------------------------------
  const fill = (id, rows, head) => {
    const line = (cells, name) => `<tr>${cells.map((cell) => `<${name}>${cell}</${name}>`).join("")}</tr>`;
    if (head) find(id).tHead.innerHTML = line(head, "th");
    find(id).tBodies[0].innerHTML = rows.map((cells) => line(cells, "td")).join("");
  };
  const drawNumbers = (solved) => {
    const degrees = 180 / Math.PI;
    const pinned = doc.reference && solvePose(robotOf(doc.reference, doc.knee), doc.pose);
    fill("actuators", solved.torques.map((torque, index) => {
      const [digits, unit] = index < 3 ? [3, "N·m"] : [2, "N"];
      const position = index < 3 ? `${number(degrees * solved.actuators[index], 2)}°`
        : `${number(1e3 * solved.actuators[3], 1)} mm`;
      const other = pinned
        ? [number(pinned.torques[index], digits), number(torque - pinned.torques[index], digits)] : [];
      const swatch = `<span class="swatch" style="background: var(--m${index + 1})"></span>`;
      return [`${swatch}M${index + 1}`, position, `${number(torque, digits)} ${unit}`, ...other];
    }), ["", "position", "static torque", ...(pinned ? ["pinned", "difference"] : [])]);
    const { mechanism } = robot;
    const [x, y, theta, z] = doc.pose;
    const margins = [0, 1, 2].map((leg) => Object.values(paminsaLegMargins(mechanism, AXIS_X[leg],
      AXIS_Y[leg], x, y, Math.cos(theta), Math.sin(theta), z)));
    fill("margins", PAGE.limits.map((label, limit) => [label, ...margins.map((leg, index) => {
      const text = number(1e3 * leg[limit], 1);
      return index + 1 === solved.leg && limit === solved.limit ? `<b>${text}</b>` : text;
    })]), ["", "leg 1", "leg 2", "leg 3"]);
    const mass = balancedMass();
    fill("quality", [
      ["M<sub>p2</sub>, static imbalance (Eq. 8)", `${number(robot.imbalance, 4)} N`],
      ["balanced by m₇ =", mass >= 0 ? `${number(mass, 3)} kg` : "none"],
      ["least margin", `${number(1e3 * solved.margin, 1)} mm, leg ${solved.leg}, ${PAGE.limits[solved.limit]}`],
      ["condition number", number(solved.condition, 3)],
      ["to the singular circle", `${number(1e3 * solved.position, 1)} mm`],
      ["to a singular rotation", Number.isFinite(solved.rotation)
        ? `${number(degrees * solved.rotation, 2)}°` : "none"],
    ]);
    const near = !(solved.condition < NEAR);
    const beyond = solved.position < 0 || solved.rotation < 0;
    find("status").className = !solved.ok ? "bad" : near || beyond ? "warn" : "ok";
    find("status").textContent = !solved.ok
      ? `Out of reach: leg ${solved.leg}, ${PAGE.limits[solved.limit]}, by ${number(-1e3 * solved.margin, 1)} mm`
      : beyond ? "Beyond a singularity" : near ? "Near a singularity" : "Reachable";
  };

  const playback = createPlayback({
    current: () => ({ robot, doc }), request: () => request(), fill, number,
    move: (changes) => {
      moving = true;
      move(changes, "motion");
    },
    release: () => {
      moving = false;
      lastSource = "";
    },
  });

  let waiting = 0;
  const request = () => {
    waiting ||= requestAnimationFrame(() => {
      waiting = 0;
      draw();
    });
  };
  let key = "";
  const draw = () => {
    const solved = solvePose(robot, doc.pose);
    if (solved.ok) shown = { robot, pose: doc.pose, solved };
    fields.forEach((run) => run());
    find("knee").value = doc.knee;
    if (document.activeElement !== find("name")) find("name").value = doc.name;
    document.title = `${doc.name} - PAMINSA explorer in one file`;
    buttons.Undo.disabled = !back.length;
    buttons.Redo.disabled = !forward.length;
    find("kind").disabled = !doc.reference;
    buttons.Pin.textContent = doc.reference ? "Unpin" : "Pin";
    buttons["Balance by m₇"].disabled = !(balancedMass() >= 0);
    drawNumbers(solved);
    playback.draw();
    const n = moving && spent > SLOW ? WHILE_MOVED : CELLS;
    const wanted = JSON.stringify([doc.design, doc.load_frame, doc.knee, doc.pose[2], doc.pose[3], n,
      differs() && doc.reference]);
    if (wanted !== key) {
      const start = performance.now();
      solvedMaps = { values: chosenMaps(n), n };
      spent = performance.now() - start;
      solvedMaps.limit = colorLimit(solvedMaps.values);
      solvedMaps.pictures = solvedMaps.values.map((each) => pictureOf(each, n, solvedMaps.limit));
      key = wanted;
    }
    const { pictures, limit } = solvedMaps;
    const singular = singularRadius();
    canvases.forEach((canvas, index) => {
      titles[index].textContent =
        `${differs() ? "Δ" : ""}τ${"₁₂₃"[index]}: ±${number(limit, 1)} N·m`;
      canvas.setAttribute("aria-label", `Map of the static torque of M${index + 1}; `
        + `${number(solved.torques[index], 3)} N·m at the pose`);
    });
    // All texts are written by now: each size that is read after a text has the page laid out again.
    canvases.forEach((canvas, index) => {
      const { context, width } = contextOf(canvas);
      drawMap(context, width, pictures[index], doc.pose, extent(), singular);
    });
    const chosen = find("floor").value;
    if (shown)
      view.draw({
        floor: chosen && { picture: pictures[chosen], radius: extent() },
        circle: paminsaWorkspaceCircle(robot.mechanism), singular, dark: isDark(), colors: pageColors(), moving,
      });
    const [x, y, theta, z] = (shown?.pose ?? doc.pose);
    find("robot").setAttribute("aria-label", `The robot at x ${number(1e3 * x, 1)} mm, `
      + `y ${number(1e3 * y, 1)} mm, θ ${number(180 / Math.PI * theta, 1)}°, z ${number(1e3 * z, 1)} mm. `
      + "Arrow keys turn the view, + and - zoom, Home shows all; the sliders move the platform.");
    document.documentElement.dataset.drawn = Number(document.documentElement.dataset.drawn ?? 0) + 1;
  };

  const isDark = () => document.documentElement.classList.contains("dark");
  const pageColors = () => Object.fromEntries(["m1", "m2", "m3", "m4", "ink", "good", "bad"].map((name) =>
    [name, colorOf(name).match(/\w\w/g).map((part) => parseInt(part, 16) / 255)]));

  find("about").textContent = `Written by ${PAGE.madeBy}. All numbers are computed here by the same `
    + `formulas. Only in the served page (pip install, then paminsa-viz): ${PAGE.onlyServed}.`;
  new ResizeObserver(() => doc && request()).observe(find("pictures"));
  window.addEventListener("hashchange", () => window.location.hash !== address && openHash());
  const begin = async () => {
    const linked = await openHash();
    const refusal = find("message").textContent;
    if (!linked) set(checkedDocument(PAGE.document));
    if (refusal) say(refusal);
  };
  begin();
  window.paminsaPage = { robotOf, solvePose, solveMaps, view, openShareCode, shareCode, designFile };
})();
