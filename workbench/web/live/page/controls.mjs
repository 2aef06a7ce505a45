// The fields of a rod: a slider and a number each, and what is wrong beside its field.

import { fieldNames, isUnused, kindOf, meaning, quantityOf } from "./rod_case.mjs";
import { make, set } from "./details.mjs";
import { RANGES } from "./formulas.mjs";
import { CURVATURE, PUSH, inUnit, minus, number, stated, withUnit } from "./text.mjs";

const RATIO = [-0.95, 0.5]; // of nu
const BORE = 1.5; // the end of the slider of an inner radius, as a factor of the value of the preset
const WIDER = 5; // the ends of a slider, as a factor of the value of the preset
const STEPS = 1000,
  KEY = 10,
  PAGE = 100; // of a slider; of an arrow key; of page up and down
const LETTERS = 9; // in the box of a number

/* The two ends of the slider of a field; centre: its value in the preset. */
export function spanOf(name, centre, span) {
  const kind = kindOf(name);
  if (Array.isArray(span) && (kind !== "positive" || span[0] > 0)) return span;
  if (kind === "ratio") return RATIO;
  if (kind === "tilt") return [0, Math.PI];
  if (kind === "share") return [0, 1];
  if (kind === "bore") return [0, BORE * centre || span || 1];
  if (kind === "positive") return [centre / WIDER, centre * WIDER];
  const most = RANGES[name]?.high ?? (name === "betaL" ? 2 : 1) * Math.PI,
    far = span || (kind === "angle" ? most : 4 * Math.abs(centre || 0) || 1);
  return [-far, far];
}

/* The place of a value on its slider, and the value at a place. */
export function placeOf(name, value, [low, high]) {
  return (
    STEPS * (kindOf(name) === "positive" ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low))
  );
}
export function valueAt(name, place, [low, high]) {
  const u = place / STEPS;
  return Number((kindOf(name) === "positive" ? low * (high / low) ** u : low + u * (high - low)).toPrecision(6));
}

/* A number that a person typed: with a comma or a minus sign, too; NaN for anything else. */
export function typed(text) {
  const plain = text.trim().replaceAll("−", "-").replace(",", ".");
  return /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(plain) ? Number(plain) : NaN;
}

/* A number as its box shows it: with as many of seven digits as there is room for. */
export function inBox(value) {
  for (let digits = 7; ; digits--) {
    const rounded = Number(value.toPrecision(digits)),
      texts = [String(rounded), rounded.toExponential().replace("e+", "e")].sort((a, b) => a.length - b.length);
    if (texts[0].length <= LETTERS || digits === 1) return texts[0];
  }
}

/* The slider of a number, from 0 on; properties: of the element. */
export const makeSlider = (properties) => make("input", { type: "range", min: 0, step: "any", ...properties });

/* Give an element an attribute, or null for none, where it has another: a screen reader speaks each change. */
function tell(box, name, value) {
  if (box.getAttribute(name) === value) return;
  if (value === null) box.removeAttribute(name);
  else box.setAttribute(name, value);
}

/* The fields in `box`, the one that stands first in `first`. changed(name, value): called with each new value. */
export function makeControls(box, first, quantities, changed) {
  let rows = {},
    made = "";

  function build(state, context) {
    for (const place of [box, first]) place.replaceChildren();
    rows = {};
    for (const name of fieldNames(state)) {
      const [symbol, words, dimension] = quantities[quantityOf(name)],
        [unit, size] = stated(dimension, state.units, name),
        label = make("label", { htmlFor: `n-${name}` }, make("b", {}, symbol), make("span", {}, ` ${words}`)),
        slider = makeSlider({ max: STEPS, id: `s-${name}`, tabIndex: -1, "aria-label": `${words}, slider` }),
        field = make("input", { type: "text", id: `n-${name}`, autocomplete: "off", spellcheck: false, role: "spinbutton" }),
        note = make("p", { id: `why-${name}` }),
        ends = context.span(name).map((end) => make("span", {}, number(end * size, 3))),
        range = make("div", { className: "range" }, ends[0], slider, ends[1]),
        row = make("div", { className: "field" }, label, field, make("span", { className: "unit" }, unit), range, note);
      (name === context.handle() ? first : box).append(row);
      rows[name] = { row, slider, field, note, unit, size };
      slider.addEventListener("input", () => changed(name, valueAt(name, Number(slider.value), context.span(name))));
      field.addEventListener("change", () => changed(name, typed(field.value) / size, true));
      field.addEventListener("keydown", (event) => {
        const by = { ArrowUp: KEY, ArrowDown: -KEY, PageUp: PAGE, PageDown: -PAGE }[event.key];
        if (!by || !Number.isFinite(context.value(name))) return;
        event.preventDefault();
        changed(name, valueAt(name, placeOf(name, context.value(name), context.span(name)) + by, context.span(name)));
      });
    }
  }

  /* Show the values of a state. wrong: a sentence and its field. context: the span and the value of each field. */
  function show(state, wrong, context) {
    const key = JSON.stringify([context.handle(), fieldNames(state), state.units, fieldNames(state).map(context.span)]);
    if (key !== made) (build(state, context), (made = key));
    for (const [name, { row, slider, field, note, unit, size }] of Object.entries(rows)) {
      const value = state.base[name] ?? 0,
        spoken = value * size,
        bad = wrong.field === name;
      const text = Number.isFinite(spoken) ? inBox(spoken) : field.value;
      const place = placeOf(name, value, context.span(name));
      if (!(Math.abs(Number(slider.value) - Math.min(Math.max(place, 0), STEPS)) < 0.01)) slider.value = place;
      if (!(bad && document.activeElement === field) && field.value !== text) field.value = text;
      const said = withUnit(number(spoken, 7), unit);
      for (const box of [slider, field]) tell(box, "aria-valuetext", said);
      if (Number.isFinite(spoken)) tell(field, "aria-valuenow", String(spoken));
      const about = bad ? wrong.sentence : meaning(state, name);
      set(note, about);
      note.className = bad ? "why" : "note";
      note.hidden = !about;
      tell(field, "aria-invalid", String(bad));
      tell(field, "aria-describedby", about ? note.id : null);
      row.classList.toggle("wrong", bad);
      row.classList.toggle("unused", isUnused(state, name));
    }
  }

  return { show };
}

/* A line of the values at one place of the rod. */
export function hereText(at, units) {
  const unit = (value, dimension) => inUnit(value, stated(dimension, units));
  return minus(
    [
      `s = ${unit(at.s, [1, 0])}`,
      `β = ${unit(at.beta, "rad")}`,
      `${at.push < 0 ? "pull" : "push"} ${unit(Math.abs(at.push), PUSH)}`,
      ...(at.gap === undefined ? [] : [`gap ${unit(at.gap, [1, 0])}`]),
      `κ = ${unit(at.kappa, CURVATURE)}`,
      `F₃ = ${unit(at.tension, [0, 1])}`,
    ]
      .map((part) => part.replaceAll(" ", "\u00a0")) // no line ends inside one
      .join("\u00a0· "),
  );
}
