/* Rods under dead loads in a browser or in Node: the compiled core as WebAssembly (rod.wasm), called from JavaScript.

   const core = await RodCore.load(bytes);
   const orbit = core.solve({lam, mu, phi, span, beta0, dbeta0}, 1e-8, times);
   const rod = core.between({lam, mu, phi, span, beta0, betaL}, {t, beta, rate});

   Problems are dimensionless: lengths in units of rho, loads as lam = MZ rho/A, mu = M3 rho/A, phi = FZ rho^2/A.

   `solve` gives a start problem at times that rise from 0 to at most span: beta, rate (d beta/dt), alpha, z (arrays over
   the times), error, condition, sound (whether the error is within the tolerance) and end: "turns" or "goes round", with
   swirl (an array) and halfPeriod (of beta; of an orbit that goes round the time of one round); "marched" along the
   whole rod, next to a saddle, where half periods cannot be told; or "lost", without values.

   `between` gives the rod between two end angles that Newton's method reaches from a guess at nodes, evenly spaced times t
   from 0 to span, or null; `stretches(problem, beta)` says between how many nodes Newton's method needs such a shape. It
   has error (of beta), nodes t with their beta, rate, alpha and z, and at(times): these at other times. `through(problem, nodes)` is such a function for nodes that are
   known, `forces(problem, sign, beta, rate)` gives push, curvature and tension, `measure(problem, sign, error, rod)` the
   integrals and extremes along a rod, and `landmarks(problem, sign, rod, most)` where it has them, all in units of A and
   rho. `crossings(s, points, near, apart, most)` tells where any curve comes near itself. */
"use strict";
const RodCore = (() => {
  const ENDS = ["lost", "turns", "goes round"];
  const ORBIT = 35, LEG = 13, AHEAD = 2, BACK = AHEAD + LEG, STATUS = BACK + LEG; // `orbit` in rod.c
  const STATES = 8, PARAMETERS = 7; // of weight_friction.c, with the states beta, rate, alpha, lam - mu, phi, mu, t - z
  const ROWS = 8; // of a density: `rod_densities`
  const SERIES = 1e-11, FINE = 1e-7; // error that a series of a density may have, relative: measured, and of landmarks
  const BY_ANGLE = 2, ORDER = 20; // columns of derivatives; order of their series
  const NEWTON = {columns: BY_ANGLE, deep: 13}; // for Newton's method
  const LEFT_OUT = 1e-17, ROUGH = 1e-12; // of the scales, by a step of a march; by one for Newton's method
  const SAFETY = 3, ROUNDING = 2e-16, SHORTER = 0.7; // of estimated errors; the steps of a march that estimates one
  const UNTOLD = 1e12, TOO_LONG = 5e4; // a condition number that leaves no digits; the most lengths of a whole march
  const ROUNDS = 40, LONGEST = 0.3, FAR = 30, CLOSE = 1e-7; // of Newton's method; rad; the last step is squared once more

  async function load(bytes) {
    const made = await WebAssembly.instantiate(bytes, {});
    return core((made.instance || made).exports);
  }

  function core(own) {
    if (own._initialize) own._initialize();
    let memory = {at: 0, bytes: 0};
    /* The names of densities and of measured numbers, by their places: the table of measured.h. */
    const bytes = new Uint8Array(own.memory.buffer, own.rod_measured());
    const [first, ...rows] = new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0))).split("|");
    const DENSITIES = first.trim().split(" "), MEASURED = rows.map(row => row.split(" ")[1]);

    /* Room for so many numbers that a call fills: they are there until the next one. rows: how many rows of them there are,
       of which the core takes a table of pointers. */
    const room = (size, rows = 0) => ({
      length: rows / 2 + size * (rows || 1),
      at: 0,
      numbers(count = size, from = 0) {
        return new Float64Array(own.memory.buffer, this.at + 4 * rows + 8 * from, count).slice();
      },
      integers(count = size, from = 0) {
        return Array.from(new BigInt64Array(own.memory.buffer, this.at + 8 * from, count), Number);
      },
      point() {
        new Uint32Array(own.memory.buffer, this.at, rows).forEach((_, k, table) => (table[k] = this.at + 4 * rows + 8 * size * k));
      },
    });

    /* What a function of the core returns. Arrays are copied to it; of them and of rooms it gets the place, in memory that is
       kept for the next call. */
    function call(name, ...given) {
      const bytes = 8 * given.reduce((sum, part) => sum + (part.length || 0), 0);
      if (bytes > memory.bytes) {
        if (memory.at) own.free(memory.at);
        memory = {at: own.malloc(bytes), bytes};
        if (!memory.at) throw new Error(`no memory for ${bytes} bytes`);
      }
      let next = memory.at;
      const places = given.map(part => part.length === undefined ? part : (next += 8 * part.length) - 8 * part.length);
      given.forEach((part, k) => {
        const kind = Array.isArray(part) ? Float64Array : part.constructor;
        if (part.point) part.at = places[k], part.point();
        else if (part.length) new kind(own.memory.buffer, places[k], part.length).set(part);
      });
      return own[name](...places);
    }

    function solve(problem, tol, times) {
      const n = times.length, orbit = room(ORBIT), rows = room(4 * n), swirled = room(n);
      const numbers = ["lam", "mu", "phi", "span", "beta0", "dbeta0"].map(name => problem[name]);
      if (call("rod_march", 0n, 1n, 1n, numbers, tol, orbit, BigInt(n), times, rows, swirled, 0, 1n, 2n)) throw new Error("no memory");
      const known = orbit.numbers(STATUS), [status, , , , sound] = orbit.integers(5, STATUS), end = ENDS[status];
      const facts = {end, sound: sound === 1, error: known[0], condition: known[1]};
      if (end === "lost") return whole(problem, tol, times) || facts;
      const [beta, rate, alpha, z] = [0, 1, 2, 3].map(k => rows.numbers(n, k * n)), swirl = swirled.numbers();
      const halfPeriod = end === "turns" ? known[AHEAD] + known[BACK] : known[AHEAD];
      return {...facts, halfPeriod, beta, rate, alpha, z, swirl};
    }

    /* March stretches of a rod under dead loads, whose states are those of `begin` and the loads of the problem.

       begin: {beta, rate}, (n,) each. lengths: (n,). how: columns (0 or BY_ANGLE) of derivatives by beta and rate, and
       the order `deep` of their series; judged: whether errors are estimated instead; shorter: a factor of the steps;
       first (n + 1,): the numbers of the stretches' first stations in `stations`, times from their begins. */
    function march(problem, begin, lengths, how) {
      const {columns = 0, deep = ORDER, judged = false, shorter = 1, leftOut = LEFT_OUT, first = null, stations = []} = how;
      const n = lengths.length, {lam, mu, phi} = problem, state = new Float64Array(STATES * n);
      const rod = [1, 0, 0, 0, 0, 0, 1], goal = scaleOf(problem).map(size => size * leftOut); // no weight, no friction
      for (let i = 0, at = 0; i < n; i++, at += STATES) {
        state[at] = begin.beta[i], state[at + 1] = begin.rate[i], state[at + 3] = lam - mu, state[at + 4] = phi;
        state[at + 5] = mu;
      }
      const end = room(STATES * n), derived = room(STATES * n * columns), growth = room(6 * n), errors = room(2 * n);
      const rows = room(stations.length, STATES), from = first ? BigInt64Array.from(first, BigInt) : 0;
      call("rod_loaded", 0n, BigInt(n), rod, goal, 1n, shorter, state, lengths, BigInt(columns), BigInt(deep), end,
           columns ? derived : 0, columns ? growth : 0, judged ? errors : 0, from, stations, rows, 1n, room(n), 0n, 2n);
      const read = first && [0, 1, 2, 6].map(k => rows.numbers(stations.length, k * stations.length));
      if (judged) return {growth: growth.numbers(), errors: errors.numbers(), read};
      return first ? {read} : {end: end.numbers(), derived: derived.numbers()};
    }

    /* A start problem by one march along the whole rod; or null. */
    function whole(problem, tol, times) {
      const scale = scaleOf(problem), {span, beta0, dbeta0} = problem, n = times.length;
      if (!(span * scale[5] < TOO_LONG)) return null;
      const how = {columns: BY_ANGLE, judged: true, first: [0, n], stations: times};
      const {growth, errors, read} = march(problem, {beta: [beta0], rate: [dbeta0]}, [span], how);
      const condition = Math.max(1, growth[0], Math.sqrt(Math.abs(dbeta0) + scale[4]) * growth[1]);
      if (!(condition < UNTOLD)) return null;
      const off = Math.max(errors[0], errors[1] / Math.max(1, span));
      const error = SAFETY * off + ROUNDING * (condition + span * scale[1]), [beta, rate, alpha, short] = read;
      return {end: "marched", sound: error <= tol, error, condition, beta, rate, alpha, z: short.map((u, i) => times[i] - u)};
    }

    function between(problem, {t, beta, rate}) {
      const {span, beta0, betaL} = problem, n = t.length - 1, lengths = new Float64Array(n).fill(span / n);
      if (!(n < TOO_LONG)) return null;
      beta[0] = beta0, beta[n] = betaL;
      for (let round = 0, size = Infinity; !(size <= CLOSE); round++) {
        const change = correction({beta, rate}, march(problem, {beta, rate}, lengths, {...NEWTON, leftOut: ROUGH}));
        size = largest(change.beta);
        if (!(size < FAR) || round === ROUNDS) return null;
        const share = Math.min(1, LONGEST / size);
        for (let i = 0; i <= n; i++) beta[i] += share * change.beta[i], rate[i] += share * change.rate[i];
      }
      const last = march(problem, {beta, rate}, lengths, {...NEWTON, shorter: SHORTER});
      const left = correction({beta, rate}, last), error = SAFETY * largest(left.beta) + ROUNDING * n;
      const alpha = new Float64Array(n + 1), z = new Float64Array(n + 1);
      for (let i = 0; i <= n; i++) {
        beta[i] += left.beta[i], rate[i] += left.rate[i];
        if (i === n) break;
        alpha[i + 1] = alpha[i] + last.end[STATES * i + 2];
        z[i + 1] = z[i] + lengths[i] - last.end[STATES * i + 6];
      }
      const nodes = {t, beta, rate, alpha, z};
      return {...nodes, error, at: through(problem, nodes)};
    }

    /* beta, rate, alpha and z at times that rise, from those at nodes: the stretches with such times are marched. */
    function readings(problem, nodes, lengths, times) {
      const n = lengths.length, used = [], first = [], stations = new Float64Array(times.length);
      for (let k = 0, i = 0; k < times.length; k++) {
        while (i < n - 1 && times[k] > nodes.t[i + 1]) i++;
        if (used[used.length - 1] !== i) used.push(i), first.push(k);
        stations[k] = times[k] - nodes.t[i];
      }
      const taken = row => used.map(i => row[i]), begin = {beta: taken(nodes.beta), rate: taken(nodes.rate)};
      first.push(times.length);
      const [beta, rate, alpha, z] = march(problem, begin, taken(lengths), {first, stations}).read;
      used.forEach((i, j) => {
        for (let k = first[j]; k < first[j + 1]; k++) alpha[k] += nodes.alpha[i], z[k] = nodes.z[i] + stations[k] - z[k];
      });
      return {beta, rate, alpha, z};
    }

    /* beta, rate, alpha and z between nodes, {t, beta, rate, alpha, z}: a function of times that rise. Nodes nearer to each
       other than the length on which the shape changes are left out. */
    function through(problem, all) {
      const apart = 0.5 / swiftness(problem, all.beta), last = all.t.length - 1, kept = [0];
      for (let i = 1; i < last; i++) if (all.t[i + 1] - all.t[kept[kept.length - 1]] > apart) kept.push(i);
      if (last) kept.push(last);
      const nodes = {};
      for (const name of ["t", "beta", "rate", "alpha", "z"]) nodes[name] = kept.map(i => all[name][i]);
      const lengths = Float64Array.from({length: nodes.t.length - 1}, (_, i) => nodes.t[i + 1] - nodes.t[i]);
      return times => readings(problem, nodes, lengths, times);
    }

    /* Push, curvature and tension, [1/rho], at as many points as beta and rate; sign: 1 outside the cylinder, -1 inside. */
    function forces({lam, mu, phi}, sign, beta, rate) {
      const n = beta.length, out = room(ROWS * n);
      const values = name => {
        call("rod_densities", DENSITIES.indexOf(name), 1n, BigInt(n), [lam, mu, phi, sign], beta, rate, out);
        return out.numbers(n);
      };
      return {push: values("outward"), curvature: values("curvature"), tension: values("tension")};
    }

    /* A function of the core of a rod that is known at times that rise, {t, beta, rate}; error: of beta. more, last: what it
       takes before and after its memory. */
    function along(name, {lam, mu, phi}, sign, error, {t, beta, rate}, more, last) {
      const n = t.length, given = [lam, mu, phi, sign, error, t[n - 1] - t[0]];
      return Number(call(name, BigInt(n), given, t, beta, rate, more, room(18 * n + 2), ...last));
    }

    /* What is measured along it: the numbers of `MEASURED`. */
    function measure(problem, sign, error, rod) {
      const out = room(2 * MEASURED.length);
      if (along("rod_measure_stations", problem, sign, error, rod, SERIES, [out])) throw new Error("no memory");
      const values = out.numbers();
      return Object.fromEntries(MEASURED.map((name, k) => [name, values[k]]));
    }

    /* The times at which its angle, curvature and push are largest or least, or its push changes sign: at most so many. */
    function landmarks(problem, sign, rod, most) {
      const out = room(most), count = along("rod_landmarks_of_stations", problem, sign, 0, rod, FINE, [BigInt(most), out]);
      if (count < 0) throw new Error("no memory");
      return out.numbers(count);
    }

    /* The places where a curve at points (x, y, z, x, ...) comes nearer to itself than `near`, at points more than `apart`
       apart along it: of each the numbers of the nearest two. s: along the curve. */
    function crossings(s, points, near, apart, most) {
      const pairs = room(2 * most);
      const count = Number(call("rod_crossings", BigInt(s.length), s, points, near, apart, Infinity, BigInt(most), pairs));
      if (count < 0) throw new Error("no memory");
      const found = pairs.integers(2 * Math.min(count, most));
      return found.filter((_, k) => k % 2).map((j, k) => [j, found[2 * k]]);
    }

    return {solve, between, stretches, through, forces, measure, landmarks, crossings};
  }

  /* The sizes of the states, by which the errors of steps are judged; the sixth is 1 over the length on which the shape
     changes. */
  function scaleOf({lam, mu, phi, span, beta0, dbeta0 = 0}) {
    const rate = Math.sqrt(Math.abs(phi) + mu ** 2 + Math.cbrt((lam - mu) ** 2) + 1 / span ** 2);
    const size = Math.min(1, Math.max(rate, Math.abs(beta0)));
    return [size, Math.max(size * rate, Math.abs(dbeta0)), 1, size * rate ** 2, rate ** 2, rate, size ** 2 / rate, 1];
  }

  /* 1 over the length on which a shape with these angles changes. */
  const swiftness = (problem, beta) => Math.hypot(scaleOf(problem)[5], Math.SQRT2 * largest(beta.map(Math.sin)));

  /* Into how many stretches Newton's method cuts the rod of a problem, of a shape with these angles. */
  const stretches = (problem, beta) => Math.min(Math.max(8, Math.ceil(problem.span * swiftness(problem, beta))), TOO_LONG);

  /* Newton's correction of nodes whose first and last beta are given. The stretches turn a change (x, v) of a node into
     (a x + b v, c x + d v) with a d - b c = 1, so that v follows from x at both ends, and x solves a tridiagonal system. */
  function correction({beta, rate}, {end, derived}) {
    const n = beta.length - 1, x = new Float64Array(n + 1), v = new Float64Array(n + 1), upper = new Float64Array(n + 1);
    const by = (i, row, column) => derived[(STATES * i + row) * BY_ANGLE + column];
    const off = i => end[STATES * i] - beta[i + 1], bent = i => end[STATES * i + 1] - rate[i + 1];
    for (let i = 1; i < n; i++) {
      const before = by(i - 1, 0, 1), after = by(i, 0, 1), far = by(i - 1, 1, 1) / before;
      const right = off(i) / after - far * off(i - 1) + bent(i - 1);
      const pivot = -by(i, 0, 0) / after - far - upper[i - 1] / before;
      upper[i] = 1 / after / pivot;
      x[i] = (right - x[i - 1] / before) / pivot;
    }
    for (let i = n - 1; i > 0; i--) x[i] -= upper[i] * x[i + 1];
    for (let i = 0; i < n; i++) v[i] = (x[i + 1] - off(i) - by(i, 0, 0) * x[i]) / by(i, 0, 1);
    v[n] = bent(n - 1) + by(n - 1, 1, 0) * x[n - 1] + by(n - 1, 1, 1) * v[n - 1];
    return {beta: x, rate: v};
  }

  const largest = values => values.reduce((most, v) => v !== v ? NaN : Math.max(most, Math.abs(v)), 0);

  return {load};
})();
if (typeof module !== "undefined") module.exports = RodCore;
