/**
 * The document of the page in one file: a design with its pose, as a share code holds it.
 *
 * SI units; a pose is (x, y, theta, z).
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

// --- design files -----------------------------------------------------------------------------
const tomlValue = (value) => Array.isArray(value) ? `[${value.map(tomlValue).join(", ")}]`
  : typeof value !== "number" ? JSON.stringify(value)
    : Number.isInteger(value) ? value.toFixed(1) : String(value);

/** Return a document's design as the text of a design file, with what differs from Appendix 4. */
const designFile = (doc) => {
  const tables = new Map([["", []]]);
  const rows = (table) => tables.get(table) ?? tables.set(table, []).get(table);
  for (const [path, value] of Object.entries(doc.design)) {
    const { table, key } = PAGE.parameters[path];
    rows(table).push(`${key} = ${tomlValue(value)}`);
  }
  if (doc.knee === "upper") rows("geometry").push('knee = "upper"');
  if (doc.load_frame === "platform") rows("load").push('frame = "platform"');
  doc.drives?.forEach((drive, index) => drive && rows(PAGE.driveTables[index]).push(
    ...Object.entries(drive).map(([name, value]) => `${PAGE.driveKeys[name]} = ${tomlValue(value)}`)));
  const head = [
    `# Written by ${PAGE.madeBy}, the page in one file. Without a value it is Appendix 4's.`,
    `name = ${tomlValue(doc.name)}`, `schema_version = ${PAGE.schemaVersion}`,
    ...tables.get(""),
  ];
  tables.delete("");
  const parts = [...tables].map(([table, lines]) => [`\n[${table}]`, ...lines].join("\n"));
  return `${[head.join("\n"), ...parts].join("\n")}\n`;
};
