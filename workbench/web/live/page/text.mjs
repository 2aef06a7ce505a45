// Numbers, units and the ticks of an axis as text.

import { FORCES, HABITS, LENGTHS } from "./formulas.mjs";

const RAISED = Object.fromEntries([..."−0123456789"].map((one, k) => [one, "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"[k]]));
const HIGH = { 2: "²", 3: "³", 4: "⁴" };

/* A number with at most so many digits: "10910", "0.625", "2e6". */
export function number(value, digits = 4) {
  if (value === 0) return "0";
  if (!Number.isFinite(value)) return "not known";
  const power = Math.floor(Math.log10(Math.abs(value)));
  const rounded = Number(value.toPrecision(digits));
  const text = power < -4 || power > 5 ? rounded.toExponential().replace("e+", "e") : String(rounded);
  return minus(text);
}

/* Numbers side by side, all with as many digits as the one with most of them. */
export function alike(values, digits = 4) {
  const texts = values.map((value) => number(value, digits)),
    count = (text) => text.replace(/\D/g, "").replace(/^0+/, "").length,
    most = Math.max(0, ...texts.filter((text) => text.includes(".") && !text.includes("e")).map(count));
  return texts.map((text) => {
    const missing = most - count(text);
    if (missing <= 0 || text.includes("e") || !/[1-9]/.test(text)) return text;
    return text + (text.includes(".") ? "" : ".") + "0".repeat(missing);
  });
}

/* Powers of ten as in print: "2.5e−10" as "2.5·10⁻¹⁰", "1e6" as "10⁶". */
export const powers = (text) =>
  text.replace(
    /(\d[\d.]*)e([−\d]+)/g,
    (_, digits, power) => `${digits === "1" ? "" : `${digits}·`}10${[...power].map((one) => RAISED[one]).join("")}`,
  );

/* The text with minus signs for hyphens before numbers and in exponents. */
export const minus = (text) => text.replace(/(?<![\p{L}\p{N}_.])-(?=[\d.])|(?<=\de)-/gu, "−");

/* The unit of a dimension: exponents of length and force, or "rad", "rad/length"; "" for a plain number. */
export function unitText(dimension, units) {
  if (dimension === "text") return "";
  if (typeof dimension === "string") return dimension === "rad" ? "°" : dimension.replace("length", units.length);
  const [length, force] = dimension,
    named = [
      [units.force, force],
      [units.length, length],
    ];
  const part = (sign) => named.filter(([, n]) => sign * n > 0).map(([unit, n]) => unit + (HIGH[sign * n] || ""));
  const above = part(1).join(" "),
    below = part(-1)
      .map((unit) => `/${unit}`)
      .join("");
  return above || below ? (above || "1") + below : "";
}

/* The unit in which a quantity of a dimension is stated, and how many of it are one of its unit in the case. */
export function stated(dimension, units, name) {
  if (dimension === "rad") return ["°", 180 / Math.PI];
  const exponents = { "rad/length": [-1, 0, 1] }[dimension] || [...dimension, 0],
    isMet = (known, one) => !known.length || known.includes(one);
  const habit = HABITS.find(
    ([of, lengths, forces, names]) =>
      isMet(lengths, units.length) && isMet(forces, units.force) && isMet(names, name) && of.every((n, k) => n === exponents[k]),
  );
  if (!habit) return [unitText(dimension, units), 1];
  const [length, force] = exponents,
    [unit, size] = habit.slice(-2);
  return [unit, (LENGTHS[units.length] ** length * FORCES[units.force] ** force) / size];
}

export const PUSH = [-1, 1]; // a dimension
export const CURVATURE = [-1, 0];

/* Round values between two ends: two at least, and by the steps 1, 2 and 5 no more than one above so many. */
export function ticks(low, high, count) {
  const power = 10 ** Math.floor(Math.log10((high - low) / count));
  let found = [];
  if (!(high > low)) return found;
  for (const step of [10, 5, 2, 1].map((m) => m * power)) {
    const next = [];
    for (let k = Math.ceil(low / step - 1e-9); k <= high / step + 1e-9; k++) next.push(k * step);
    if (found.length > 1 && next.length > count + 1) return found;
    found = next;
  }
  return found;
}

/* The text of a tick: a value next to 0, compared with the distance of the ticks, is 0. */
export const tickText = (value, size) => number(Math.abs(value) < 1e-9 * size ? 0 : value, 6);

export const stability = (index) => (index === 0 ? "stable" : `unstable in ${index} way${index === 1 ? "" : "s"}`);

/* A number with its unit: "5 N", "30°", "0.25". */
export const withUnit = (text, unit) => (unit === "°" ? `${text}°` : `${text} ${unit}`.trim());

/* A value in its unit of `stated`. */
export const inUnit = (value, [unit, size]) => withUnit(number(value * size), unit);
