// The page: the inputs make a state, the state a shape, and the shape is drawn.

import { hereText, makeControls, spanOf } from "./controls.mjs";
import { valuesAt } from "./curves.mjs";
import { element, makeTheme, set, showRows, solvedText } from "./details.mjs";
import { makeEquilibria } from "./equilibria.mjs";
import { copyText, saveFile, savePicture, showStudy } from "./files.mjs";
import { observables, warnings } from "./numbers.mjs";
import { Refused, caseOf, heldState, isEnds, isState } from "./rod_case.mjs";
import { makePrint } from "./print.mjs";
import { showBar } from "./push_bar.mjs";
import { interpolated, marched, moved } from "./rod_shape.mjs";
import { crossings } from "./self_contact.mjs";
import { showScale } from "./scale_bar.mjs";
import { makeDiagrams } from "./side_diagrams.mjs";
import { makeAsker, post, unpacked } from "./server.mjs";
import { fromHash, toHash } from "./study_text.mjs";
import { makeView } from "./rod_view.mjs";
import { number } from "./text.mjs";
import { drawTriad } from "./triad.mjs";

const PATIENCE = { numbers: 90, more: 250, list: 500 }; // ms of rest before what is slower
const OFFLINE =
  "This file works without a server, so it does not list all equilibria and follows only the one it began with. " +
  "The command workbench explore starts the page with a server.";

const data = JSON.parse(element("data").textContent),
  served = data.served;
const letters = Object.fromEntries(Object.keys(data.quantities).map((name) => [name, data.quantities[name][0]]));
Object.assign(letters, { beta: letters.beta0, dbeta: letters.dbeta0 });
const copied = (value) => JSON.parse(JSON.stringify(value));
const still = window.matchMedia("(prefers-reduced-motion: reduce)"),
  dark = window.matchMedia("(prefers-color-scheme: dark)");

const me = {
  preset: "",
  centre: {},
  state: null,
  shape: null,
  head: {},
  list: [],
  here: -1,
  wrong: { sentence: "", field: "" },
  cursor: null,
  drawn: 0,
  busy: false,
};
let core = null,
  again = null,
  timers = {},
  moves = 0,
  hash = "";

const theme = makeTheme();
const view = makeView(element("scene"), element("mark"), data.colours, () => still.matches, true);
const diagrams = makeDiagrams(element("diagrams"), element("unrolled"), data.colours, theme, setCursor);
const ask = makeAsker(() => me.shape);
makePrint(element("scene"), view, diagrams, theme);
const context = {
  span: (name) => spanOf(name, me.centre[name], (presetOf() || {}).spans?.[name]),
  value: (name) => me.state.base[name],
};
const controls = makeControls(element("fields"), data.quantities, (name, value) => {
  me.state.base[name] = value;
  update();
});

const equilibria = makeEquilibria(me, data, context, theme, ask, update);

const presetOf = () => data.presets.find((one) => one.name === me.preset);

// a state to begin with

function begin(name) {
  const one = data.presets.find((preset) => preset.name === name);
  enter(name, copied(one.state), one.shape);
}

/* seed: s and beta of the shape between two ends with which this file was saved. */
function enter(name, state, seed = null) {
  Object.assign(me, { preset: name, centre: copied(state.base), state, list: [], here: -1, cursor: null });
  setCursor(null);
  element("preset").value = name;
  element("source").textContent = presetOf().source;
  set(element("message"), "");
  element("list").replaceChildren();
  update({ fresh: true, seed });
}

function follow() {
  if (location.hash.length < 2 || location.hash === hash) return location.hash.length > 1;
  try {
    const { preset, state } = fromHash(location.hash.slice(1));
    if (!isState(state, data.readings)) throw new Error();
    const known = data.presets.find((one) => one.name === preset) || data.presets[0];
    enter(known.name, state, isEnds(state) ? known.shape : null);
    return true;
  } catch {
    begin(data.presets[0].name);
    refuse(new Refused("This link is not complete: copy it again from the page."));
    return true;
  }
}

// a shape of the state

/* how: fresh, for another rod; chosen, for another equilibrium; refit, for a rod that must be seen whole. */
function update(how = {}) {
  const since = performance.now();
  moves += 1;
  try {
    const one = caseOf(me.state, letters),
      near = how.seed ? { ...how.seed, one } : me.shape;
    const asks = served && one.kind === "ends";
    if (asks) return askShape(one, how, since);
    again = null;
    const shape = one.kind === "start" ? marched(core, one) : near && near.one.kind === "ends" && moved(one, near);
    if (shape) return took(shape, { method: "in this page" }, how, since);
    if (one.kind === "ends")
      throw new Refused(
        "No equilibrium was found next to the one before. Move the slider back, or use workbench explore.",
      );
  } catch (error) {
    return refuse(error);
  }
}

/* One request at a time; of those that wait only the last is sent. */
async function askShape(one, how, since) {
  if (me.busy) {
    again = { ...how, fresh: how.fresh || (again || {}).fresh };
    return;
  }
  const mine = moves,
    isOld = () => mine !== moves && !again; // what was asked since needs no server
  me.busy = true;
  try {
    const near = how.fresh || how.chosen ? undefined : me.head.ticket;
    if (!how.fresh && !how.chosen && me.state.equilibrium && !near) delete me.state.equilibrium;
    const { head, arrays } = unpacked(await (await post("/shape", { state: me.state, near })).arrayBuffer());
    if (isOld()) return;
    if (head.which) me.state.equilibrium = head.which;
    const { outcome, error, condition, method, notes, ticket } = head;
    took(
      interpolated(one, arrays, { error: error ?? NaN, condition: condition ?? NaN, sound: true, shown: 1 }),
      { outcome, method, notes, ticket },
      how,
      since,
    );
  } catch (error) {
    if (!isOld()) refuse(error);
  } finally {
    me.busy = false;
    if (again) {
      const next = again;
      again = null;
      update(next);
    }
  }
}

function took(shape, head, how, since) {
  const solved = performance.now(),
    refit =
      how.refit ||
      how.chosen ||
      !me.shape ||
      me.shape.one.side !== shape.one.side ||
      me.shape.one.kind !== shape.one.kind;
  Object.assign(me, { shape, head, wrong: { sentence: "", field: "" } });
  const locked = element("lock").checked && view.drawn && !how.fresh ? view.drawn.scale : null;
  view.show(shape, { fresh: how.fresh, refit: refit && locked === null, scale: locked });
  const drawn = performance.now();
  diagrams.show(shape, me.state.units, view.drawn.scale);
  showState();
  me.drawn += 1;
  document.dispatchEvent(
    new CustomEvent("drawn", {
      detail: { since, solve: solved - since, draw: drawn - solved, diagrams: performance.now() - drawn },
    }),
  );
  later("numbers", PATIENCE.numbers, showNumbers);
  if (shape.one.kind !== "ends") {
    me.list = [];
    return;
  }
  if (served && (!how.chosen || !me.list.length)) later("list", PATIENCE.list, equilibria.ask);
}

function later(name, wait, work) {
  clearTimeout(timers[name]);
  timers[name] = setTimeout(work, wait);
}

function refuse(error) {
  if (!(error instanceof Refused)) throw error;
  if (!error.sentence) return;
  me.wrong = { sentence: error.sentence, field: error.field };
  showState();
}

// what is shown

function showState() {
  const { state, wrong, shape, head } = me,
    units = state.units;
  controls.show(state, wrong, context);
  const shown = document.querySelector(`#n-${CSS.escape(wrong.field || "-")}`) ? "" : wrong.sentence;
  set(element("problem"), shown && shape ? `${shown} The last shape is shown.` : shown);
  element("problem").hidden = !shown;
  element("side").value = state.base.side || "outside";
  element("reading-line").hidden = state.reading === undefined;
  if (state.reading !== undefined) element("reading").value = state.reading;
  element("by-ends").hidden = isEnds(state);
  element("equilibria").hidden = !isEnds(state);
  if (!shape) return;
  showBar(element("bar"), data.colours, view.drawn.scale, `${units.force}/${units.length}`);
  const squeezed = view.drawn.squeeze < 1;
  element("squeeze").hidden = !squeezed;
  if (squeezed) set(element("squeeze"), `Axis compressed 1 : ${(1 / view.drawn.squeeze).toPrecision(3)}`);
  if (me.cursor !== null) setCursor(me.cursor);
  set(element("unlisted"), served ? element("unlisted").textContent : OFFLINE);
}

/* What takes longer than a move of a slider may: observables, warnings, the address. */
function showNumbers() {
  const { shape, state } = me,
    found = observables(shape),
    crossed = crossings(shape);
  element("crossed").hidden = !crossed.length;
  view.setRings(crossed);
  if (shape.one.kind === "ends" && !me.head.ticket)
    state.equilibrium = { dbeta0: shape.dbeta[0], energy: found.energy };
  const known = Object.entries(found).filter(([, value]) => Number.isFinite(value));
  equilibria.branches.mark(state, found);
  showRows(known, [...warnings(shape, found, crossed), ...partNote()], data.quantities, state.units);
  set(element("fine"), solvedText(me.head, shape));
  link();
  if (served) later("more", PATIENCE.more, askNumbers);
}

function partNote() {
  const { s, one, shown } = me.shape,
    part = `${number(s[s.length - 1])} ${me.state.units.length} of ${number(one.L)}`;
  const note = `Only the first ${part} are shown: the rod bends too often for more.`;
  return [...(me.head.notes || []), ...(shown < 1 ? [note] : [])];
}

function setCursor(s) {
  const { shape } = me;
  me.cursor = s === null || !shape ? null : Math.min(s, shape.s[shape.s.length - 1]);
  const at = me.cursor === null ? null : valuesAt(shape, me.cursor),
    slider = element("cursor");
  view.setMark(at);
  diagrams.setCursor(me.cursor);
  slider.value = at ? (1000 * at.s) / shape.s[shape.s.length - 1] : 0;
  set(element("here"), at ? hereText(at, me.state.units) : "");
  slider.setAttribute("aria-valuetext", at ? hereText(at, me.state.units) : "none");
}

// what the server adds

/* The rows of the server are those of the whole solver: they replace the page's. */
function askNumbers() {
  const took = ({ rows, warnings: told }) => {
    const found = rows.map(({ name, value }) => [name, value ?? NaN]);
    showRows(found, [...told, ...partNote()], data.quantities, me.state.units);
  };
  ask("/numbers", { state: me.state, ticket: me.head.ticket }, took, (why) => set(element("message"), why));
}

/* The same rod between its two ends: the shape stays, and the state names it. */
function byEnds() {
  const { shape, state } = me,
    { energy } = observables(shape);
  if (shape.shown < 1)
    return refuse(new Refused("Only a part of this rod is shown, so its far end is not known: make it shorter."));
  me.state = heldState(state, shape.one, shape.beta[shape.beta.length - 1], { dbeta0: shape.dbeta[0], energy });
  me.centre = copied(me.state.base);
  return update({ refit: true, ...(served ? { chosen: true } : { seed: shape }) });
}

// the address, and what is pressed

function link() {
  hash = `#${toHash({ preset: me.preset, state: me.state })}`;
  history.replaceState(null, "", hash);
}

function prepare() {
  const option = (value, text) => Object.assign(document.createElement("option"), { value, textContent: text });
  element("preset").append(...data.presets.map((one) => option(one.name, one.title)));
  element("reading").append(...data.readings.map((one) => option(one, one.split("/").join(", "))));
  element("no-webgl").hidden = Boolean(view.scene);
  for (const button of document.querySelectorAll(".served")) button.hidden = !served;
  const acts = {
    fit: () => view.fit(),
    front: () => view.front(),
    reset: () => begin(me.preset),
    "by-ends": byEnds,
    picture: () => savePicture(me, view, data),
    previous: () => equilibria.step(-1),
    next: () => equilibria.step(1),
    "copy-study": () => showStudy(me.state),
    "copy-link": () => {
      link();
      return copyText(location.href, "The link is copied.");
    },
    ...Object.fromEntries(["csv", "step", "stl", "glb"].map((kind) => [kind, () => saveFile(me, kind, served)])),
  };
  for (const [id, act] of Object.entries(acts)) element(id).addEventListener("click", act);
  element("preset").addEventListener("change", (event) => begin(event.target.value));
  element("reading").addEventListener("change", (event) => {
    me.state.reading = event.target.value;
    update();
  });
  element("side").addEventListener("change", (event) => {
    me.state.base.side = event.target.value;
    update({ refit: true });
  });
  element("push").addEventListener("change", (event) => view.showPush(event.target.value));
  element("cursor").addEventListener("input", (event) =>
    setCursor((Number(event.target.value) / 1000) * me.shape.s[me.shape.s.length - 1]),
  );
  view.picked = setCursor;
  view.moved = (camera) => {
    drawTriad(element("triad"), camera);
    showScale(element("scale"), view, element("scene"), me.state.units.length);
  };
  dark.addEventListener("change", () => {
    theme.forget();
    diagrams.paint();
    equilibria.branches.paint();
  });
  window.addEventListener("hashchange", follow);
}

async function start() {
  core = await RodCore.load(Uint8Array.from(atob(data.core), (c) => c.charCodeAt(0)));
  prepare();
  if (!follow()) begin(data.presets[0].name);
}

globalThis.page = Object.assign(me, { begin, enter, update, view, ...equilibria });
start();
