/* Start problems in a browser or in Node: the compiled core as WebAssembly (rod.wasm), called from JavaScript.

   const core = await RodCore.load(bytes);
   const orbit = core.solve({lam, mu, phi, span, beta0, dbeta0}, 1e-8, times);

   The problem is dimensionless: lengths in units of rho, loads as lam = MZ rho/A, mu = M3 rho/A, phi = FZ rho^2/A.
   times rise from 0 to at most span. The orbit has beta, rate (d beta/dt), alpha, z, swirl (arrays over the times),
   error, condition, sound (whether the error is within the tolerance), halfPeriod (of beta; of an orbit that goes round
   the time of one round) and end: "turns", "goes round" or "lost". A lost orbit, next to a saddle, has no values: the
   march cannot tell where it goes. */
"use strict";
const RodCore = (() => {
  const ENDS = ["lost", "turns", "goes round"];
  const ORBIT = 256 + 16; // bytes: `orbit` in rod.c
  const LEG = 13 * 8, AHEAD = 2 * 8, BACK = AHEAD + LEG, STATUS = BACK + LEG, SOUND = STATUS + 4 * 8;

  async function load(bytes) {
    const made = await WebAssembly.instantiate(bytes, {});
    return core((made.instance || made).exports);
  }

  function core(own) {
    if (own._initialize) own._initialize();
    let room = {at: 0, bytes: 0};

    /* Memory for so many numbers; it is kept for the next call. */
    function reserve(numbers) {
      const bytes = 8 * numbers;
      if (bytes > room.bytes) {
        if (room.at) own.free(room.at);
        room = {at: own.malloc(bytes), bytes};
        if (!room.at) throw new Error(`no memory for ${bytes} bytes`);
      }
      return room.at;
    }

    function solve(problem, tol, times) {
      const n = times.length, at = reserve(6 + ORBIT / 8 + 6 * n);
      const orbit = at + 48, t = orbit + ORBIT, rows = [1, 2, 3, 4, 5].map(k => t + 8 * n * k);
      let numbers = new Float64Array(own.memory.buffer);
      numbers.set(["lam", "mu", "phi", "span", "beta0", "dbeta0"].map(name => problem[name]), at / 8);
      numbers.set(times, t / 8);
      if (own.rod_march(1n, at, tol, orbit, BigInt(n), t, ...rows, 0, 0, 0, 0, 1, 2)) throw new Error("no memory");
      numbers = new Float64Array(own.memory.buffer); // the call may have moved it
      const integers = new BigInt64Array(own.memory.buffer);
      const end = ENDS[Number(integers[(orbit + STATUS) / 8])], sound = integers[(orbit + SOUND) / 8] === 1n;
      const known = {end, sound, error: numbers[orbit / 8], condition: numbers[orbit / 8 + 1]};
      if (end === "lost") return known;
      const [beta, rate, alpha, z, swirl] = rows.map(row => numbers.slice(row / 8, row / 8 + n));
      const ahead = numbers[(orbit + AHEAD) / 8], halfPeriod = end === "turns" ? ahead + numbers[(orbit + BACK) / 8] : ahead;
      return {...known, halfPeriod, beta, rate, alpha, z, swirl};
    }

    return {solve};
  }

  return {load};
})();
if (typeof module !== "undefined") module.exports = RodCore;
