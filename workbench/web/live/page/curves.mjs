// What the diagrams beside the rod show of a shape: plain rows of numbers with their labels.

import { potential } from "./formulas.mjs";
import { intervalOf } from "./rod_shape.mjs";
import { range } from "./range.mjs";

const DEGREE = 180 / Math.PI;
const ANGLES = 721; // points of the potential
const known = new WeakMap(); // beta -> its `visited`
const FLAT = 6; // how many times longer than wide a developed curve is drawn with equal scales

export function diagrams(shape, units) {
  const { one, s, beta, push, z, alpha } = shape,
    { length, force } = units,
    rho = one.rho;
  const across = alpha.map((v) => rho * (alpha[0] - v)), // seen from outside with z to the right
    degrees = beta.map((v) => v * DEGREE);
  return [
    {
      key: "developed",
      title: "Unrolled view, seen from outside",
      x: z,
      y: across,
      xlabel: `z [${length}]`,
      ylabel: `around [${length}]`,
      flipped: true,
      height: 170,
      least: 1e-6 * one.L,
      ...scales(across, z),
      dot: true,
      push,
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
      title: "Push of the cylinder per length",
      x: s,
      y: push,
      xlabel: `s [${length}]`,
      ylabel: `push [${force}/${length}]`,
      zero: true,
      shaded: true,
      push,
      rising: true,
    },
    one.varies ? axialForce(shape, units) : well(shape, length),
  ];
}

/* The axial force of a rod whose loads vary: there is no potential. */
const axialForce = ({ s, axial }, { length, force }) => ({
  key: "well",
  title: "Axial force along the cylinder",
  x: s,
  y: axial,
  xlabel: `s [${length}]`,
  ylabel: `FZ [${force}]`,
  rising: true,
});

/* Potential and level over one rotation of beta about the angles that occur, so that these are one range. */
function well(shape, length) {
  const { one, problem, beta } = shape,
    scale = 1 / one.rho ** 2,
    { low, high, first } = visited(beta);
  const x = Float64Array.from({ length: ANGLES }, (_, i) => first + (360 * i) / (ANGLES - 1));
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
    ranges: [high - low >= 360 ? [first, first + 360] : [low, high]],
    rising: true,
  };
}

/* Whether both axes can have one scale, and else by how much across is drawn larger. */
function scales(x, y) {
  const [wide, tall] = [x, y].map((row) => range(row)[1] - range(row)[0]);
  return { equal: Math.max(wide, tall) <= FLAT * Math.max(Math.min(wide, tall), 1e-9 * Math.max(wide, tall)) };
}

/* The angles of beta along the rod, and where the rotation about them begins [degrees]; within -180 to 180 if they are. */
export function visited(beta) {
  if (known.has(beta)) return known.get(beta);
  const [low, high] = range(beta).map((end) => end * DEGREE),
    middle = (low + high) / 2,
    isWithin = low >= -180 && high <= 180,
    found = { low, high, first: isWithin || high - low >= 360 ? -180 : middle - 180 };
  known.set(beta, found);
  return found;
}

/* The values of a shape at s, by straight lines between its stations. */
export function valuesAt(shape, s) {
  const i = intervalOf(shape.s, s),
    j = i + 1,
    u = Math.min(Math.max((s - shape.s[i]) / (shape.s[j] - shape.s[i] || 1), 0), 1),
    found = { s };
  for (const name of ["beta", "push", "kappa", "tension", "alpha", "z", ...(shape.axial ? ["axial"] : [])])
    found[name] = (1 - u) * shape[name][i] + u * shape[name][j];
  return found;
}

/* Where the cursor stands in a diagram for the values at s. */
export function cursorIn(key, shape, at) {
  const { one, alpha, problem } = shape,
    degrees = at.beta * DEGREE;
  if (key === "developed") return [at.z, one.rho * (alpha[0] - at.alpha)];
  if (key === "beta") return [at.s, degrees];
  if (key === "push") return [at.s, at.push];
  if (one.varies) return [at.s, at.axial];
  const { first } = visited(shape.beta);
  return [degrees - 360 * Math.floor((degrees - first) / 360), potential(problem, at.beta) / one.rho ** 2];
}
