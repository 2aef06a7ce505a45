// Where the rod passes through itself: two of its points, farther apart along it than pi a, closer than 2 a; and bends that
// are tighter than the rod is thick (kappa a >= 1), in which it overlaps too.

import { evenly, pointAt } from "./rod_shape.mjs";

const SPACING = 8; // points on each radius of length
const MOST = 40_000; // points; a longer rod is not examined
const MOST_PLACES = 200;
const NEAR = [2, 0.2]; // radii between two stretches: they overlap; their centrelines cross

const pointsOf = ({ one, shown }) => Math.ceil((SPACING * one.L * shown) / one.a) + 1;
export const isTooLong = (shape) => pointsOf(shape) > MOST;

/* The middles of the nearest pairs (x, y, z), one of each overlap and of each crossing of the centreline; none where the
   rod is too long to be examined. Pairs within 0.4 % of 2 a may be missed. */
export function crossings(shape) {
  if (isTooLong(shape)) return [];
  const { core, one, at } = shape,
    n = pointsOf(shape),
    s = evenly(one.L * shape.shown, n),
    line = at(s),
    points = new Float64Array(3 * n);
  for (let i = 0; i < n; i++) points.set(pointAt(line, i), 3 * i);
  const pairs = NEAR.flatMap((near) => core.crossings(s, points, near * one.a, Math.PI * one.a, MOST_PLACES));
  const places = new Map(pairs.map((pair) => [String(pair), pair]));
  return [...places.values()].map(([i, j]) => [0, 1, 2].map((k) => (points[3 * i + k] + points[3 * j + k]) / 2));
}

/* The tightest points (x, y, z) of its bends that are tighter than the rod, one of each that is no part of a place where it
   is crossed: nearer than 2 a to that. */
export function tightBends(shape, crossed) {
  const { kappa, one } = shape,
    tightest = [];
  for (let i = 0, within = false; i < kappa.length; i++) {
    const last = tightest.length - 1,
      tight = kappa[i] * one.a >= 1;
    if (tight && !within) tightest.push(i);
    else if (tight && kappa[i] > kappa[tightest[last]]) tightest[last] = i;
    within = tight;
  }
  const isAlone = (spot) => crossed.every((place) => Math.hypot(...place.map((x, k) => x - spot[k])) >= 2 * one.a);
  return tightest.map((i) => pointAt(shape, i)).filter(isAlone);
}
