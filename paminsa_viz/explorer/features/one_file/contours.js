/** Contour lines of maps, by the rules of the program's `plots.contours`. */
const CONTOUR_LEVELS = 12; // about how many
const CONTOUR_POINTS = 50; // along a side: quicker than all, and looks the same

/** Return the contour levels of a range from -limit to limit: round numbers strictly inside. */
const levelsOf = (limit) => multiples(-limit, limit, roundFrom(2 * limit / CONTOUR_LEVELS, [1, 2, 2.5, 5]))
  .filter((level) => Math.abs(level) < limit);

/**
 * Return the pieces in which a level crosses a square, given the values at its corners, which
 * stand around it: shares x, y, x, y of the side from the first corner, for each piece.
 */
const crossings = (a, b, c, d, level) => {
  const found = [];
  if (a < level !== b < level) found.push((level - a) / (b - a), 0);
  if (b < level !== c < level) found.push(1, (level - b) / (c - b));
  if (c < level !== d < level) found.push((level - d) / (c - d), 1);
  if (d < level !== a < level) found.push(0, (level - a) / (d - a));
  // At a saddle the middle is on the side of a and c, or it parts them.
  const isParted = found.length === 8 && (a + b + c + d) / 4 < level !== a < level;
  return isParted ? [...found.slice(6), ...found.slice(0, 6)] : found;
};

/**
 * Return the contour lines of a map (n * n, rows from low y): by level, numbers x, y, x, y for each
 * piece, in shares of the map's side from its lower left.
 *
 * Torques change sign through infinity at the `singular` circle, a radius in shares as well; no
 * level runs past values beyond the range next to it, nor through a square that reaches from beyond
 * one end of the range to beyond the other.
 */
const contourLines = (values, n, limit, singular) => {
  const stride = Math.max(1, Math.round(n / CONTOUR_POINTS));
  const lines = levelsOf(limit).map((level) => ({ level, pieces: [] }));
  const place = (index) => (index + 0.5) / n;
  const near = 0.71 * stride / n; // of two corners with the circle between them one is as near as this
  const isTorn = (row, column) => !(Math.abs(values[row * n + column]) <= limit)
    && Math.abs(Math.hypot(place(column) - 0.5, place(row) - 0.5) - singular) < near;
  for (let row = 0; row + stride < n; row += stride) {
    for (let column = 0; column + stride < n; column += stride) {
      const [right, up, start] = [column + stride, row + stride, row * n + column];
      const [a, b] = [values[start], values[start + stride]];
      const [d, c] = [values[start + stride * n], values[start + stride * n + stride]];
      const [low, high] = [Math.min(a, b, c, d), Math.max(a, b, c, d)];
      if (!(high - low < Infinity) || low >= limit || high <= -limit) continue;
      if (low < -limit || high > limit) {
        if (low < -limit && high > limit) continue;
        if (isTorn(row, column) || isTorn(row, right) || isTorn(up, right) || isTorn(up, column)) continue;
      }
      for (const { level, pieces } of lines) {
        if (level <= low || level > high) continue;
        const found = crossings(a, b, c, d, level);
        for (let at = 0; at < found.length; at += 2)
          pieces.push(place(column + stride * found[at]), place(row + stride * found[at + 1]));
      }
    }
  }
  return lines;
};
