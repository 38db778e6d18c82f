/**
 * The robot's bodies: meshes made by the program, stretched to a robot's lengths, and where each is
 * in a pose. A matrix is 16 numbers, column by column.
 */
const BODIES = (() => {
  const block = Uint8Array.from(atob(PAGE.meshes.block), (letter) => letter.charCodeAt(0)).buffer;
  let at = 0;
  const read = (Kind, count) => {
    const found = new Kind(block, at, count);
    at += Math.ceil(found.byteLength / 4) * 4;
    return found;
  };
  const bodies = {};
  for (const [name, said] of Object.entries(PAGE.meshes.bodies)) {
    const { points: n, faces: m } = said;
    bodies[name] = {
      ...said, points: read(Int32Array, 3 * n), normals: read(Int8Array, 3 * n),
      materials: read(Uint8Array, n), groups: read(Uint8Array, n), faces: read(Uint16Array, 3 * m),
    };
  }
  return bodies;
})();

/** Return every length that the shape of a body depends on, over the size of the bodies [m]. */
const bodyLengths = (robot) => {
  const m = robot.drawn;
  const [guide, arm] = [robot.guide / robot.scale, robot.arm / robot.scale];
  return {
    ...paminsaFrameLengths(m, guide), base_radius: m.base_radius, platform_radius: m.platform_radius,
    joint_height: m.joint_height, shaft: m.shaft, crank: m.crank, coupler: m.coupler,
    crank_part: m.crank / m.k, coupler_part: m.coupler / m.k,
    guide_link: guide,
    arm_start: Math.min(Math.max(m.base_radius - arm, 0), m.base_radius),
  };
};

/** Return a body's points for some lengths, three numbers each [m]. */
const stretched = (body, lengths) => {
  const changes = body.names.map((name, index) => lengths[name] - body.at[index]);
  const shifts = body.moves.map((move) => [0, 1, 2].map((axis) =>
    changes.reduce((sum, change, index) => sum + change * move[3 * index + axis], 0)));
  const points = new Float32Array(body.points.length);
  for (let index = 0; index < points.length; index++)
    points[index] = body.points[index] * PAGE.meshes.grain + shifts[body.groups[(index / 3) | 0]][index % 3];
  return points;
};

/** Return the joints of a leg by the paper's numbers, in the leg's plane: [r, z] each [m]. */
const jointsInPlane = (robot, leg) => {
  const { k } = robot.mechanism;
  const { rho, r9, zeta, z9 } = leg;
  return { 3: [0, zeta / k], 5: [rho, zeta], 8: [-rho / (k - 1), 0], 9: [r9, z9] };
};

const shifted = (x, y, z, turn = 0) => {
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  return [c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, x, y, z, 1];
};

/**
 * Return where each body is in a pose that can be taken: its name, what it is drawn in, and its
 * matrix. `accent` is the number of the actuator whose color its colored faces have, 0 for none.
 */
const placedBodies = (robot, pose, solved) => {
  const m = robot.mechanism;
  const neck = m.base_radius - robot.arm > robot.scale * PAGE.meshes.neck ? ".neck" : "";
  const knee = m.root > 0 ? "lower" : "upper";
  const [x, y, theta, z] = pose;
  const found = [
    { body: "ground", accent: 0, matrix: shifted(0, 0, 0) },
    { body: `base.${knee}`, accent: 0, matrix: shifted(0, 0, 0) },
    { body: `m4.${knee}`, accent: 4, matrix: shifted(0, 0, 0) },
    { body: `carriage.${knee}${neck}`, accent: 4, matrix: shifted(0, 0, solved.actuators[3]) },
    { body: "platform", accent: 0, matrix: shifted(x, y, z, theta) },
  ];
  if (robot.payload > 0) {
    const top = z + m.joint_height + robot.scale * PAGE.meshes.payload[knee];
    const matrix = shifted(x, y, top, theta);
    const size = Math.cbrt(robot.payload) / robot.scale; // its mass alone decides
    const over = knee === "upper" ? -size : size; // turned over about x
    [size, over, over].forEach((scale, column) => {
      for (let row = 0; row < 3; row++) matrix[4 * column + row] *= scale;
    });
    found.push({ body: "payload", accent: 0, matrix });
  }
  const heading = (leg) => Math.atan2(AXIS_Y[leg], AXIS_X[leg]);
  solved.legs.forEach((leg, index) => {
    const { ux, uy } = leg;
    const joints = jointsInPlane(robot, leg);
    const [ax, ay] = [m.base_radius * AXIS_X[index], m.base_radius * AXIS_Y[index]];
    // x along the direction (dr, dz) of the leg's plane, y across it
    const inPlane = ([r, height], [dr, dz]) => [
      dr * ux, dr * uy, dz, 0, -uy, ux, 0, 0, -dz * ux, -dz * uy, dr, 0,
      ax + r * ux, ay + r * uy, height, 1,
    ];
    const level = [1, 0];
    const b8 = [leg.cos_phi, leg.sin_phi];
    const b4 = [leg.cos_psi, leg.sin_psi];
    const accent = index + 1;
    found.push(
      { body: `m1.${knee}`, accent, matrix: shifted(0, 0, 0, heading(index) - heading(0)) },
      { body: `guide.${knee}`, accent, matrix: inPlane([0, 0], level) },
      { body: "shaft", accent, matrix: inPlane(joints[3], level) },
      { body: "slider", accent, matrix: inPlane(joints[8], level) },
      { body: "swivel", accent, matrix: inPlane(joints[5], level) },
      { body: "b3", accent, matrix: inPlane(joints[3], b8.map((part) => -part)) },
      { body: "b7", accent, matrix: inPlane(joints[8], b4) },
      { body: "b8", accent, matrix: inPlane(joints[8], b8) },
      { body: "b4", accent, matrix: inPlane(joints[9], b4) },
    );
  });
  for (const { matrix } of found)
    [0, 1, 2, 4, 5, 6, 8, 9, 10].forEach((index) => { matrix[index] *= robot.scale; });
  return found;
};
