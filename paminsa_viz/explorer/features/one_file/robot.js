/**
 * The robot of the page in one file: a document in, numbers out. All mechanics is in the formulas
 * before it, which are printed from the program's source; here they are only put together.
 *
 * SI units; a pose is (x, y, theta, z), a document is the text of a share code.
 */
const refuse = (text) => {
  throw new RangeError(text);
};

/** Return a number of a document; `null` where it is left open. */
const valueOf = (doc, path) => doc.design[path] ?? PAGE.parameters[path]?.value ?? null;

/** Return a name without what design files refuse in one, as the program reads it from a link. */
const printable = (name) => name.replace(/(?! )[\p{C}\p{Z}]/gu, "?").slice(0, 200);

/** Whether drives are as a document has them: one for each actuator, or null. */
const areDrives = (drives) => Array.isArray(drives) && drives.length === PAGE.driveTables.length
  && drives.every((drive) => drive === null
    || (typeof drive === "object" && Object.keys(drive).every((name) => Object.hasOwn(PAGE.driveKeys, name))));

/** Check a design's numbers as the program does; return what is wrong, or an empty text. */
const problem = (doc) => {
  for (const [path, value] of Object.entries(doc.design)) {
    const known = PAGE.parameters[path];
    if (!known) return `${path.slice(0, 40)} is no number of a design`;
    if (!Number.isFinite(value)) return `${path} is no number`;
    const low = known.signed ? -known.most : known.positive ? known.least : 0;
    if (value < low || value > known.most) return `${path} = ${value} is not possible`;
  }
  const [k, base, platform, crank, coupler] = [
    "magnification", "base_radius", "platform_radius", "crank_length", "coupler_length",
  ].map((name) => valueOf(doc, `geometry.${name}`));
  if (k <= 1) return "k has to be greater than 1";
  if (k / (k - 1) * Math.abs(base - platform) >= crank + coupler)
    return "B4 and B8 cannot close the pantograph with the platform at the center";
  return "";
};

/** Return what is wrong with a pose, or an empty text; it need not be in reach. */
const poseProblem = (pose) => {
  const isPossible = (value) => Number.isFinite(value) && Math.abs(value) <= PAGE.farthest;
  const at = pose.findIndex((value) => !isPossible(value));
  return at < 0 ? "" : `${["x", "y", "theta", "z"][at]} of its pose: up to ${PAGE.farthest} m or `
    + `rad in size is possible, not ${String(pose[at]).slice(0, 20)}`;
};

/** Return a document after every check; raise a RangeError with one line. */
const checkedDocument = (text) => {
  let doc;
  try {
    doc = JSON.parse(text);
  } catch {
    refuse("it cannot be read");
  }
  if (doc === null || typeof doc !== "object") refuse("it cannot be read");
  if (doc.version !== PAGE.version)
    refuse(`version ${String(doc.version).slice(0, 20)} is not known`);
  const pose = doc.pose;
  if (!Array.isArray(pose) || pose.length !== 4) refuse("it has no pose");
  if (poseProblem(pose)) refuse(poseProblem(pose));
  const word = doc.knee ?? doc.assembly;
  if (!Object.hasOwn(PAGE.knees, word)) refuse("it cannot be read");
  const knee = PAGE.knees[word];
  const { assembly: _, ...rest } = doc;
  for (const each of [doc, doc.reference ?? doc]) {
    if (typeof each !== "object" || typeof each.design !== "object" || each.design === null)
      refuse("it cannot be read");
    if (!["world", "platform"].includes(each.load_frame ?? "world")) refuse("it cannot be read");
    if (each.drives !== undefined && !areDrives(each.drives)) refuse("it cannot be read");
    const found = problem(each);
    if (found) refuse(found);
    if (each.counterweights?.length)
      refuse("this file knows no counterweights; open the link where paminsa-viz runs");
  }
  return { ...rest, name: printable(String(doc.name ?? "")), knee };
};

/** Return what the formulas need of a design. */
const robotOf = (doc, knee = doc.knee) => {
  const of = (path) => valueOf(doc, path);
  const length = (name) => of(`geometry.${name}`);
  const k = length("magnification");
  const guide = length("guide_link_length");
  const mechanism = paminsaMechanismOfLengths(
    k, length("base_radius"), length("platform_radius"), length("platform_joint_height"),
    length("shaft_length"), length("crank_length"), length("coupler_length"),
    length("guide_stroke") ?? guide, length("axis_clearance"), knee === "lower" ? 1 : -1,
  );
  const masses = {};
  for (const [symbol, path] of Object.entries(PAGE.masses)) masses[symbol] = of(path);
  const g = of("gravity");
  const c = paminsaCoefficientsOfMasses(masses, k, guide, g, 2);
  const weightless = paminsaCoefficientsOfMasses(masses, k, guide, 0, 2);
  const terms = (coefficients) => Object.fromEntries(Object.entries(PAGE.motions.terms).map(
    ([name, row]) => [name, row.reduce((sum, part, index) => sum + part * coefficients[index], 0)]));
  const load = PAGE.load.map(of);
  return {
    mechanism, g, guide, arm: length("arm_length"), payload: of("payload.mass"), imbalance: c[1], load,
    turns: doc.load_frame === "platform" ? 1 : 0, loaded: load.slice(0, 6).some(Boolean),
    lift: k * (c[16] * g + 3 * c[0]) + 3 * c[2],
    terms: terms(c), weightless: terms(weightless), slow: of("friction.transition_speed"),
    friction: ["rotary", "linear"].map((kind) =>
      [of(`friction.viscous_${kind}`), of(`friction.coulomb_${kind}`)]),
  };
};

/** Return the torques of M1..M4 against the load on the platform. */
const loadTorques = (robot, x, y, c, s, z) => {
  if (!robot.loaded) return [0, 0, 0, 0];
  const m = robot.mechanism;
  const w = paminsaWrenchAtCenter(...robot.load, robot.turns, c, s);
  const j = paminsaWrenchTorques(m, x, y, c, s, z);
  const against = [0, 1, 2].map((leg) =>
    -(j[leg] * w[0] + j[3 + leg] * w[1] + j[6 + leg] * w[5]));
  return [...against, -m.k * w[2]];
};

/** Return Gamma times M_p2, the weight of the lift and the load: the static torques of M1..M4. */
const staticTorques = (robot, unit, x, y, c, s, z) => {
  const { imbalance } = robot;
  const torques = [unit[0] * imbalance, unit[1] * imbalance, unit[2] * imbalance,
    unit[3] * imbalance + robot.lift];
  if (!robot.loaded) return torques;
  const against = loadTorques(robot, x, y, c, s, z);
  return torques.map((torque, index) => torque + against[index]);
};

/** Return all that is shown of a pose; cosine and sine may be given, as libraries round them. */
const solvePose = (robot, pose, c = Math.cos(pose[2]), s = Math.sin(pose[2])) => {
  const m = robot.mechanism;
  const [x, y, theta, z] = pose;
  const least = paminsaLeastMargin(m, x, y, c, s, z);
  const limit = least.which % 4;
  // A guide may be used to its end; at the other limits the mechanism is singular.
  const ok = least.margin > 0 || (least.margin === 0 && limit === 2);
  const legs = [0, 1, 2].map((leg) =>
    paminsaLegPosition(m, AXIS_X[leg], AXIS_Y[leg], x, y, c, s, z));
  const actuators = legs.map((leg, index) => paminsaLegAngles(leg, PAGE.heading[index]).theta);
  actuators.push(paminsaLiftPosition(m, z));
  const unit = paminsaUnitTorques(m, x, y, c, s, z);
  const [determinant, condition] = paminsaDexterity(m, x, y, c, s, z);
  const turn = Math.abs(Math.atan2(s, c));
  const { position, rotation } = paminsaSingularDistances(m, x, y, c, turn);
  return {
    ok, margin: least.margin, limit, leg: Math.floor(least.which / 4) + 1, legs,
    actuators: ok ? actuators : [NaN, NaN, NaN, NaN],
    torques: staticTorques(robot, unit, x, y, c, s, z),
    determinant, condition, position, rotation,
  };
};

/** Return static torques of M1..M3 on a grid about the origin, (3, n * n), rows from low y. */
const solveMaps = (robot, theta, z, radius, n) => {
  const [c, s] = [Math.cos(theta), Math.sin(theta)];
  const m = robot.mechanism;
  const maps = [0, 1, 2].map(() => new Float64Array(n * n));
  const place = (index) => radius * (2 * (index + 0.5) / n - 1);
  for (let row = 0; row < n; row++) {
    for (let column = 0; column < n; column++) {
      const [x, y] = [place(column), place(row)];
      const found = staticTorques(robot, paminsaUnitTorques(m, x, y, c, s, z), x, y, c, s, z);
      for (let index = 0; index < 3; index++) maps[index][row * n + column] = found[index];
    }
  }
  return maps;
};

// --- share codes: "PMZ1-" and base64url of the deflated text ----------------------------------
const through = async (bytes, stream, most = Infinity) => {
  const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader();
  const parts = [];
  let size = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    size += value.length;
    if (size > most) {
      await reader.cancel();
      refuse("it is damaged or incomplete");
    }
    parts.push(value);
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
};

/** Return the share code of a document. */
const shareCode = async (doc) => {
  const text = new TextEncoder().encode(JSON.stringify(doc));
  const packed = await through(text, new CompressionStream("deflate"));
  const letters = btoa(String.fromCharCode(...packed));
  return PAGE.prefix + letters.replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
};

/** Return the document of a share code; raise a RangeError with one line. */
const openShareCode = async (given) => {
  if (given.length > PAGE.longestCode)
    refuse(`it is too long (at most ${PAGE.longestCode} characters)`);
  const code = given.split("&")[0].replace(/\s+/g, "");
  if (!code.startsWith(PAGE.prefix)) {
    const version = /^PMZ(\d+)-/.exec(code);
    refuse(version
      ? `it is from another version of paminsa_viz (packing ${version[1].slice(0, 20)})`
      : `a share code begins with ${PAGE.prefix}`);
  }
  let text;
  try {
    const body = code.slice(PAGE.prefix.length).replaceAll("-", "+").replaceAll("_", "/");
    const packed = Uint8Array.from(atob(body), (letter) => letter.charCodeAt(0));
    const stream = new DecompressionStream("deflate");
    text = new TextDecoder("utf-8", { fatal: true })
      .decode(await through(packed, stream, PAGE.longestText));
  } catch {
    refuse("it is damaged or incomplete");
  }
  return checkedDocument(text);
};
