/** Round numbers of axes and colors, as the program's `plots.ticks` and `plots.ranges` have them. */
const clean = (value) => Number(value.toPrecision(12)); // without the rounding of a multiplication

/** Return the first of some round numbers, times a power of ten, that is at least a value. */
const roundFrom = (value, numbers) => {
  const power = 10 ** Math.floor(Math.log10(value));
  return clean(power * (numbers.find((each) => each * power >= value * (1 - 1e-9)) ?? 10));
};

const ENDS = [1, 1.5, 2, 3, 4, 5, 6, 8, 10]; // of colors
const nearestEnd = (value) => {
  const power = 10 ** Math.floor(Math.log10(value));
  const far = (end) => Math.abs(Math.log(end * power / value));
  return clean(power * ENDS.reduce((best, end) => (far(end) < far(best) ? end : best)));
};

/** Return a percentile of values in rising order, linear between two of them. */
const percentile = (sorted, percent) => {
  const place = percent / 100 * (sorted.length - 1);
  const [below, above] = [Math.floor(place), Math.ceil(place)];
  return sorted[below] + (place - below) * (sorted[above] - sorted[below]);
};

/**
 * Return the torque at the ends of the colors of maps: four times the 40th percentile of their
 * sizes, which grow without bound near a singularity [N m]. What rounding leaves of a balanced
 * robot has no colors; `one` is a torque of the robot's size, which then ends them [N m].
 */
const colorLimit = (maps, one) => {
  const all = new Float64Array(maps.reduce((sum, map) => sum + map.length, 0));
  maps.reduce((at, map) => (all.set(map, at), at + map.length), 0);
  const sizes = all.map(Math.abs).filter((size) => size > 1e-9 * one && size < Infinity).sort();
  if (!sizes.length) return one;
  const [largest, high] = [sizes[sizes.length - 1], percentile(sizes, 98)];
  const most = largest <= 1.25 * high ? largest : high;
  const ordinary = 4 * percentile(sizes, 40);
  return ordinary < most ? nearestEnd(ordinary) : roundFrom(most, ENDS);
};

/** Return the multiples of a step from one value to another. */
const multiples = (low, high, step) => {
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.floor(high / step + 1e-9) - first + 1;
  return Array.from({ length: Math.max(count, 0) }, (_, index) => clean((first + index) * step));
};

/** Return a round step that hits both ends of -limit to limit, in at most `count` parts. */
const dividingStep = (limit, count) => {
  const power = 10 ** Math.floor(Math.log10(2 * limit / count));
  return [power, 10 * power].flatMap((scale) => [1, 1.25, 1.5, 2, 2.5, 3, 4, 5].map((part) => part * scale))
    .map(clean).find((step) => Math.abs(limit / step - Math.round(limit / step)) < 1e-6
      && 2 * limit / step <= count + 1e-6) ?? limit;
};

/** Return a round number as text: −250, 0.5, 1·10⁻⁸. */
const roundText = (value) => {
  const [mantissa, power] = String(Number(value.toPrecision(6))).split("e");
  const raised = power && `·10${[...power].map((sign) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[sign] ?? (sign === "-" ? "⁻" : "")).join("")}`;
  return mantissa.replace("-", "\u2212") + (raised ?? "");
};
