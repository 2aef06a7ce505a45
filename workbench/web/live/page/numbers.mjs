// Observables of a shape, in its units, of what the core measures along the rod.

import { FORCES, LENGTHS, LINEAR, OBSERVED } from "./formulas.mjs";
import { evenly, every, merged, timed } from "./rod_shape.mjs";
import { crossings, isTooLong } from "./self_contact.mjs";
import { number } from "./text.mjs";

export const AT_ENDS = "next to its ends alone"; // as the solver says it
const STEP = 2; // every second station is enough for polynomials of order five
const ROUNDING = 1e-9; // rad: beta of a helix changes by no more

/* Observables by name, in the units of the state. Those of a rod whose loads vary are the server's. */
export function observables(shape) {
  const { one, beta, problem, halfPeriod, shown, wanted } = shape;
  if (one.varies) return shape.numbers;
  const fine = wanted > shape.even.s.length && shape.at(evenly(one.L * shown, wanted)), // of a long rod: errors add up
    stations = merged(fine || every(shape.even, STEP), shape.marks), // extremes that are equal are so at the marks alone
    read = shape.core.measure(problem, one.sign, shape.error || 0, timed(one, stations)),
    third = evenly(one.L / 3, Math.ceil(stations.s.length / 3)),
    middle = shown === 1 && shape.core.measure(problem, one.sign, 0, timed(one, shape.at(third.map((s) => s + one.L / 3)))),
    known = { ...one, ...problem, ...read, middle_push: middle.pushed ?? NaN };
  const rows = Object.entries(OBSERVED).map(([name, formula]) => [name, formula(known)]),
    { FZ, MZ, M3, ...others } = Object.fromEntries(rows.filter(([, value]) => !Number.isNaN(value)));
  const noise = Math.max(ROUNDING, 10 * shape.error),
    steady = read.high - read.low < noise,
    bend_number = halfPeriod === undefined ? NaN : halfPeriod && !steady ? one.L / halfPeriod : 0;
  return { FZ, MZ, M3, bends: bends(beta, noise), bend_number, ...others };
}

const OF_ANY_PART = ["FZ", "MZ", "M3", "bend_number", "lift_off_at"]; // a part of a rod has those of the whole

/* Name and value of each observable that is known: of a rod that is shown in part those that the part decides. */
export const rowsOf = ({ shown }, found) =>
  Object.entries(found).filter(([name, value]) => Number.isFinite(value) && (shown === 1 || OF_ANY_PART.includes(name)));

/* What a real rod could not do, as sentences; found: the observables; units: of its numbers; crossed: where it passes
   through itself. */
export function warnings(shape, found, units, crossed = crossings(shape)) {
  const told = [],
    size = Math.max(Math.abs(found.push_min), Math.abs(found.push_max));
  if (found.kappa_max * shape.one.a > 1) told.push("The rod is bent tighter than its own radius.");
  if (crossed.length) told.push("The rod passes through itself.");
  else if (isTooLong(shape)) told.push("The rod is too long for self-contact to be examined here.");
  told.push(...strained(shape, found, units));
  const where = isPressed(shape) ? AT_ENDS : "the cylinder";
  if (found.push_min < -1e-6 * size) told.push(`The rod would lift off ${where}.`);
  return told;
}

/* Whether the cylinder surely pushes all along the middle half of a rod. */
const isPressed = ({ s, push, shown, one: { L } }) => shown === 1 && push.every((v, i) => v > 0 || Math.abs(s[i] / L - 0.5) >= 0.25);

/* A sentence on a strain beyond that up to which the material is surely linear. Of a rod whose loads vary the server has
   it among its notes. */
function strained({ one, kappa, tension }, { kappa_max, M3 }, { length, force }) {
  if (!one.E || one.varies) return [];
  const area = Math.PI * (one.a ** 2 - one.inner_radius ** 2),
    pull = tension[0] + (one.A / 2) * (kappa[0] ** 2 - kappa_max ** 2),
    fibre = one.a * kappa_max + Math.abs(pull) / (one.E * area),
    strain = Math.max(fibre, (one.a * Math.abs(M3)) / one.C / 2),
    megapascals = (one.E * FORCES[force]) / LENGTHS[length] ** 2 / 1e6,
    [, most] = LINEAR.find(([least]) => megapascals >= least);
  const [percent, linear] = [100 * strain, 100 * most].map((v) => (v < 9.95 ? number(v, 2) : number(Math.round(v), 5)));
  const words = `but materials of its modulus may be non-linear beyond ${linear} %`;
  return strain > most ? [`The rod is strained by ${percent} %, ${words}.`] : [];
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
