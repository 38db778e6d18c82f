/** Inputs, buttons and undo of the page in one file. A step is a whole document; links hold one. */
(() => {
  let doc = null;
  let robot = null;
  let shown = null; // the last pose that can be taken, with what was solved there
  const back = [];
  const forward = [];
  let moving = false;
  let onPaper = false;

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
    const { low, high } = paminsaPlatformRange(robot.drawn);
    const toMm = 1e3 * robot.scale;
    const least = Math.ceil(toMm * low / grain) * grain;
    return [least, Math.max(Math.floor(toMm * high / grain) * grain, least + grain)];
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
  const fields = [];
  const addSlider = (parent, entry, id, read, write, ends = () => [entry.low, entry.high]) => {
    const row = document.createElement("div");
    row.className = "field";
    row.title = entry.hint ?? "";
    const label = Object.assign(document.createElement("label"), { innerHTML: entry.markup });
    label.htmlFor = id;
    const range = Object.assign(document.createElement("input"), { type: "range", id: `${id}.range` });
    range.setAttribute("aria-label", `${entry.label}, slider`);
    // No number field: Chromium reads 33,5 typed into one as 335, and Firefox takes its text away.
    const box = Object.assign(document.createElement("input"), { type: "text", id });
    [range.min, range.max, range.step] = [entry.low, entry.high, entry.step];
    // As the program rounds a number that is read in another unit.
    const toSi = (value) => entry.factor === 1 ? value
      : Number((value / entry.factor).toFixed(entry.factor <= 1000 ? 12 : 24));
    range.addEventListener("input", () => {
      moving = true;
      write(toSi(Number(range.value)), id);
    });
    range.addEventListener("change", () => {
      moving = false;
      lastSource = "";
      request();
    });
    let written = ""; // into the box by the page
    const takeTyped = () => {
      if (box.value === written) return;
      const { value, problem: wrong } = readNumber(box.value);
      if (value !== undefined) write(toSi(value));
      else if (box.value.trim()) say(`${wrong}; nothing was changed`);
      request();
    };
    // Firefox tells of no change where the same text is typed again over what was written meanwhile.
    for (const kind of ["change", "blur"]) box.addEventListener(kind, takeTyped);
    box.addEventListener("keydown", (event) => {
      if (event.key === "Enter") takeTyped();
      const steps = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      const { value } = readNumber(box.value);
      if (!steps || value === undefined) return;
      event.preventDefault();
      write(toSi(Number((value + steps * entry.step).toFixed(decimals(entry.step) + 6))));
      request();
    });
    row.append(label, range, box);
    parent.append(row);
    fields.push(() => {
      const shown = (read() ?? 0) * entry.factor;
      const value = entry.factor === 1 ? shown : Number(shown.toFixed(9));
      const [low, high] = ends();
      range.min = Math.min(low, value);
      range.max = Math.max(high, value);
      range.value = value;
      const text = String(Number(value.toFixed(Math.max(decimals(entry.step), 6))));
      if (document.activeElement !== box || !moving) box.value = written = text;
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
    vary("joints.j7", balancedMass(robot, doc)));
  // Safari takes a text only while it handles the press, and a code is packed later: so the promise
  // of the text is given. A text that is not taken is shown, to be copied by hand.
  const copy = async (what, text) => {
    const packed = text.then((plain) => new Blob([plain], { type: "text/plain" }));
    try {
      if (window.ClipboardItem)
        await navigator.clipboard.write([new ClipboardItem({ "text/plain": packed })]);
      else await navigator.clipboard.writeText(await text);
      say(`${what} is on the clipboard.`);
    } catch {
      say(await text);
    }
  };
  addButton("Copy link", "The address of this file with the design; it opens in the file alone", () =>
    copy("The link", shareCode(doc).then((code) => `${window.location.href.split("#")[0]}#${code}`)));
  addButton("Copy code", "The share code: it opens behind the # of any page of paminsa-viz", () =>
    copy("The share code", shareCode(doc)));
  addButton("Design as TOML", "A design file for paminsa-viz", () => {
    download(`${stem()}.toml`, new Blob([designFile(doc)], { type: "text/plain" }));
    say(doc.requirements ? "The file is without the requirements, which a link or code keeps." : "");
  });
  addButton("Maps as PNG", "The three maps as a picture", () =>
    maps.forFile().toBlob((content) => download(`${stem()}-maps.png`, content)));
  addButton("Light / dark", "Change the colors of the page", () => {
    document.documentElement.classList.toggle("dark");
    request();
  });
  let typed = null; // the field with letters that are not taken yet, which the browser undoes
  document.addEventListener("input", ({ target }) => {
    typed = target.matches("[type=text]") ? target : null;
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

  // --- maps, the view and the motion ----------------------------------------------------------
  const current = () => ({ robot, doc });
  const maps = createMaps({
    current, move,
    begin: () => {
      lastSource = "";
    },
  });
  /** What moves the platform for a while, under a name, and what ends that. */
  const mover = (source) => ({
    request: () => request(),
    move: (changes) => {
      moving = true;
      move(changes, source);
    },
    release: () => {
      moving = false;
      lastSource = "";
    },
  });
  const view = createView(find("robot"), { shown: () => shown, ...mover("handle") });
  find("views").prepend(...Object.keys(PRESETS).map((name) => {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: name });
    button.addEventListener("click", () => view.look(name));
    return button;
  }));
  for (const id of ["floor", "kind"]) find(id).addEventListener("change", () => request());
  for (const id of ["robot", "views"]) find(id).hidden = view.isMissing;
  find("flat").hidden = !view.isMissing;

  const playback = createPlayback({ current, say, ...mover("motion") });

  let waiting = 0;
  const request = () => {
    waiting ||= requestAnimationFrame(() => {
      waiting = 0;
      draw();
    });
  };
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
    buttons["Balance by m₇"].disabled = !(balancedMass(robot, doc) >= 0);
    writeNumbers(robot, doc, solved);
    playback.draw(onPaper);
    const { pictures, radius, singular } = maps.draw(solved.torques, moving, onPaper);
    const chosen = find("floor").value;
    if (shown)
      view.draw({
        floor: chosen && { picture: pictures[chosen], radius },
        circle: paminsaWorkspaceCircle(robot.mechanism), singular, dark: isDark(), colors: pageColors(), moving,
      });
    const [x, y, theta, z] = (shown?.pose ?? doc.pose);
    find("robot").setAttribute("aria-label", `The robot at x ${millimeters(robot, x)} mm, `
      + `y ${millimeters(robot, y)} mm, θ ${number(DEGREES * theta, 1)}°, z ${millimeters(robot, z)} mm. `
      + "Arrow keys turn the view, + and - zoom, Home shows all; the sliders move the platform.");
    document.documentElement.dataset.drawn = Number(document.documentElement.dataset.drawn ?? 0) + 1;
  };

  const pageColors = () => Object.fromEntries(["m1", "m2", "m3", "m4", "ink", "good", "bad"].map((name) =>
    [name, colorOf(name).match(/\w\w/g).map((part) => parseInt(part, 16) / 255)]));

  find("about").textContent = `Written by ${PAGE.madeBy}. All numbers are computed here by the same `
    + `formulas. Only in the served page (pip install, then paminsa-viz): ${PAGE.onlyServed}.`;
  new ResizeObserver(() => doc && request()).observe(find("pictures"));
  // Paper is light. Firefox prints of the robot what was drawn in the same task, else nothing.
  let wasDark = false;
  const setPaper = (paper) => {
    if (paper && !onPaper) wasDark = isDark();
    onPaper = paper;
    document.documentElement.classList.toggle("dark", wasDark && !paper);
    if (doc) draw();
  };
  window.addEventListener("beforeprint", () => setPaper(true));
  window.addEventListener("afterprint", () => setPaper(false));
  window.addEventListener("hashchange", () => window.location.hash !== address && openHash());
  const begin = async () => {
    const linked = await openHash();
    const refusal = find("message").textContent;
    if (!linked) set(checkedDocument(PAGE.document));
    if (refusal) say(refusal);
  };
  begin();
  window.paminsaPage = { robotOf, solvePose, solveMaps, view, openShareCode, shareCode };
})();
