// What the diagrams beside the rod show of a shape: plain rows of numbers with their labels.

import { potential } from "./forces.mjs";
import { intervalOf } from "./rod_shape.mjs";

const DEGREE = 180 / Math.PI;
const ANGLES = 721; // points of the potential
const FLAT = 6; // how many times longer than wide a developed curve is drawn with equal scales

export function diagrams(shape, units) {
  const { one, s, beta, push, z, alpha } = shape,
    { length, force } = units,
    rho = one.rho;
  const across = alpha.map((v) => rho * (v - alpha[0])),
    degrees = beta.map((v) => v * DEGREE);
  return [
    {
      key: "developed",
      title: "Developed curve, seen from outside",
      x: across,
      y: z,
      xlabel: `ρα [${length}]`,
      ylabel: `z [${length}]`,
      height: 250,
      least: 1e-6 * one.L,
      ...scales(across, z),
      dot: true,
    },
    {
      key: "beta",
      title: "Angle β from the axis to the tangent",
      x: s,
      y: degrees,
      xlabel: `s [${length}]`,
      ylabel: "β [°]",
      least: 0.2,
      rising: true,
    },
    {
      key: "push",
      title: "Push of the cylinder per length; orange: pull",
      x: s,
      y: push,
      xlabel: `s [${length}]`,
      ylabel: `push [${force}/${length}]`,
      zero: true,
      coloured: true,
      rising: true,
    },
    well(shape, length),
  ];
}

/* Potential and level over one rotation of beta, and the angles that occur. */
function well(shape, length) {
  const { one, problem, beta } = shape,
    scale = 1 / one.rho ** 2;
  const x = Float64Array.from({ length: ANGLES }, (_, i) => -180 + (360 * i) / (ANGLES - 1));
  const y = x.map((v) => scale * potential(problem, v / DEGREE));
  const level = scale * (problem.dbeta0 ** 2 + potential(problem, problem.beta0));
  return {
    key: "well",
    title: "Potential G; level h thick over the angles that occur",
    x,
    y,
    xlabel: "β [°]",
    ylabel: `G [1/${length}²]`,
    level,
    ranges: visited(beta),
    rising: true,
  };
}

/* Whether both axes can have one scale, and else by how much across is drawn larger. */
function scales(x, y) {
  const size = (v) => {
    let [low, high] = [Infinity, -Infinity];
    for (const one of v) {
      low = Math.min(low, one);
      high = Math.max(high, one);
    }
    return high - low;
  };
  const wide = size(x),
    tall = size(y);
  return { equal: Math.max(wide, tall) <= FLAT * Math.max(Math.min(wide, tall), 1e-9 * Math.max(wide, tall)) };
}

/* The intervals of beta along the rod, within one rotation [degrees]. */
export function visited(beta) {
  let low = Infinity,
    high = -Infinity;
  for (const b of beta) {
    low = Math.min(low, b * DEGREE);
    high = Math.max(high, b * DEGREE);
  }
  if (high - low >= 360) return [[-180, 180]];
  const shift = 360 * Math.floor((low + 180) / 360);
  low -= shift;
  high -= shift;
  return high <= 180
    ? [[low, high]]
    : [
        [low, 180],
        [-180, high - 360],
      ];
}

/* The values of a shape at s, by straight lines between its stations. */
export function valuesAt(shape, s) {
  const i = intervalOf(shape.s, s),
    j = i + 1,
    u = Math.min(Math.max((s - shape.s[i]) / (shape.s[j] - shape.s[i] || 1), 0), 1),
    found = { s };
  for (const name of ["beta", "push", "kappa", "tension", "alpha", "z"])
    found[name] = (1 - u) * shape[name][i] + u * shape[name][j];
  return found;
}

/* Where the cursor stands in a diagram for the values at s. */
export function cursorIn(key, shape, at) {
  const { one, alpha, problem } = shape,
    degrees = at.beta * DEGREE;
  if (key === "developed") return [one.rho * (at.alpha - alpha[0]), at.z];
  if (key === "beta") return [at.s, degrees];
  if (key === "push") return [at.s, at.push];
  return [degrees - 360 * Math.floor((degrees + 180) / 360), potential(problem, at.beta) / one.rho ** 2];
}
