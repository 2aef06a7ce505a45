// The observables and warnings below the rod, and the small parts that other modules of the page share.

import { quantityOf } from "./rod_case.mjs";
import { AT_ENDS } from "./numbers.mjs";
import { inUnit, number, powers, stability, stated } from "./text.mjs";

export const element = (id) => document.getElementById(id);

export function set(box, text) {
  if (box.textContent !== text) box.textContent = text;
}

/* A new element with these properties, or attributes where it has no such property, and its content. */
export function make(tag, properties = {}, ...content) {
  const box = document.createElement(tag);
  for (const [name, value] of Object.entries(properties))
    if (name in box) box[name] = value;
    else box.setAttribute(name, value);
  box.append(...content);
  return box;
}

const HEADLINE = ["index", "bends", "turns_around", "height", "push_max", "kappa_max", "gap_max", "contact_share"];
const DEGREE = Math.PI / 180;
const BARRED = /pass(es)? through itself|lift off|tighter than/, // sentences on what no real rod could do
  LIMIT = "The model's limit near the ends."; // before one on lift-off there alone

/* Draw pixels, red, green, blue and opacity each, over a whole canvas. */
export const putPixels = (canvas, pixels) =>
  canvas.getContext("2d").putImageData(new ImageData(pixels, canvas.width, canvas.height), 0, 0);

/* What stands beside an observable: of bends that nobody sees by how much beta varies, and of a rod between clamps, next
   to which the push may be largest, the push in its middle. found: the observables. text: the value of one. */
function beside(name, found, { kind, leaves }, text) {
  const isFlat = name === "bends" && found.bends > 0 && found.amplitude < DEGREE;
  if (isFlat) return `; β varies by ${powers(number(found.amplitude / DEGREE, 2))}°`;
  if (name !== "push_max" || kind !== "ends" || leaves || !(found.push_max > found.push_middle)) return "";
  return text("push_middle") === text("push_max") ? "" : `; ${text("push_middle")} in the middle`;
}

/* Observables, name and value each, and sentences before those of the server. me: state, shape and head. quantities:
   symbol, words and dimension of each name. left: why the large numbers are left out. */
export function showRows({ state: { units }, shape, head: { notes = [], details = [] } }, rows, told, quantities, left = "") {
  const sentences = [...told, ...notes],
    found = Object.fromEntries(rows),
    text = (name, value = found[name]) => inUnit(value, stated(quantities[quantityOf(name)][2], units, name));
  const row = ([name, value], id) => {
    const [symbol, long] = quantities[quantityOf(name)],
      isAnswer = name === "overlaps",
      isStability = id === "h" && name === "index",
      words = isAnswer ? "whether the rod passes through itself" : isStability ? "under these loads" : long,
      isSaid = `${words} `.startsWith(`${symbol} `), // the words begin with the symbol
      letter = make("b", { className: isSaid ? "said" : "" }, symbol),
      amount = isAnswer
        ? value ? "yes" : "no"
        : isStability
          ? stability(value)
          : name === "lift_off_at" && value > shape.one.L * (1 - 1e-9)
            ? "nowhere"
            : text(name, value);
    return make("div", {}, make("dt", {}, letter, isSaid ? words.slice(symbol.length) : ` ${words}`, beside(name, found, shape.one, text)),
                make("dd", { id: `${id}-${name}` }, amount));
  };
  const headline = HEADLINE.map((name) => rows.find(([other]) => other === name)).filter(Boolean);
  const none = left ? [make("div", { className: "left-out" }, make("dt", {}, left), make("dd", {}, "—"))] : [];
  element("headline").replaceChildren(...none, ...headline.map((one) => row(one, "h")));
  element("numbers").replaceChildren(...rows.map((one) => row(one, "o")));
  const [limits, more] = [true, false].map((isLimit) => sentences.filter((text) => text.includes(AT_ENDS) === isLimit)),
    barred = more.filter((text) => BARRED.test(text)),
    start = rows.find(([name]) => name === "lift_off_at"),
    from = start && barred.some((text) => text.includes("lift off")) ? ` Lift-off from s = ${number(start[1])} ${units.length}.` : "";
  for (const [id, first, texts] of [["chip", "Not physically possible.", barred], ["limit", LIMIT, limits]]) {
    element(id).hidden = !texts.length;
    set(element(id), texts.length ? `${first} ${texts.join(" ")}${id === "chip" ? from : ""}` : "");
  }
  const others = more.filter((text) => !BARRED.test(text));
  for (const [id, texts] of [["warnings", others], ["details", details]])
    element(id).replaceChildren(...texts.map((text) => make("li", {}, text)));
  element("detailed").hidden = !details.length;
}

/* How the shape was solved, in one line. */
export function solvedText({ outcome, method }, { one, error, condition, s }) {
  const told = [
    outcome || "solved",
    error > 0 ? `estimated error ${powers(number(error, 2))}${one.leaves ? " of the length" : ""}` : "",
    Number.isFinite(condition) ? `condition number ${powers(number(condition, 3))}` : "",
    `${s.length} stations`,
  ];
  return `${told.filter(Boolean).join(", ")} (${method}).`;
}

/* The colours of the page's style, read anew after `forget`. */
export function makeTheme() {
  let known = null;
  const names = ["ink", "soft", "faint", "line", "level", "mark", "font"];
  const read = () => {
    const style = getComputedStyle(document.documentElement);
    return Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
  };
  const forget = () => (known = null);
  /* On paper the colours are the light ones, whatever the scheme of the screen. */
  const onPaper = (on) => {
    document.documentElement.toggleAttribute("data-paper", on);
    forget();
  };
  return Object.assign(() => (known ??= read()), { forget, onPaper });
}
