// What the page shows of its state and shape beside the rod: fields, bar, numbers, warnings, the cursor.

import { hereText } from "./controls.mjs";
import { valuesAt } from "./curves.mjs";
import { element, set, showRows, solvedText } from "./details.mjs";
import { observables, rowsOf, warnings } from "./numbers.mjs";
import { isEnds, leaves, varies } from "./rod_case.mjs";
import { wordsOfMarks } from "./push_marks.mjs";
import { number } from "./text.mjs";

const OFFLINE =
  "This file works without a server, so it does not list all equilibria and follows only the one it began with. " +
  "The command workbench explore starts the page with a server.";

const FOLLOW = "The numbers and cautions of the whole rod follow.",
  LEFT_OUT = "Numbers of the whole rod are left out, and of the rest no caution is known: workbench solve has them.";

const LET_GO = "Both ends stay as they are where the cylinder holds the rod on.",
  LOADS = "The loads on its ends stay.";

/* me: the page's state and shape; the others are parts of the page. */
export function makeShown(me, data, { stage, diagrams, controls, context, equilibria, ask }) {
  function showState() {
    const { state, wrong, shape, head } = me,
      units = state.units;
    controls.show(state, wrong, context);
    const shown = document.querySelector(`#n-${CSS.escape(wrong.field || "-")}`) ? "" : wrong.sentence;
    set(element("problem"), shown && shape ? `${shown} The last shape is shown.` : shown);
    element("problem").hidden = !shown;
    element("side").value = state.base.side || "outside";
    element("contact").value = leaves(state) ? "unilateral" : "bilateral";
    const free = leaves(state) && data.served;
    element("contact-note").hidden = !free;
    set(element("contact-note"), free ? (state.let_go ? LET_GO : LOADS) : "");
    element("reading-line").hidden = state.reading === undefined;
    if (state.reading !== undefined)
      Object.assign(element("reading"), { value: state.reading, title: data.readings[state.reading][1] });
    element("sliding-line").hidden = state.base.friction === undefined;
    element("sliding").value = state.base.sliding || "forward";
    element("by-ends").hidden = isEnds(state) || varies(state);
    element("equilibria").hidden = !isEnds(state) || varies(state);
    if (!shape) return;
    stage.showLegend(units);
    const words = wordsOfMarks(shape);
    set(element("contacts"), words);
    element("contacts").hidden = !words;
    if (me.cursor !== null) setCursor(me.cursor);
    if (!data.served) set(element("unlisted"), OFFLINE);
  }

  /* What takes longer than a move of a slider may: observables and warnings. */
  function showNumbers() {
    const { shape, state } = me,
      found = observables(shape),
      crossed = stage.showCrossings(shape);
    if (shape.one.kind === "ends" && !shape.one.varies)
      state.equilibrium = { dbeta0: shape.dbeta[0], energy: found.energy };
    const left = shape.shown < 1 ? `${partNote()} ${data.served ? FOLLOW : LEFT_OUT}` : "",
      told = warnings(shape, found, state.units, crossed);
    equilibria.branches.mark(state, found);
    showRows(me, rowsOf(shape, found), told, data.quantities, left);
    set(element("fine"), solvedText(me.head, shape));
  }

  function partNote() {
    const { s, one, shown } = me.shape,
      part = `${number(s[s.length - 1])} ${me.state.units.length} of ${number(one.L)}`;
    return shown < 1 ? `Only the first ${part} are shown: the rod bends too often for more.` : "";
  }

  function setCursor(s) {
    const { shape } = me;
    me.cursor = s === null || !shape ? null : Math.min(s, shape.s[shape.s.length - 1]);
    const at = me.cursor === null ? null : valuesAt(shape, me.cursor),
      slider = element("cursor");
    stage.view.setMark(at);
    diagrams.setCursor(me.cursor);
    slider.value = at ? (1000 * at.s) / shape.s[shape.s.length - 1] : 0;
    set(element("here"), at ? hereText(at, me.state.units) : "");
    slider.setAttribute("aria-valuetext", at ? hereText(at, me.state.units) : "none");
  }

  /* The rows of the server are those of the whole solver: they replace the page's. */
  function askNumbers() {
    const took = ({ rows, warnings: told }) => {
      const found = rows.map(({ name, value }) => [name, value ?? NaN]);
      showRows(me, found, [...told, partNote()].filter(Boolean), data.quantities);
    };
    ask("/numbers", { state: me.state }, took, (why) => set(element("message"), why));
  }

  return { showState, showNumbers, setCursor, askNumbers };
}
