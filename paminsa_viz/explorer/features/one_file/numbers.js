/** Elements, numbers and tables of the page in one file, and the tables of a pose. */
const NEAR = 10; // condition number from which a pose is near a singularity
const DEGREES = 180 / Math.PI;

const find = (id) => document.getElementById(id);

const isDark = () => document.documentElement.classList.contains("dark");

const number = (value, digits) => {
  if (!Number.isFinite(value)) return value === Infinity ? "∞" : "–";
  const text = value.toFixed(Math.max(digits, 0));
  return text.replace("-", Number(text) ? "\u2212" : ""); // zero has no sign
};

/** Return a place or a distance [m] in mm. */
const millimeters = (robot, value) => number(1e3 * value, 1 + robot.spare.place);

const decimals = (step) => Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));

/** Return the value of a number that is typed, with a point or a decimal comma, or what is wrong. */
const readNumber = (text) => {
  const plain = text.trim().replaceAll("\u2212", "-");
  if (/^[+-]?[1-9]\d{0,2},\d{3}$/.test(plain))
    return { problem: `${plain} may be a thousand or a fraction: write ${plain.replace(",", ".")} `
      + `or ${plain.replace(",", "")}` };
  if (!/^[+-]?(\d+[.,]?\d*|[.,]\d+)(e[+-]?\d+)?$/i.test(plain))
    return { problem: `“${plain.slice(0, 40)}” is not a number: write 33.5 or 33,5` };
  return { value: Number(plain.replace(",", ".")) };
};

/** Write a table's rows, and its head if there is one. */
const fill = (id, rows, head) => {
  const line = (cells, name) => `<tr>${cells.map((cell) => `<${name}>${cell}</${name}>`).join("")}</tr>`;
  if (head) find(id).tHead.innerHTML = line(head, "th");
  find(id).tBodies[0].innerHTML = rows.map((cells) => line(cells, "td")).join("");
};

const fillActuators = (robot, doc, solved) => {
  const pinned = doc.reference && solvePose(robotOf(doc.reference, doc.knee), doc.pose);
  fill("actuators", solved.torques.map((torque, index) => {
    const [digits, unit] = index < 3 ? [3 + robot.spare.torque, "N·m"] : [2 + robot.spare.force, "N"];
    const position = index < 3 ? `${number(DEGREES * solved.actuators[index], 2)}°`
      : `${millimeters(robot, solved.actuators[3])} mm`;
    const other = pinned
      ? [number(pinned.torques[index], digits), number(torque - pinned.torques[index], digits)] : [];
    const swatch = `<span class="swatch" style="background: var(--m${index + 1})"></span>`;
    return [`${swatch}M${index + 1}`, position, `${number(torque, digits)} ${unit}`, ...other];
  }), ["", "Position", "Static torque", ...(pinned ? ["Pinned", "Difference"] : [])]);
};

const fillMargins = (robot, doc, solved) => {
  const [x, y, theta, z] = doc.pose;
  const margins = [0, 1, 2].map((leg) => Object.values(paminsaLegMargins(robot.mechanism, AXIS_X[leg],
    AXIS_Y[leg], x, y, Math.cos(theta), Math.sin(theta), z)));
  fill("margins", PAGE.limits.map((label, limit) => [label, ...margins.map((leg, index) => {
    const text = millimeters(robot, leg[limit]);
    return index + 1 === solved.leg && limit === solved.limit ? `<b>${text}</b>` : text;
  })]), ["", "Leg 1", "Leg 2", "Leg 3"]);
};

const fillQuality = (robot, doc, solved) => {
  const mass = balancedMass(robot, doc);
  fill("quality", [
    ["M<sub>p2</sub>, static imbalance (Eq. 8)", `${number(robot.imbalance, 3 + robot.spare.force)} N`],
    ["balanced by m₇ =", mass >= 0 ? `${number(mass, 3 + robot.spare.force)} kg` : "none"],
    ["least margin", `${millimeters(robot, solved.margin)} mm, leg ${solved.leg}, ${PAGE.limits[solved.limit]}`],
    ["condition number", number(solved.condition, 3)],
    ["to the singular circle", `${millimeters(robot, solved.position)} mm`],
    ["to a singular rotation", Number.isFinite(solved.rotation)
      ? `${number(DEGREES * solved.rotation, 2)}°` : "none"],
  ]);
};

const writeStatus = (robot, solved) => {
  const near = !(solved.condition < NEAR);
  const beyond = solved.position < 0 || solved.rotation < 0;
  find("status").className = !solved.ok ? "bad" : near || beyond ? "warn" : "ok";
  find("status").textContent = !solved.ok
    ? `Out of reach: leg ${solved.leg}, ${PAGE.limits[solved.limit]}, by ${millimeters(robot, -solved.margin)} mm`
    : beyond ? "Beyond a singularity" : near ? "Near a singularity" : "Reachable";
};

/** Write all that is said of a pose. */
const writeNumbers = (robot, doc, solved) => {
  fillActuators(robot, doc, solved);
  fillMargins(robot, doc, solved);
  fillQuality(robot, doc, solved);
  writeStatus(robot, solved);
};
