// The shape of a rod: solved by the compiled core in this page, or read between the stations that the server solved.

import { Refused, reduced } from "./rod_case.mjs";

const TOL = 1e-8;
const LEAST = 301,
  MOST = 8001; // stations of a shape
const A_HALF_PERIOD = 40; // stations that each half period of beta has at least
const TURN = 0.09; // rad by which beta or the azimuth may change between two stations
const THINNED = 3; // stations of which one is enough to find landmarks between them
const ROUGHER = 2.7; // times these distances, where MOST stations are too few; a still longer rod is shown in part
const SERVED = ["beta", "dbeta", "alpha", "z", "push", "kappa", "tension"], // of a rod that the server solves
  VARYING = ["axial"],
  OFF_WALL = ["x", "y", "tilt", "gap"]; // and of one that may leave the cylinder
const LARGEST = 1e12; // a number of the dimensionless problem
const SAME = 0.7; // rad: a shape farther from the one before is another equilibrium
const UNFIT = "These numbers are too large or too small to compute with.";
export const LOST = "The shape was not found: the orbit runs too near an unstable equilibrium of β.";

/* The shape of a start problem. Throws Refused where it was not found. */
export function marched(core, one, dbeta0 = one.dbeta) {
  const problem = fitting(reduced(one, dbeta0)),
    orbit = (times) => core.solve(problem, TOL, times),
    tried = orbit(evenly(problem.span, LEAST));
  if (tried.end === "lost") throw new Refused(LOST);
  const { shown, n, wanted } = stationsFor(problem.span, tried);
  const at = along(core, one, problem, orbit);
  const s = evenly(one.L * shown, n),
    halfPeriod = tried.end === "turns" ? tried.halfPeriod * one.rho : tried.end === "marched" ? undefined : 0;
  return made(core, one, at, s, {
    error: tried.error,
    condition: tried.condition,
    sound: tried.sound,
    halfPeriod,
    shown,
    wanted,
    problem,
  });
}

/* The problem, where its numbers can be computed with; else throws Refused. */
function fitting(problem) {
  if (!Object.values(problem).every((v) => Math.abs(v) < LARGEST) || !(problem.span > 1e-12)) throw new Refused(UNFIT);
  return problem;
}

/* The shape at stations that are known: s, beta, dbeta, alpha, z. Between them it is marched; of a rod that the server
   solves it has straight lines, also of its other rows. */
export function interpolated(core, one, stations, facts) {
  const { s, beta, alpha } = stations,
    length = s[s.length - 1],
    problem = reduced(one, stations.dbeta[0]);
  const names = [...SERVED, ...(one.leaves ? OFF_WALL : VARYING)],
    lines = (where) => Object.fromEntries(names.map((name) => [name, onLines(s, stations[name], where)]));
  const at = one.varies
    ? (where) => placed(one, { s: where, ...lines(where) })
    : along(core, one, problem, core.through(problem, timed(one, stations)));
  const n = one.leaves ? 0 : stationsFor(length / one.rho, { beta, alpha }).n;
  return made(core, one, at, evenly(length, Math.max(n, s.length)), { ...facts, problem });
}

/* Dimensionless rows of a shape. */
export const timed = ({ rho, alpha = 0 }, rows) => ({
  t: rows.s.map((v) => v / rho),
  beta: rows.beta,
  rate: rows.dbeta.map((v) => v * rho),
  alpha: rows.alpha?.map((v) => v - alpha),
  z: rows.z?.map((v) => v / rho),
});

/* The shape between two ends that a slider leads to from the shape before, in one step or in four; or null. near: its
   case, s, beta and dbeta. */
export function moved(core, one, near) {
  const begun = timed(near.one, near),
    [from, to] = [near.one, one].map((each) => ({ ...fitting(reduced(each, 0)), betaL: each.betaL }));
  let rod = nextTo(core, to, begun);
  if (!rod || isFar(rod, begun)) {
    rod = begun;
    for (const share of [0.25, 0.5, 0.75, 1]) rod = rod && nextTo(core, partWay(from, to, share), dense(rod), 2);
  }
  return rod && !isFar(rod, begun) ? joined(core, one, rod) : null;
}

/* The rod of a problem next to another one, or null; nodes: how many it has, beside the usual number. */
const nextTo = (core, problem, { t, beta, rate }, nodes = 1) => {
  const times = evenly(problem.span, nodes * core.stretches(problem, beta) + 1),
    before = times.map((v) => (v * t[t.length - 1]) / problem.span);
  return core.between(problem, { t: times, beta: onLines(t, beta, before), rate: onLines(t, rate, before) });
};

/* The problem a share of the way from one to another. */
const partWay = (from, to, share) =>
  Object.fromEntries(Object.keys(to).map((name) => [name, (1 - share) * from[name] + share * to[name]]));

/* A rod at so many times that straight lines join them. */
function dense(rod) {
  const t = evenly(rod.t[rod.t.length - 1], LEAST);
  return rod.at ? { t, ...rod.at(t) } : rod;
}

/* The shape of a rod that Newton's method found. */
function joined(core, one, rod) {
  const { error } = rod,
    { n } = stationsFor(one.L / one.rho, rod),
    problem = reduced(one, rod.rate[0] / one.rho);
  const facts = { error, condition: NaN, sound: error < 1e-6, shown: 1, problem };
  return made(core, one, along(core, one, problem, rod.at), evenly(one.L, n), facts);
}

/* Whether a rod is far from another, at the same shares of the length. */
function isFar({ t, beta }, near) {
  const share = near.t[near.t.length - 1] / t[t.length - 1],
    before = onLines(
      near.t,
      near.beta,
      t.map((v) => v * share),
    );
  return beta.some((v, i) => Math.abs(v - before[i]) > SAME);
}

/* So many numbers from 0 to an end. */
export function evenly(end, n) {
  const found = new Float64Array(n);
  for (let i = 0; i < n; i++) found[i] = (end * i) / (n - 1);
  return found;
}

/* How many stations the shape has, which share of the rod it can show, and how many stations the numbers of that share
   need; tried: the shape at fewer stations. */
function stationsFor(span, { beta, alpha, halfPeriod = 0 }) {
  let most = 0;
  for (let i = 1; i < beta.length; i++)
    most = Math.max(most, Math.abs(beta[i] - beta[i - 1]), Math.abs(alpha[i] - alpha[i - 1]));
  const needed = Math.max(LEAST, halfPeriod ? (A_HALF_PERIOD * span) / halfPeriod : 0, (beta.length * most) / TURN);
  const shown = Math.min(1, (ROUGHER * MOST) / needed),
    wanted = 2 * Math.ceil((shown * needed) / 2) + 1;
  return { shown, wanted, n: Math.min(MOST, wanted) };
}

/* The arrays of a rod as a function of s, from those of its orbit as a function of time. */
function along(core, one, problem, orbit) {
  const { A, rho } = one,
    times = (row, scale) => row.map((v) => scale * v);
  return (s) => {
    const { beta, rate, alpha, z } = orbit(s.map((v) => v / rho)),
      { push, curvature, tension } = core.forces(problem, one.sign, beta, rate);
    return placed(one, {
      s,
      beta,
      dbeta: times(rate, 1 / rho),
      alpha: alpha.map((v) => one.alpha + v),
      z: times(z, rho),
      push: times(push, A / rho ** 3),
      kappa: times(curvature, 1 / rho),
      tension: times(tension, A / rho ** 2),
    });
  };
}

/* The rows of a rod with its places x, y and the tilt of its tangent out of the tangent plane: those of a rod on the wall
   unless the rows have them. */
const placed = ({ rho }, rows) => ({
  x: rows.alpha.map((v) => rho * Math.cos(v)),
  y: rows.alpha.map((v) => rho * Math.sin(v)),
  tilt: new Float64Array(rows.s.length),
  ...rows,
});

/* The arrays over s, with the extremes of beta, push and curvature and the zeros of the push as further stations, which are
   `marks` alone. */
function made(core, one, at, s, facts) {
  const even = at(s);
  if (one.varies) return { core, one, at, even, ...even, ...facts };
  const marks = at(landmarksOf(core, one, even, facts.problem));
  return { core, one, at, even, marks, ...merged(even, marks), ...facts };
}

/* Where they are; those of a rod whose loads vary are not known between its stations. */
function landmarksOf(core, one, even, problem) {
  const few = timed(one, every(even, THINNED));
  return core.landmarks(problem, one.sign, few, 2 * even.s.length).map((t) => t * one.rho).sort();
}

/* The point of a centreline at a station; squeeze: the factor by which a scene is compressed. */
export const pointAt = ({ x, y, z }, i, squeeze = 1) => [x[i], y[i], squeeze * z[i]];

/* Every so many of the stations and the last. */
export const every = (rows, step) =>
  Object.fromEntries(
    Object.entries(rows).map(([name, row]) => [name, row.filter((_, i) => i % step === 0 || i === row.length - 1)]),
  );

/* Two sets of arrays over s as one, in order of s. */
export function merged(first, second) {
  const n = first.s.length,
    m = second.s.length,
    order = new Int32Array(n + m),
    all = {};
  for (let i = 0, j = 0; i < n || j < m;) {
    const mine = j >= m || (i < n && first.s[i] <= second.s[j]);
    order[i + j] = mine ? i : n + j;
    if (mine) i++;
    else j++;
  }
  for (const name of Object.keys(first)) {
    const [one, other] = [first[name], second[name]],
      row = (all[name] = new Float64Array(n + m));
    for (let k = 0; k < n + m; k++) row[k] = order[k] < n ? one[order[k]] : other[order[k] - n];
  }
  return all;
}

/* A row of values over x at other places between its ends, by straight lines; x and the places rise. */
export function onLines(x, row, places) {
  const values = new Float64Array(places.length);
  for (let k = 0, i = intervalOf(x, places[0]); k < places.length; k++) {
    while (i < x.length - 2 && x[i + 1] <= places[k]) i++;
    const share = (places[k] - x[i]) / (x[i + 1] - x[i] || 1);
    values[k] = row[i] + (row[i + 1] - row[i]) * Math.min(Math.max(share, 0), 1);
  }
  return values;
}

/* The number of the last station at or before s, but never that of the last of all. */
function intervalOf(stations, s) {
  let low = 0,
    high = stations.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (stations[middle] <= s) low = middle;
    else high = middle;
  }
  return low;
}
