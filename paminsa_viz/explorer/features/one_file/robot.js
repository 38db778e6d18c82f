/**
 * The robot of the page in one file: a document in, numbers out. All mechanics is in the formulas
 * before it, which are printed from the program's source; here they are only put together.
 *
 * SI units; a pose is (x, y, theta, z), a document is the text of a share code.
 */

/** Return the mass of a design without its payload, of what the formulas need. */
const ownMass = (doc) => Object.values(PAGE.masses).reduce((sum, path) =>
  sum + (path === "platform.mass" ? 1 : /^(links|joints)\./.test(path) ? 3 : 0) * valueOf(doc, path), 0);

/**
 * Return how many decimals more, or fewer, than of the prototype torques and forces at rest, and
 * places in mm, are written with, as the program's `kit.robot_texts` has them.
 */
const spareDecimals = (doc) => {
  const prototype = { design: {} };
  const bars = (of) => valueOf(of, "geometry.crank_length") + valueOf(of, "geometry.coupler_length");
  const weight = Math.log10(ownMass(doc) / ownMass(prototype));
  const length = Math.log10(bars(doc) / bars(prototype));
  return {
    torque: -Math.round(Math.max(weight + length, -8)), force: -Math.round(Math.max(weight, -6)),
    place: Math.max(-Math.round(length), 0),
  };
};

/** Return what the formulas need of a design. */
const robotOf = (doc, knee = doc.knee) => {
  const of = (path) => valueOf(doc, path);
  const length = (name) => of(`geometry.${name}`);
  const k = length("magnification");
  const guide = length("guide_link_length");
  const lengths = [
    length("base_radius"), length("platform_radius"), length("platform_joint_height"),
    length("shaft_length"), length("crank_length"), length("coupler_length"),
    length("guide_stroke") ?? guide, length("axis_clearance"),
  ];
  const mechanismOver = (scale) => paminsaMechanismOfLengths(
    k, ...lengths.map((each) => each / scale), knee === "lower" ? 1 : -1);
  const mechanism = mechanismOver(1);
  const scale = length("body_scale");
  const masses = {};
  for (const [symbol, path] of Object.entries(PAGE.masses)) masses[symbol] = of(path);
  const g = of("gravity");
  const c = paminsaCoefficientsOfMasses(masses, k, guide, g, 2);
  const weightless = paminsaCoefficientsOfMasses(masses, k, guide, 0, 2);
  const terms = (coefficients) => Object.fromEntries(Object.entries(PAGE.motions.terms).map(
    ([name, row]) => [name, row.reduce((sum, part, index) => sum + part * coefficients[index], 0)]));
  const load = PAGE.load.map(of);
  return {
    mechanism, scale, drawn: scale === 1 ? mechanism : mechanismOver(scale), g, guide,
    arm: length("arm_length"), payload: of("payload.mass"), imbalance: c[1], load,
    turns: doc.load_frame === "platform" ? 1 : 0, loaded: load.slice(0, 6).some(Boolean),
    lift: k * (c[16] * g + 3 * c[0]) + 3 * c[2],
    spare: spareDecimals(doc), terms: terms(c), weightless: terms(weightless), slow: of("friction.transition_speed"),
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

/** Return the m_7 with which M_p2 is zero [kg]; M_p2 is linear in m_7: -g/k for a kilogram. */
const balancedMass = (robot, doc) => {
  const slope = -robot.g / robot.mechanism.k;
  return valueOf(doc, "joints.j7") - robot.imbalance / slope;
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
