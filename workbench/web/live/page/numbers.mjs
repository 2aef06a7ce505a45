// Observables of a shape: integrals, extremes and counts along the whole rod.

import { crossings } from "./self_contact.mjs";
import { range } from "./range.mjs";

const ROUNDING = 1e-9; // rad: beta of a helix changes by no more

/* Observables by name, in the units of the state. */
export function observables(shape) {
  const { one, beta, push, kappa, tension, s, z, alpha } = shape,
    { A, C, rho, L } = one,
    last = s.length - 1;
  const [low, high] = range(beta),
    [least, most] = range(push),
    noise = Math.max(ROUNDING, 10 * shape.error),
    steady = high - low < noise;
  const middle = middles(shape),
    whole = (f) =>
      integral(
        s,
        (i) => f(shape, i),
        (i) => f(middle, i),
      );
  const bending = (A / 2) * whole((row, i) => row.kappa[i] ** 2),
    twist = (one.M3 ** 2 * L) / (2 * C);
  const work = whole(
    ({ beta: b }, i) =>
      one.FZ * Math.cos(b[i]) + (one.MZ * Math.sin(b[i])) / rho - (one.M3 * Math.sin(2 * b[i])) / (2 * rho),
  );
  const pushed = part(s, push, middle.push, 1),
    pulled = part(s, push, middle.push, -1),
    kappaMost = range(kappa)[1];
  const periods = shape.halfPeriod === undefined ? NaN : shape.halfPeriod && !steady ? L / shape.halfPeriod : 0;
  const loads = one.varies ? {} : { FZ: one.FZ, MZ: one.MZ, M3: one.M3 }, // those that vary are the server's
    energies = one.varies
      ? {}
      : { energy: bending - work - twist, bending_energy: bending, twist_energy: twist };
  return {
    ...loads,
    turns: bends(beta, noise),
    bend_number: periods,
    amplitude: high - low,
    wraps: (alpha[last] - alpha[0]) / (2 * Math.PI),
    height: z[last] - z[0],
    kappa_mean: whole((row, i) => row.kappa[i]) / L,
    kappa_max: kappaMost,
    push_mean: pushed.area / L,
    pull_mean: pulled.area / L,
    push_min: least,
    push_max: most,
    attached: pushed.length / L,
    lift_off_at: liftOff(s, push, Math.max(most, -least), L),
    F3_size_max: Math.max(...range(tension).map(Math.abs)),
    bending_moment_max: A * kappaMost,
    ...(one.E === undefined ? {} : { bending_stress_max: one.E * one.a * kappaMost }),
    ...energies,
  };
}

/* What a real rod could not do, as sentences; found: the observables; crossed: where it passes through itself. */
export function warnings(shape, found, crossed = crossings(shape)) {
  const told = [],
    size = Math.max(Math.abs(found.push_min), Math.abs(found.push_max));
  if (found.kappa_max * shape.one.a > 1) told.push("The rod is bent tighter than its own radius.");
  if (crossed.length) told.push("The rod passes through itself.");
  if (found.push_min < -1e-6 * size) told.push("The rod would lift off where the cylinder has to pull.");
  return told;
}

/* The shape half way between its stations. */
const middles = ({ s, at }) => at(Float64Array.from({ length: s.length - 1 }, (_, i) => (s[i] + s[i + 1]) / 2));

/* An integral over s by Simpson's rule on each interval, from values at the stations and half way between them. */
function integral(s, value, middle) {
  let sum = 0;
  for (let i = 1; i < s.length; i++) sum += ((s[i] - s[i - 1]) / 6) * (value(i - 1) + 4 * middle(i - 1) + value(i));
  return sum;
}

/* Integral and length of the stretches where sign times the push is positive; the zeros are among the stations. */
function part(s, push, middle, sign) {
  let area = 0,
    length = 0;
  for (let i = 1; i < s.length; i++) {
    if (!(sign * middle[i - 1] > 0)) continue;
    const h = s[i] - s[i - 1];
    area += (sign * h * (push[i - 1] + 4 * middle[i - 1] + push[i])) / 6;
    length += h;
  }
  return { area, length };
}

/* The first s where the cylinder would have to pull; L where it nowhere has to. */
function liftOff(s, push, size, L) {
  for (let i = 0; i < s.length; i++) if (push[i] < -1e-9 * size) return i === 0 ? 0 : s[i - 1];
  return L;
}

/* How often beta turns back by more than `least` between the ends of the rod. */
function bends(beta, least) {
  let [way, extreme, count] = [0, beta[0], 0];
  for (const b of beta) {
    if (way === 0) way = b - extreme > least ? 1 : extreme - b > least ? -1 : 0;
    else if (way * (b - extreme) < -least) {
      way = -way;
      count += 1;
      extreme = b;
    }
    if (way * (b - extreme) > 0) extreme = b;
  }
  return count;
}
