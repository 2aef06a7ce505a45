// What the diagrams beside the rod show of a shape: plain rows of numbers with their labels,
// and where the cursor stands in them for the values at a place of the rod.

import { potential } from "./formulas.mjs";
import { onLines } from "./rod_shape.mjs";
import { range } from "./range.mjs";
import { PUSH, stated } from "./text.mjs";

const DEGREE = 180 / Math.PI;
const ANGLES = 721; // points of the potential

export function diagrams(shape, units) {
  const { one, beta, push, axial, gap } = shape,
    { length, force } = units,
    [pushUnit, size] = stated(PUSH, units);
  const over = (key, title, y, ylabel, of, look) => ({
    ...{ key, title, x: shape.s, y, xlabel: `s [${length}]`, ylabel, rising: true },
    ...{ alongRod: true, cursor: (at) => [at.s, of(at)] },
    ...look,
  });
  const title = "Angle β to the axis",
    degrees = beta.map((v) => v * DEGREE),
    pushed = { zero: true, shaded: true, push },
    off = { zero: true, least: 1e-6 * one.L };
  const angle = (key) => over(key, title, degrees, "β [°]", (at) => at.beta * DEGREE, { least: 0.2 });
  return [
    unrolled(shape, length),
    one.leaves ? over("beta", "Gap between rod and wall", gap, `gap [${length}]`, (at) => at.gap, off) : angle("beta"),
    over("push", "Push of the cylinder per length", push.map((v) => v * size), `push [${pushUnit}]`, (at) => at.push * size, pushed),
    one.leaves
      ? angle("well")
      : one.varies
        ? over("well", "Axial force along the cylinder", axial, `FZ [${force}]`, (at) => at.axial)
        : well(shape, length),
  ];
}

/* Seen from outside with z to the right. A helix that reaches more than once around the cylinder leaves the view at one
   edge and comes back at the other. At s = 0 it is at 0, the edge on which it begins. */
function unrolled({ one, z, alpha, push }, length) {
  const turn = 2 * Math.PI * one.rho,
    far = (v) => one.rho * (alpha[0] - v),
    [low, high] = range(alpha.map(far)),
    winds = !one.leaves && high - low > turn && isMonotone(alpha) && isMonotone(z),
    rises = winds && high > 0,
    turns = (v) => (rises ? Math.floor(v / turn) + 1 : Math.ceil(v / turn)),
    around = winds ? (v) => far(v) - turn * turns(far(v)) : far,
    y = alpha.map(around);
  return {
    key: "developed",
    title: winds ? "Unrolled view of one turn, seen from outside" : "Unrolled view, seen from outside",
    x: z,
    y,
    xlabel: `z [${length}]`,
    ylabel: `around [${length}]`,
    cursor: (at) => [at.z, around(at.alpha)],
    flipped: true,
    height: 170,
    least: 1e-6 * one.L,
    equal: true,
    dot: true,
    jump: winds ? turn / 2 : Infinity,
    push,
  };
}

/* Potential and level over one rotation of beta about the angles that occur, so that these are one range. */
function well({ one, problem, beta }, length) {
  const G = (angle) => potential(problem, angle) / one.rho ** 2,
    [low, high] = range(beta).map((end) => end * DEGREE),
    isWithin = low >= -180 && high <= 180,
    first = isWithin || high - low >= 360 ? -180 : (low + high) / 2 - 180;
  const x = Float64Array.from({ length: ANGLES }, (_, i) => first + (360 * i) / (ANGLES - 1)),
    turned = (degrees) => degrees - 360 * Math.floor((degrees - first) / 360);
  return {
    key: "well",
    title: "Potential G; level h thick over the angles that occur",
    x,
    y: x.map((v) => G(v / DEGREE)),
    xlabel: "β [°]",
    ylabel: `G [1/${length}²]`,
    cursor: (at) => [turned(at.beta * DEGREE), G(at.beta)],
    byX: true,
    level: (problem.dbeta0 / one.rho) ** 2 + G(problem.beta0),
    ranges: [high - low >= 360 ? [first, first + 360] : [low, high]],
    rising: true,
  };
}

const isMonotone = (row) => [1, -1].some((way) => row.every((v, i) => !i || way * (v - row[i - 1]) >= 0));

/* The values of a shape at s, by straight lines between its stations. */
export function valuesAt(shape, s) {
  const names = ["beta", "push", "kappa", "tension", "alpha", "x", "y", "z", "axial", "gap"].filter((name) => shape[name]);
  return { s, ...Object.fromEntries(names.map((name) => [name, onLines(shape.s, shape[name], [s])[0]])) };
}
