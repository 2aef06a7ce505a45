// Start problems beside an unstable equilibrium of beta, where the core's march has no values: Dormand and Prince's
// Runge-Kutta method of order 5, together with the two solutions of the linearised equation for the condition number.

const GOAL = 1e-11,
  MOST_STEPS = 60_000,
  SAFETY = 10;
const A = [
  [],
  [1 / 5],
  [3 / 40, 9 / 40],
  [44 / 45, -56 / 15, 32 / 9],
  [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729],
  [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656],
  [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
];
const OFF = [71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40]; // fifth order less fourth
const N = 8; // beta, beta_t, alpha, z, and two changes of (beta, beta_t)

/* The orbit at times that rise, as RodCore's solve gives it; null where it takes too many steps. */
export function integrated(problem, times) {
  const n = times.length,
    out = { beta: new Float64Array(n), rate: new Float64Array(n), alpha: new Float64Array(n), z: new Float64Array(n) };
  const y = Float64Array.of(problem.beta0, problem.dbeta0, 0, 0, 1, 0, 0, 1),
    slopes = A.map(() => new Float64Array(N));
  const weight = Math.max(1, Math.abs(problem.dbeta0)),
    trial = new Float64Array(N);
  let t = 0,
    h = 0.01,
    condition = 1,
    steps = 0;
  for (let k = 0; k < n; k++) {
    while (times[k] - t > 1e-14 * times[k]) {
      if (++steps > MOST_STEPS || !(condition < 1e12)) return null;
      const ends = h >= times[k] - t,
        step = ends ? times[k] - t : h,
        off = tried(problem, y, step, slopes, trial);
      const factor = Math.min(5, Math.max(0.2, 0.9 * (GOAL / Math.max(off, 1e-300)) ** 0.2));
      if (off <= GOAL) {
        t = ends ? times[k] : t + step;
        y.set(trial);
        condition = Math.max(condition, Math.abs(y[4]), weight * Math.abs(y[6]));
      }
      if (off > GOAL || !ends || step * factor < h) h = step * factor;
    }
    [out.beta[k], out.rate[k], out.alpha[k], out.z[k]] = y;
  }
  const error = SAFETY * GOAL * Math.max(1, steps) * condition;
  return { ...out, end: "integrated", condition, error, sound: error < 1e-8 };
}

/* One step from y to `trial`; its estimated error. */
function tried(problem, y, h, slopes, trial) {
  for (let stage = 0; stage < A.length; stage++) {
    for (let i = 0; i < N; i++) {
      let sum = 0;
      for (let j = 0; j < stage; j++) sum += A[stage][j] * slopes[j][i];
      trial[i] = y[i] + h * sum;
    }
    slope(problem, trial, slopes[stage]);
  }
  let off = 0;
  for (let i = 0; i < 4; i++) {
    let sum = 0;
    for (let j = 0; j < OFF.length; j++) sum += OFF[j] * slopes[j][i];
    off = Math.max(off, Math.abs(h * sum));
  }
  return off;
}

function slope({ lam, mu, phi }, y, out) {
  const s = Math.sin(y[0]),
    c = Math.cos(y[0]),
    s2 = s * s;
  const rate = -lam * s + 4 * mu * s * c - phi * c - 2 * s2 * (3 * c * c - s2); // H'(beta)
  out[0] = y[1];
  out[1] = (phi + 2 * c * s2) * s - lam * c + mu * (c * c - s2);
  out[2] = s;
  out[3] = c;
  ((out[4] = y[5]), (out[5] = -rate * y[4]));
  ((out[6] = y[7]), (out[7] = -rate * y[6]));
}
