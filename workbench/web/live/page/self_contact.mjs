// Where the rod passes through itself: two of its points, farther apart along it than pi a, closer than 2 a.

const SPACING = 8; // points on each radius of length
const MOST = 40_000; // points; a longer rod is not examined

/* The middles of the nearest pairs (x, y, z), one of each crossing; none where the rod is too long to be examined. Pairs
   within 0.4 % of 2 a may be missed. */
export function crossings({ one, at, shown }) {
  const length = one.L * shown,
    n = Math.ceil((SPACING * length) / one.a) + 1;
  if (n > MOST) return [];
  const h = length / (n - 1),
    apart = Math.ceil((Math.PI * one.a) / h),
    near = 4 * one.a * one.a,
    cell = 2 * one.a;
  const { alpha, z } = at(Float64Array.from({ length: n }, (_, i) => Math.min(i * h, length)));
  const points = Array.from({ length: n }, (_, i) => [
    one.rho * Math.cos(alpha[i]),
    one.rho * Math.sin(alpha[i]),
    z[i],
  ]);
  const cells = new Map(),
    key = (x, y, w) => (x * 73856093) ^ (y * 19349663) ^ (w * 83492791); // cells may share a key
  const found = [],
    isBeside = (pair, i, j) => Math.abs(pair.last - i) <= apart && Math.abs(pair.j - j) <= apart;
  const note = (i, j, away) => {
    const pair = found.findLast((other) => isBeside(other, i, j));
    if (!pair) found.push({ i, j, away, last: i });
    else Object.assign(pair, away < pair.away ? { i, j, away, last: i } : { last: i });
  };
  for (let i = 0; i < n; i++) {
    const place = points[i].map((v) => Math.floor(v / cell));
    for (let u = -1; u <= 1; u++)
      for (let v = -1; v <= 1; v++)
        for (let w = -1; w <= 1; w++)
          for (const j of cells.get(key(place[0] + u, place[1] + v, place[2] + w)) || []) {
            if (i - j <= apart) continue;
            const away = points[i].reduce((sum, x, k) => sum + (x - points[j][k]) ** 2, 0);
            if (away < near) note(i, j, away);
          }
    const own = key(...place);
    if (!cells.has(own)) cells.set(own, []);
    cells.get(own).push(i);
  }
  return found.map(({ i, j }) => points[i].map((x, k) => (x + points[j][k]) / 2));
}
