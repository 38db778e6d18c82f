/** The motion's controls, its chart and its torques by cause, in the page in one file. */
const SAMPLES = 121;
const [SHORTEST, LONGEST] = [0.05, 60]; // durations that can be asked for [s]
const CURVES = { all: "τ₁, τ₂, τ₃", 3: "F₄ by cause", 0: "τ₁ by cause", 1: "τ₂ by cause", 2: "τ₃ by cause" };
const CAUSE_COLORS = { gravity: "m1", inertial: "m2", velocity: "m3", friction: "m4", load: "muted", total: "ink" };

/** Draw curves over time: [name, color, values] each; `now` is an instant, `paper` what it is for. */
const drawCurves = (canvas, curves, times, now, unit, paper) => {
  const { context: draw, width, height } = paper ? contextOf(canvas, PAPER, PAPER / 4, 3) : contextOf(canvas);
  const all = curves.flatMap(([, , values]) => values).filter(Number.isFinite);
  const [low, high] = [Math.min(0, ...all), Math.max(0, ...all)];
  const room = (high - low || 1) * 0.06;
  const duration = times[times.length - 1];
  const [left, top, right, bottom] = [44, 20, width - 6, height - 18];
  const across = (time) => left + (right - left) * time / duration;
  const up = (value) => bottom - (bottom - top) * (value - low + room) / (high - low + 2 * room);
  draw.font = "11px system-ui, sans-serif";
  draw.lineWidth = 1;
  draw.fillStyle = colorOf("muted");
  for (const tick of multiples(low, high, roundFrom((high - low || 1) / 5, [1, 2, 5]))) {
    draw.strokeStyle = colorOf(tick ? "faint" : "muted");
    draw.beginPath();
    draw.moveTo(left, up(tick));
    draw.lineTo(right, up(tick));
    draw.stroke();
    letter(draw, roundText(tick), left - 4, up(tick) + 4, "right");
  }
  for (const tick of multiples(0, 0.85 * duration, roundFrom(duration / 6, [1, 2, 2.5, 5]))) {
    draw.fillRect(across(tick) - 0.5, bottom, 1, 3);
    letter(draw, roundText(tick), across(tick), height - 4, "center");
  }
  letter(draw, "t [s]", right, height - 4, "right");
  letter(draw, `[${unit}]`, left - 4, 12, "right");
  draw.textAlign = "left";
  let place = left;
  for (const [name, color, values] of curves) {
    draw.strokeStyle = draw.fillStyle = colorOf(color);
    draw.lineWidth = color === "ink" ? 2 : 1.5;
    draw.beginPath();
    let on = false;
    values.forEach((value, index) => {
      if (Number.isFinite(value)) draw[on ? "lineTo" : "moveTo"](across(times[index]), up(value));
      on = Number.isFinite(value);
    });
    draw.stroke();
    draw.fillText(name, place, 12);
    place += draw.measureText(name).width + 8;
  }
  draw.strokeStyle = colorOf("ink");
  draw.lineWidth = 1;
  draw.beginPath();
  draw.moveTo(across(now), top);
  draw.lineTo(across(now), bottom);
  draw.stroke();
};

/**
 * Make the motion's controls. `current` gives the robot and its document, `move` puts the platform
 * somewhere, `release` ends a change, `say` shows a line.
 */
const createPlayback = ({ current, request, move, release, say }) => {
  const option = (value, text) => Object.assign(document.createElement("option"), { value, textContent: text });
  find("preset").append(option("", "none"), ...PAGE.motions.presets.map(({ key, label }) => option(key, label)));
  find("law").append(...Object.keys(PAGE.motions.laws).map((name) => option(name, name)));
  find("curves").append(...Object.entries(CURVES).map(([key, text]) => option(key, text)));
  find("curves").value = "all";
  const SHOWN = ["law", "duration", "time", "play", "curves", "chart", "moment", "causes"];
  let motion = null; // with what was worked out of it
  let key = "";
  let started = 0; // when the play began, less the motion's time [ms]; 0 at rest
  let time = 0;
  let asked = ""; // the duration that was typed [s], empty for the preset's

  /** Take the duration that is typed; one that is not possible is named and goes back. */
  const takeDuration = () => {
    const field = find("duration");
    const text = field.value.trim();
    const { value } = readNumber(text);
    const isPossible = !text || (value >= SHORTEST && value <= LONGEST);
    if (isPossible) asked = text && String(value);
    field.value = asked;
    say(isPossible ? "" : `Duration: ${SHORTEST} to ${LONGEST} s is possible; nothing was changed`);
    return isPossible;
  };
  const prepare = () => {
    const { robot, doc } = current();
    const preset = PAGE.motions.presets.find((each) => each.key === find("preset").value);
    const wanted = JSON.stringify([doc.design, doc.load_frame, doc.knee, preset?.key,
      find("law").value, asked]);
    if (wanted === key) return;
    key = wanted;
    motion = null;
    for (const id of SHOWN) find(id).disabled = !preset;
    for (const id of ["chart", "moment", "causes"]) find(id).hidden = !preset;
    if (!preset) return;
    motion = motionOf(robot, preset, find("law").value || preset.law, Number(asked));
    find("duration").placeholder = String(Number(motion.duration.toPrecision(4)));
    motion.times = Array.from({ length: SAMPLES }, (_, index) => motion.duration * index / (SAMPLES - 1));
    motion.states = motion.times.map(motion.at);
    motion.parts = motion.states.map((state) => torqueParts(robot, state));
    motion.blocked = motion.states.findIndex(({ pose }) => !solvePose(robot, pose).ok);
    time = Math.min(time, motion.duration);
  };
  const goTo = (instant) => {
    time = Math.max(0, Math.min(motion.duration, instant));
    const { pose } = motion.at(time);
    move(Object.fromEntries(pose.map((value, axis) => [axis, Number(value.toFixed(9))])));
    request();
  };
  const stop = () => {
    started = 0;
    find("play").textContent = "Play";
    release();
    request();
  };
  const tick = () => {
    if (!started) return;
    prepare();
    if (!motion) {
      stop();
      return;
    }
    goTo((performance.now() - started) / 1000);
    if (time >= motion.duration) stop();
    else requestAnimationFrame(tick);
  };
  find("play").addEventListener("click", () => {
    if (started) {
      stop();
      return;
    }
    prepare();
    if (!motion) return;
    if (time >= motion.duration) time = 0;
    started = performance.now() - 1000 * time;
    find("play").textContent = "Pause";
    requestAnimationFrame(tick);
  });
  for (const id of ["preset", "law", "duration", "curves"])
    find(id).addEventListener("change", () => {
      if (id === "duration" && !takeDuration()) return;
      if (id !== "curves") time = 0;
      if (id === "preset") find("duration").value = asked = "";
      prepare();
      if (motion && id !== "curves") goTo(0);
      release();
      request();
    });
  find("time").addEventListener("input", () => {
    started = 0;
    find("play").textContent = "Play";
    goTo(motion.duration * Number(find("time").value));
  });
  find("time").addEventListener("change", () => {
    release();
    request();
  });

  const draw = (paper) => {
    prepare();
    if (!motion) return;
    if (document.activeElement !== find("time") || started) find("time").value = time / motion.duration;
    const { robot, doc } = current();
    const chosen = find("curves").value;
    const curves = chosen === "all"
      ? [0, 1, 2].map((index) => [`τ${"₁₂₃"[index]}`, `m${index + 1}`, motion.parts.map((each) => each.total[index])])
      : [...CAUSES, "total"].map((cause) =>
        [cause, CAUSE_COLORS[cause], motion.parts.map((each) => each[cause][Number(chosen)])])
        .filter(([cause, , values]) => cause === "total" || values.some((value) => value !== 0));
    drawCurves(find("chart"), curves, motion.times, time, chosen === "3" ? "N" : "N·m", paper);
    const largest = [0, 1, 2].map((index) =>
      Math.max(...motion.parts.map((each) => Math.abs(each.total[index])).filter(Number.isFinite)));
    find("chart").setAttribute("aria-label",
      `${CURVES[chosen]} over ${number(motion.duration, 2)} s; largest |τ| of M1 to M3: `
      + `${largest.map((value) => number(value, 2 + robot.spare.torque)).join(", ")} N·m`);
    const notes = [`t = ${number(time, 2)} s; largest |τ₁|, |τ₂|, |τ₃|: ${largest.map((value) => number(value, 2 + robot.spare.torque)).join(", ")} N·m.`];
    if (motion.blocked >= 0) notes.push(`Out of reach at ${number(motion.times[motion.blocked], 2)} s.`);
    if (doc.drives) notes.push("Friction and inertia of the design’s drives are not counted here.");
    find("moment").textContent = notes.join(" ");
    const parts = torqueParts(robot, motion.at(time));
    fill("causes", [...CAUSES, "total"].map((cause) =>
      [cause, ...parts[cause].map((value, index) => number(value, index < 3 ? 3 + robot.spare.torque : 1 + robot.spare.force))]), ["", "M1", "M2", "M3", "M4"]);
  };
  return { draw };
};
