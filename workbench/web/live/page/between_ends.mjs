// A rod between two ends, next to another shape: Numerov's scheme of order 4 for beta'' = -H(beta), solved by Newton's
// method from the other shape's beta.

import { bend } from "./forces.mjs";

const LEAST = 801,
  MOST = 12_801; // nodes
const TURN = 0.08; // rad by which beta or the azimuth may change between two nodes
const NEWTON = 40,
  DONE = 2e-11; // steps; rad of the last step
const LONGEST = 0.3,
  FAR = 30; // rad of a step: a longer one is shortened; a step as long as that leads nowhere
const SAME = 0.7; // rad: a shape farther from the one before is another equilibrium

/* Stations of the shape with the end angles of a case next to a shape `near` (s, beta), or null. */
export function followed(one, near) {
  for (let n = LEAST; n <= MOST; n = 2 * n - 1) {
    const fine = relaxed(one, begun(one, near, n)),
      coarse =
        fine &&
        relaxed(
          one,
          fine.filter((_, i) => i % 2 === 0),
        );
    if (!coarse) return null;
    if (n > MOST / 2 || turned(one, fine) < TURN) return stationsOf(one, fine, coarse);
  }
  return null;
}

/* Whether a shape is far from another, at the same shares of the length. */
export function isFar(stations, near) {
  const seen = begun({ beta0: near.beta[0], betaL: near.beta[near.beta.length - 1] }, near, stations.beta.length);
  return stations.beta.some((v, i) => Math.abs(v - seen[i]) > SAME);
}

/* beta of another shape at n nodes, with the ends of this case. */
function begun(one, near, n) {
  const { s, beta } = near,
    length = s[s.length - 1],
    found = new Float64Array(n);
  for (let i = 0, j = 1; i < n; i++) {
    const where = (length * i) / (n - 1);
    while (j < s.length - 1 && s[j] < where) j++;
    found[i] = beta[j - 1] + ((beta[j] - beta[j - 1]) * (where - s[j - 1])) / (s[j] - s[j - 1]);
  }
  ((found[0] = one.beta0), (found[n - 1] = one.betaL));
  return found;
}

/* Newton's method on the tridiagonal system; null where it does not settle. */
function relaxed(one, guess) {
  const n = guess.length,
    h = one.L / (n - 1),
    w = (h * h) / 12,
    y = Float64Array.from(guess);
  const f = new Float64Array(n),
    df = new Float64Array(n),
    upper = new Float64Array(n),
    right = new Float64Array(n);
  for (let round = 0; round < NEWTON; round++) {
    for (let i = 0; i < n; i++) ((f[i] = bend(one, y[i])), (df[i] = bendRate(one, y[i])));
    upper[0] = right[0] = 0;
    for (let i = 1; i < n - 1; i++) {
      const rest = w * (f[i - 1] + 10 * f[i] + f[i + 1]) - (y[i - 1] - 2 * y[i] + y[i + 1]),
        low = 1 - w * df[i - 1];
      const pivot = -2 - 10 * w * df[i] - low * upper[i - 1];
      upper[i] = (1 - w * df[i + 1]) / pivot;
      right[i] = (rest - low * right[i - 1]) / pivot;
    }
    let most = 0;
    for (let i = n - 2; i > 0; i--) {
      right[i] -= upper[i] * right[i + 1];
      most = Math.max(most, Math.abs(right[i]));
    }
    if (!(most < FAR)) return null;
    const share = Math.min(1, LONGEST / most);
    for (let i = n - 2; i > 0; i--) y[i] += share * right[i];
    if (most < DONE * Math.max(1, (n / 1000) ** 2)) return y; // rounding grows with the nodes
  }
  return null;
}

/* d beta''/d beta, by symmetric differences of the closed form. */
function bendRate(one, beta) {
  const h = 1e-5;
  return (bend(one, beta + h) - bend(one, beta - h)) / (2 * h);
}

function turned(one, beta) {
  const h = one.L / (beta.length - 1);
  let most = 0;
  for (let i = 1; i < beta.length; i++)
    most = Math.max(most, Math.abs(beta[i] - beta[i - 1]), (h * Math.abs(Math.sin(beta[i]))) / one.rho);
  return most;
}

/* beta', alpha and z from beta, all of order 4; the error is that of beta, by half as many nodes. */
function stationsOf(one, beta, coarse) {
  const n = beta.length,
    h = one.L / (n - 1),
    s = new Float64Array(n),
    dbeta = new Float64Array(n),
    alpha = new Float64Array(n),
    z = new Float64Array(n);
  const f = (i) => bend(one, beta[i]);
  for (let i = 0; i < n; i++) {
    s[i] = h * i;
    if (i > 0 && i < n - 1) dbeta[i] = (beta[i + 1] - beta[i - 1]) / (2 * h) - (h / 12) * (f(i + 1) - f(i - 1));
  }
  ((dbeta[0] = atEnd(beta, f, h, 0, 1)), (dbeta[n - 1] = -atEnd(beta, f, h, n - 1, -1)));
  alpha[0] = one.alpha;
  for (let i = 1; i < n; i++) {
    const [s0, s1, c0, c1] = [Math.sin(beta[i - 1]), Math.sin(beta[i]), Math.cos(beta[i - 1]), Math.cos(beta[i])];
    alpha[i] = alpha[i - 1] + ((h / 2) * (s0 + s1) + ((h * h) / 12) * (c0 * dbeta[i - 1] - c1 * dbeta[i])) / one.rho;
    z[i] = z[i - 1] + (h / 2) * (c0 + c1) + ((h * h) / 12) * (s1 * dbeta[i] - s0 * dbeta[i - 1]);
  }
  let error = 0;
  for (let i = 0; i < coarse.length; i++) error = Math.max(error, Math.abs(coarse[i] - beta[2 * i]));
  return { s, beta, dbeta, alpha, z, error };
}

/* The rate of beta at an end, toward its neighbours, of order 4: from beta there and beta'' at four nodes. */
function atEnd(beta, f, h, i, way) {
  return (
    (beta[i + way] - beta[i]) / h -
    (h / 360) * (97 * f(i) + 114 * f(i + way) - 39 * f(i + 2 * way) + 8 * f(i + 3 * way))
  );
}
