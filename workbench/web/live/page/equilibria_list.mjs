// The list of equilibria as a table with one radio button a row: one tab stop, arrow keys choose.

import { number } from "./text.mjs";

/* The row that is nearest to an equilibrium by beta'(0) and energy, or -1. */
export function rowOf(list, at) {
  if (!at || !list.length) return -1;
  const distance = (key) => {
    const all = list.map((one) => one[key]),
      wide = Math.max(...all) - Math.min(...all) || 1;
    return (one) => Math.abs(one[key] - at[key]) / wide;
  };
  const slope = distance("dbeta0"),
    energy = distance("energy"),
    away = list.map((one) => slope(one) + energy(one));
  return away.indexOf(Math.min(...away));
}

export function showList(box, list, here, units, choose) {
  const focused = box.contains(document.activeElement);
  box.replaceChildren();
  if (!list.length) return;
  const table = document.createElement("table"),
    head = table.createTHead().insertRow(),
    body = table.createTBody();
  table.setAttribute("aria-label", "Equilibria, lowest energy first");
  for (const text of [
    "",
    "index",
    "bends",
    `energy [${units.force} ${units.length}]`,
    `β₀′ [rad/${units.length}]`,
    "attached",
  ]) {
    const cell = document.createElement("th");
    cell.scope = "col";
    cell.textContent = text;
    if (!text) cell.textContent = "number";
    head.append(cell);
  }
  list.forEach((one, i) => {
    const row = body.insertRow(),
      pick = Object.assign(document.createElement("input"), {
        type: "radio",
        name: "equilibrium",
        id: `e-${i}`,
        checked: i === here,
      });
    const label = Object.assign(document.createElement("label"), { htmlFor: `e-${i}`, textContent: ` ${i + 1}` });
    row.className = i === here ? "list-row here" : "list-row";
    row.insertCell().append(pick, label);
    for (const text of [
      one.index === 0 ? "0, stable" : one.index,
      one.turns,
      number(one.energy, 5),
      number(one.dbeta0, 5),
      `${Math.round(100 * one.attached)} %`,
    ])
      row.insertCell().textContent = text;
    pick.addEventListener("change", () => choose(i));
    row.addEventListener("click", (event) => {
      if (event.target !== pick && event.target !== label) choose(i);
    });
  });
  box.append(table);
  const row = body.rows[here];
  if (row) box.scrollTop = row.offsetTop - (box.clientHeight - row.offsetHeight) / 2;
  if (focused) document.getElementById(`e-${Math.max(here, 0)}`).focus({ preventScroll: true });
}
