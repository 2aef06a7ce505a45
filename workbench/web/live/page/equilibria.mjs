// The equilibria between two ends: their list, the diagram of their branches, and the one that is shown.

import { makeBranches } from "./branch_diagram.mjs";
import { element, set } from "./details.mjs";
import { rowOf, showList } from "./equilibria_list.mjs";

/* me: the page's state, list and place in it. context: the span of a field. send: asks the server. update(how): draws the
   state. */
export function makeEquilibria(me, data, context, theme, send, update) {
  const toServer = (...words) => send("/branches", ...words),
    branches = makeBranches(element("branches"), data.branches, data.quantities, theme, toServer, takeBranch);

  function ask() {
    set(element("searching"), "searching …");
    send("/equilibria", { state: me.state, ticket: me.head.ticket }, ({ rows }) => took(rows), (why) => took([], why));
  }

  function took(rows, why = "") {
    me.list = rows;
    me.here = rowOf(rows, me.state.equilibrium);
    set(element("searching"), "");
    set(element("unlisted"), why);
    for (const id of ["previous", "next"]) element(id).disabled = !rows.length;
    showList(element("list"), rows, me.here, me.state.units, choose);
    element("branches").hidden = !rows.length;
    if (rows.length) branches.show({ state: me.state, list: rows }, context.span);
    if (me.head.method === "difference" && me.here >= 0) choose(me.here); // followed to 1e-6: now solved exactly
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
