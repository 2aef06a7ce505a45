// The equilibria between two ends: their list, the diagram of their branches, and the one that is shown.

import { makeBranches } from "./branch_diagram.mjs";
import { element, make, set } from "./details.mjs";
import { range } from "./range.mjs";
import { alike, stability, stated } from "./text.mjs";

/* me: the page's state, list and place in it. context: the span of a field. send: asks the server. update(how): draws the
   state. */
export function makeEquilibria(me, data, context, theme, send, update) {
  const toServer = (...words) => send("/branches", ...words),
    branches = makeBranches(element("branches"), data.branches, data.quantities, theme, toServer, takeBranch);

  function ask() {
    set(element("searching"), "searching …");
    send("/equilibria", { state: me.state }, ({ rows }) => took(rows), (why) => took([], why));
  }

  function took(rows, why = "") {
    me.list = rows;
    me.here = rowOf(rows, me.state.equilibrium);
    set(element("searching"), "");
    set(element("unlisted"), why);
    for (const id of ["previous", "next"]) element(id).hidden = !rows.length;
    showList(element("list"), rows, me.here, me.state.units, choose);
    element("branches").hidden = !rows.length;
    if (rows.length) branches.show({ state: me.state, list: rows }, context.span);
  }

  function choose(i) {
    const { dbeta0, energy } = me.list[i];
    me.state.equilibrium = { dbeta0, energy };
    me.here = i;
    showList(element("list"), me.list, i, me.state.units, choose);
    update({ chosen: true });
  }

  const step = (by) => choose((Math.max(me.here, 0) + by + me.list.length) % me.list.length);

  /* The rod of a point of a branch, at another value of its field. */
  function takeBranch(field, value, equilibrium) {
    const at = me.state.base[field] === value ? rowOf(me.list, equilibrium) : -1;
    if (at >= 0) return choose(at);
    me.state.base[field] = value;
    me.state.equilibrium = equilibrium;
    me.list = [];
    return update({ chosen: true });
  }

  return { ask, choose, step, branches };
}

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

const WIDE = 130,
  TALLEST = 44, // pixels of a small rod
  EDGE = 3;

/* A rod as a small unrolled line, at a scale of its own; a stable one is thick. */
function smallRod({ line: { z, around }, index }) {
  const [[left, right], [top, bottom]] = [range(z), range(around)],
    scale = Math.min(WIDE / (right - left || 1e-300), TALLEST / (bottom - top || 1e-300)),
    height = scale * (bottom - top),
    cell = make("div"),
    points = z.map((v, k) => [scale * (v - left), scale * (around[k] - top)].map((size) => size.toFixed(1)).join(","));
  cell.innerHTML = "<svg aria-hidden='true'><polyline /></svg>";
  const svg = cell.firstChild,
    size = { width: WIDE + 2 * EDGE, height: height + 2 * EDGE };
  for (const [name, value] of Object.entries(size)) svg.setAttribute(name, value.toFixed(1));
  svg.setAttribute("viewBox", `${-EDGE} ${-EDGE} ${size.width} ${size.height.toFixed(1)}`);
  svg.setAttribute("class", index === 0 ? "stable" : "unstable");
  svg.firstChild.setAttribute("points", points.join(" "));
  return svg;
}

/* The list as a table with a small rod and a radio button a row: one tab stop, arrow keys choose. */
function showList(box, list, here, units, choose) {
  const focused = box.contains(document.activeElement);
  box.replaceChildren();
  if (!list.length) return;
  const [slopeUnit, size] = stated("rad/length", units),
    table = make("table", { "aria-label": "Equilibria, lowest energy first" }),
    head = table.createTHead().insertRow(),
    body = table.createTBody();
  for (const text of [
    "number",
    "unrolled, not to one scale",
    "stability",
    "bends",
    `energy [${units.force} ${units.length}]`,
    `β₀′ [${slopeUnit}]`,
    "attached",
  ])
    head.append(make("th", { scope: "col" }, text));
  const energies = alike(list.map(({ energy }) => energy), 5),
    slopes = alike(list.map(({ dbeta0 }) => dbeta0 * size), 5);
  list.forEach((one, i) => {
    const row = body.insertRow(),
      pick = make("input", { type: "radio", name: "equilibrium", id: `e-${i}`, checked: i === here }),
      label = make("label", { htmlFor: `e-${i}` }, ` ${i + 1}`);
    row.className = i === here ? "list-row here" : "list-row";
    row.insertCell().append(pick, label);
    row.insertCell().append(smallRod(one));
    for (const text of [
      stability(one.index),
      one.bends,
      energies[i],
      slopes[i],
      `${Math.round(100 * one.attached)} %`,
    ])
      row.insertCell().append(text);
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
