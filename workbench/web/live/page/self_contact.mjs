// Where the rod passes through itself: two of its points, farther apart along it than pi a, closer than 2 a.

import { evenly, pointAt } from "./rod_shape.mjs";

const SPACING = 8; // points on each radius of length
const MOST = 40_000; // points; a longer rod is not examined
const MOST_PLACES = 200;

/* The middles of the nearest pairs (x, y, z), one of each crossing; none where the rod is too long to be examined. Pairs
   within 0.4 % of 2 a may be missed. */
export function crossings({ core, one, at, shown }) {
  const length = one.L * shown,
    n = Math.ceil((SPACING * length) / one.a) + 1;
  if (n > MOST) return [];
  const s = evenly(length, n),
    places = at(s),
    points = new Float64Array(3 * n);
  for (let i = 0; i < n; i++) points.set(pointAt(places, i), 3 * i);
  const pairs = core.crossings(s, points, 2 * one.a, Math.PI * one.a, MOST_PLACES);
  return pairs.map(([i, j]) => [0, 1, 2].map((k) => (points[3 * i + k] + points[3 * j + k]) / 2));
}
