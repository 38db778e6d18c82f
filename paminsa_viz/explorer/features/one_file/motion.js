/**
 * Motions of the page in one file: the presets, sized for a robot, and the actuators' torques by
 * their causes. A state has pose, velocity and acceleration, four numbers each, SI units.
 */
const CAUSES = ["gravity", "inertial", "velocity", "friction", "load"];

/** Return a time law and its first two derivatives at an instant of unit time. */
const lawAt = ({ breaks, pieces }, u) => {
  let piece = pieces.length - 1;
  while (piece > 0 && u < breaks[piece]) piece--;
  const since = u - breaks[piece];
  let [value, rate, growth] = [0, 0, 0];
  for (const coefficient of pieces[piece]) {
    growth = growth * since + rate;
    rate = rate * since + value;
    value = value * since + coefficient;
  }
  return [value, rate, 2 * growth];
};

/** Return the center of the presets and what their coordinates are multiplied by for a robot. */
const presetFrame = ({ mechanism: m }) => {
  const bars = m.crank + m.coupler;
  const span = m.span_ratio * Math.abs(m.base_radius - m.platform_radius);
  const up = Math.sqrt(Math.max(bars * bars - span * span, 0)) / PAGE.motions.height;
  const across = m.base_radius / PAGE.motions.radius;
  return {
    scale: [across, across, 1, up],
    center: [0, 0, 0, -m.root * PAGE.motions.depth * up - m.joint_height],
  };
};

/** Return a preset as a function of time [s], and its duration; `law` and `duration` are choices. */
const motionOf = (robot, preset, law = preset.law, duration = 0) => {
  const { scale, center } = presetFrame(robot);
  const scaled = (pose) => pose.map((value, axis) => scale[axis] * value);
  const start = scaled(preset.start).map((value, axis) => center[axis] + value);
  const moves = (preset.moves ?? []).map((move) => ({ ...move, shift: scaled(move.shift) }));
  const [first, second] = [preset.first ?? [0, 0, 0, 0], preset.second ?? [0, 0, 0, 0]].map(scaled);
  const place = (shift) => Math.hypot(shift[0], shift[1], shift[3]);
  const own = preset.scales
    ? preset.duration * Math.sqrt(place(moves[0].shift) / place(preset.moves[0].shift))
    : preset.duration;
  const lasts = duration || own;
  const table = PAGE.motions.laws[law];
  const at = (time) => {
    const u = Math.min(Math.max(time / lasts, 0), 1);
    const state = { pose: [...start], velocity: [0, 0, 0, 0], acceleration: [0, 0, 0, 0] };
    for (const { shift, begin, end } of moves) {
      const share = (u - begin) / (end - begin);
      const [value, rate, growth] = lawAt(table, Math.min(Math.max(share, 0), 1));
      const runs = share >= 0 && share <= 1 ? 1 / ((end - begin) * lasts) : 0;
      shift.forEach((part, axis) => {
        state.pose[axis] += part * value;
        state.velocity[axis] += part * rate * runs;
        state.acceleration[axis] += part * growth * runs * runs;
      });
    }
    if (preset.angle) {
      const [value, rate, growth] = lawAt(table, u).map((part) => part * preset.angle);
      const [c, s, speed, gain] =
        [Math.cos(value), Math.sin(value), rate / lasts, growth / (lasts * lasts)];
      for (let axis = 0; axis < 4; axis++) {
        const out = first[axis] * c + second[axis] * s;
        const along = second[axis] * c - first[axis] * s;
        state.pose[axis] += out;
        state.velocity[axis] += along * speed;
        state.acceleration[axis] += along * gain - out * speed * speed;
      }
    }
    return state;
  };
  return { at, duration: lasts };
};

/** Return the torques of M1..M4 in a state by their causes, four numbers each, and their sum. */
const torqueParts = (robot, { pose, velocity, acceleration }) => {
  const m = robot.mechanism;
  const [x, y, theta, z] = pose;
  const [c, s] = [Math.cos(theta), Math.sin(theta)];
  const still = [0, 0, 0, 0];
  const solve = (terms, gravity, speed, growth) => {
    const found =
      paminsaInverseDynamicsKernel(m, terms, gravity, x, y, c, s, z, ...speed, ...growth);
    return [found.tau1, found.tau2, found.tau3, found.f4];
  };
  const rows = paminsaSpeedRows(m, x, y, c, s, z);
  const speeds = [0, 1, 2].map((leg) => rows[3 * leg] * velocity[0]
    + rows[3 * leg + 1] * velocity[1] + rows[3 * leg + 2] * velocity[2]);
  speeds.push(velocity[3] / m.k);
  const parts = {
    gravity: solve(robot.terms, robot.g, still, still),
    inertial: solve(robot.weightless, 0, still, acceleration),
    velocity: solve(robot.weightless, 0, velocity, still),
    friction: speeds.map((speed, index) =>
      paminsaFriction(...robot.friction[index < 3 ? 0 : 1], robot.slow, speed)),
    load: loadTorques(robot, x, y, c, s, z),
  };
  parts.total = still.map((_, index) =>
    CAUSES.reduce((sum, cause) => sum + parts[cause][index], 0));
  return parts;
};
