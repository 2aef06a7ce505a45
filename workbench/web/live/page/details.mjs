// The observables and warnings below the rod, and the small parts that other modules of the page share.

import { DEGREE, quantityOf } from "./rod_case.mjs";
import { number, powers, unitText, withUnit } from "./text.mjs";

export const element = (id) => document.getElementById(id);

export function set(box, text) {
  if (box.textContent !== text) box.textContent = text;
}

const HEADLINE = ["turns", "wraps", "height", "push_max", "kappa_max"];
const BARRED = /pass(es)? through itself|lift off|tighter than/; // sentences on what no real rod could do

/* Observables, name and value each, and sentences. quantities: symbol, words and dimension of each name. */
export function showRows(rows, sentences, quantities, units) {
  const row = ([name, value], id) => {
    const [symbol, long, dimension] = quantities[quantityOf(name)],
      isAnswer = name === "overlaps",
      words = isAnswer ? "whether the rod passes through itself" : long;
    const [line, term, letter, amount] = ["div", "dt", "b", "dd"].map((tag) => document.createElement(tag));
    letter.textContent = symbol;
    const isSaid = `${words} `.startsWith(`${symbol} `); // the words begin with the symbol
    letter.classList.toggle("said", isSaid);
    term.append(letter, isSaid ? words.slice(symbol.length) : ` ${words}`);
    if (isAnswer) amount.textContent = value ? "yes" : "no";
    else amount.textContent = withUnit(number(dimension === "rad" ? value / DEGREE : value), unitText(dimension, units));
    amount.id = `${id}-${name}`;
    line.append(term, amount);
    return line;
  };
  const headline = HEADLINE.map((name) => rows.find(([other]) => other === name)).filter(Boolean);
  element("headline").replaceChildren(...headline.map((one) => row(one, "h")));
  element("numbers").replaceChildren(...rows.map((one) => row(one, "o")));
  const barred = sentences.filter((text) => BARRED.test(text)),
    start = rows.find(([name]) => name === "lift_off_at"),
    from = start && barred.some((text) => text.includes("lift off")) ? ` Lift-off from s = ${number(start[1])} ${units.length}.` : "";
  element("chip").hidden = !barred.length;
  set(element("chip"), barred.length ? `Not physically possible. ${barred.join(" ")}${from}` : "");
  const others = sentences.filter((text) => !BARRED.test(text));
  const items = others.map((text) => Object.assign(document.createElement("li"), { textContent: text }));
  element("warnings").replaceChildren(...items);
}

/* How the shape was solved, in one line. */
export function solvedText({ outcome, method }, { error, condition, s }) {
  const told = [
    outcome || "solved",
    error > 0 ? `estimated error ${powers(number(error, 2))}` : "",
    Number.isFinite(condition) ? `condition number ${powers(number(condition, 3))}` : "",
    `${s.length} stations`,
  ];
  return `${told.filter(Boolean).join(", ")} (${method}).`;
}

/* The colours of the page's style, read anew after `forget`. */
export function makeTheme() {
  let known = null;
  const names = ["ink", "soft", "faint", "line", "level", "mark", "badge", "on-badge", "font"];
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
