// Whether the rod passes through itself: two of its points, farther apart along it than pi a, closer than 2 a.

const SPACING = 8; // points on each radius of length
const MOST = 40_000; // points; a longer rod is not examined

/* True or false, or null where the rod is too long to be examined. Pairs within 0.4 % of 2 a may be missed. */
export function passesThroughItself({ one, at, shown }) {
  const length = one.L * shown,
    n = Math.ceil((SPACING * length) / one.a) + 1;
  if (n > MOST) return null;
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
  for (let i = 0; i < n; i++) {
    const place = points[i].map((v) => Math.floor(v / cell));
    for (let u = -1; u <= 1; u++)
      for (let v = -1; v <= 1; v++)
        for (let w = -1; w <= 1; w++)
          for (const j of cells.get(key(place[0] + u, place[1] + v, place[2] + w)) || [])
            if (
              i - j > apart &&
              (points[i][0] - points[j][0]) ** 2 +
                (points[i][1] - points[j][1]) ** 2 +
                (points[i][2] - points[j][2]) ** 2 <
                near
            )
              return true;
    const own = key(...place);
    if (!cells.has(own)) cells.set(own, []);
    cells.get(own).push(i);
  }
  return false;
}
