// A case from the state of the page: validation, and the solver's formulas of loads and of the dimensionless problem.

import { ANGLES, BENDING, DIRECT, ELASTIC, HELD, LOADS, RANGES, RHO, SIDES, TORSION, TWISTS, problemOf } from "./formulas.mjs";

export const DEGREE = Math.PI / 180;
const OF_SECTION = [...ELASTIC, "inner_radius"]; // not beside DIRECT
const PRINTED = ["E", "nu", "R", "a", "L", "beta", "dbeta", "dgamma", "F1", "F3"]; // by Table 1
const START = ["beta", "dbeta", "F1", "F2", "F3", "dgamma", "M3"],
  ENDS = Object.keys(HELD); // or what is held in place of each
const OUTSIDE = ["weight", "inclination", "friction"]; // what makes the loads vary along the rod
const POSITIVE = [...Object.keys(RANGES).filter((name) => RANGES[name].low === 0 && !RANGES[name].closed), "weight"],
  OPTIONAL = ["F2", "F3", ...ENDS.filter((name) => !ANGLES.includes(name))],
  OFF_WALL = ["radius0", "radiusL", "tilt0", "M20", "tiltL", "M2L"]; // of the ends of a rod that may leave the cylinder
const AT_START = { beta: "beta0", dbeta: "dbeta0" }; // fields that are the value of another quantity at s = 0

/* An invalid value: a sentence for the one who typed it, and the field ("" if it is about none). */
export class Refused extends Error {
  constructor(sentence, field = "") {
    super(sentence);
    this.sentence = sentence;
    this.field = field;
  }
}

export const quantityOf = (name) => AT_START[name] || name;
const KINDS = { nu: "ratio", inner_radius: "bore", radius0: "bore", radiusL: "bore", inclination: "tilt", friction: "share" };
export const isDegrees = (name) => ["angle", "tilt"].includes(kindOf(name));
export const kindOf = (name) =>
  POSITIVE.includes(name) ? "positive" : KINDS[name] || (ANGLES.includes(name) ? "angle" : "signed");
export const isEnds = (state) => state.reading === undefined && ("betaL" in state.base || "M1L" in state.base);
/* Whether the cylinder only pushes, so that the rod may leave it. */
export const leaves = ({ base, let_go }) => Boolean(let_go) || base.contact === "unilateral";
/* Whether the loads vary along the rod, or it may leave the cylinder: then the server solves it. */
export const varies = (state) => leaves(state) || OUTSIDE.some((name) => state.base[name] !== undefined);

/* Let the cylinder of a state only push, or hold the rod on. Between two ends their loads stay; of a start problem both
   ends stay as they are. */
export function setContact(state, pushes) {
  delete state.let_go;
  for (const name of ["contact", ...OFF_WALL]) delete state.base[name];
  if (pushes) Object.assign(...(isEnds(state) ? [state.base, { contact: "unilateral" }] : [state, { let_go: true }]));
  if (pushes && isEnds(state)) delete state.equilibrium;
}

/* Whether data of a link is a state at all; its numbers are checked by `caseOf`. */
export function isState({ base, units, reading, equilibrium, title = "" }, readings) {
  const isText = (one) => typeof one === "string";
  if (!base || !units || !isText(units.length) || !isText(units.force) || !isText(title)) return false;
  if (reading !== undefined && !Object.hasOwn(readings, reading)) return false;
  if (equilibrium && !Object.values(equilibrium).every(Number.isFinite)) return false;
  return (base.side || "outside") in SIDES && (base.stiffness || "solid") in BENDING;
}

/* The names of the numbers of a state that the page shows, in order. */
export function fieldNames(state) {
  if (state.reading !== undefined) return PRINTED;
  const { base } = state,
    given = isEnds(state)
      ? ENDS.map((name) => (HELD[name] in base ? HELD[name] : name))
      : START.filter((name) => !TWISTS.includes(name) || name in base);
  return [...rodNames(base), "R", ...[...OUTSIDE, ...OFF_WALL].filter((name) => name in base), ...given];
}

/* The numbers of the rod of a state: EI and GJ, or E and nu, and the inner radius of a tube. */
function rodNames(base) {
  if (DIRECT.some((name) => name in base)) return [...DIRECT, "a", "L"];
  return ["E", "nu", "a", ...("inner_radius" in base ? ["inner_radius"] : []), "L"];
}

/* What a reading of Table 1 makes of a printed value, in words; "" where the value is used as it is. */
export function meaning(state, name) {
  if (state.reading === undefined) return "";
  const [twist, load] = state.reading.split("/");
  if (twist === "force-first" && name === "dgamma") return "Not used: in this reading F₁ gives the twist.";
  if (twist === "twist-first" && name === "F1") return "Not used: in this reading γ₀′ gives the twist.";
  if (twist === "shear" && name === "F1") return "In this reading the shear force F₂.";
  if (name === "F3") return load === "tension" ? "In this reading a tension." : "In this reading a compression.";
  return "";
}

export const isUnused = (state, name) => meaning(state, name).startsWith("Not used");

/* The case of a state, every number checked. Throws Refused. symbols: name -> letter, for the sentences. */
export function caseOf(state, symbols) {
  const values = {},
    { base } = state;
  if (DIRECT.some((name) => name in base) && OF_SECTION.some((name) => name in base))
    throw new Refused("Give E and ν, or EI and GJ: a rod has one section.");
  for (const name of fieldNames(state))
    values[name] = checked(name, base[name] ?? (OPTIONAL.includes(name) ? 0 : null), symbols);
  const reading = state.reading === undefined ? null : state.reading.split("/");
  const one = {
    inner_radius: 0,
    ...values,
    side: base.side || "outside",
    alpha: base.alpha || 0,
    stiffness: reading ? reading[2] : base.stiffness || "solid",
  };
  one.sign = SIDES[one.side];
  if (one.sign < 0 && one.R <= one.a)
    throw new Refused("The cylinder is too narrow: R must be greater than a where the rod lies inside.", "R");
  if (one.inner_radius >= one.a)
    throw new Refused("The tube has no wall: its inner radius must be less than a.", "inner_radius");
  const section = "EI" in one ? "given" : one.stiffness;
  one.rho = RHO[one.side](one);
  one.A = BENDING[section](one);
  one.C = TORSION[section](one);
  one.kind = isEnds(state) ? "ends" : "start";
  if (varies(state)) return { ...one, varies: true, leaves: leaves(state), FZ: one.FZ ?? 0, MZ: one.MZ ?? 0, M3: one.M3 ?? 0 };
  return {
    ...one,
    ...(one.kind === "ends" ? { FZ: one.FZ, MZ: one.MZ, M3: one.M3 } : startLoads(one, given(one, reading))),
  };
}

function checked(name, value, symbols) {
  const letter = symbols[name] || name;
  const unit = ["ratio", "share"].includes(kindOf(name)) ? "" : ", in the unit beside it and without a unit of its own";
  if (typeof value !== "number" || !Number.isFinite(value)) throw new Refused(`${letter} needs a number${unit}.`, name);
  const { low = -Infinity, closed, high = Infinity } = POSITIVE.includes(name) ? { low: 0 } : RANGES[name] || {};
  if ((closed ? value >= low : value > low) && value <= high) return value;
  const written = (bound) => `${isDegrees(name) ? `${Math.round(bound / DEGREE)}°` : bound}`.replace("-", "−");
  if (closed && high < Infinity) throw new Refused(`${letter} must be from ${written(low)} to ${written(high)}.`, name);
  const most = high < Infinity ? ` and at most ${written(high)}` : "";
  throw new Refused(`${letter} must be ${closed ? "at least" : "greater than"} ${written(low)}${most}.`, name);
}

/* The forces and the one twist that a start problem is given; reading: its words, or null. */
function given(one, reading) {
  if (!reading) return { F2: one.F2, F3: one.F3, twist: TWISTS.find((name) => name in one) };
  const [twist, load] = reading;
  return {
    F2: twist === "shear" ? one.F1 : 0,
    F3: load === "tension" ? one.F3 : -one.F3,
    twist: twist === "force-first" ? "F1" : "dgamma",
  };
}

/* FZ, MZ and M3 of a start problem. */
function startLoads(one, { F2, F3, twist }) {
  if (twist === "F1" && one.dbeta === 0)
    throw new Refused("F₁ does not fix the twist where β₀′ is 0: give β₀′ another value.", "dbeta");
  return LOADS[twist]({ ...one, F2, F3 });
}

/* The dimensionless problem of a case that begins with the slope dbeta0 [1/length]. */
export const reduced = (one, dbeta0 = one.dbeta) =>
  problemOf({ ...one, beta: one.kind === "ends" ? one.beta0 : one.beta, dbeta: dbeta0 });

/* The state of the ends problem with the loads and the end angles of a solved start problem. */
export function heldState(state, one, betaL, equilibrium) {
  const { R, side, stiffness, FZ, MZ, M3 } = one;
  const rod = Object.fromEntries(rodNames(state.base).map((name) => [name, one[name]]));
  return {
    title: state.title,
    units: state.units,
    base: { ...rod, ...("EI" in rod ? {} : { stiffness }), R, side, beta0: one.beta, betaL, FZ, MZ, M3 },
    equilibrium,
  };
}
