// The page: the inputs make a state, the state a shape, and the shape is drawn.

import { makeControls, spanOf } from "./controls.mjs";
import { element, makeTheme, set } from "./details.mjs";
import { makeEquilibria } from "./equilibria.mjs";
import { copyText, saveFile, savePicture, showStudy } from "./files.mjs";
import { observables } from "./numbers.mjs";
import { coreOf } from "./packed_core.mjs";
import { makePrint } from "./print.mjs";
import { SLIDING } from "./formulas.mjs";
import { Refused, caseOf, heldState, isEnds, setContact } from "./rod_case.mjs";
import { interpolated, marched, moved } from "./rod_shape.mjs";
import { makeShown } from "./shown.mjs";
import { makeDiagrams } from "./side_diagrams.mjs";
import { makeAsker, post } from "./server.mjs";
import { makeStage } from "./stage.mjs";
import { makeAddress } from "./study_text.mjs";

const SERVER = "A rod with weight or friction, or beside a cylinder that only pushes, needs the server of workbench explore.";
const PATIENCE = { numbers: 90, more: 250, list: 500 }; // ms of rest before what is slower
const data = JSON.parse(element("data").textContent),
  served = data.served;
const letters = Object.fromEntries(Object.keys(data.quantities).map((name) => [name, data.quantities[name][0]]));
Object.assign(letters, { beta: letters.beta0, dbeta: letters.dbeta0 });
const copied = (value) => JSON.parse(JSON.stringify(value));
const still = window.matchMedia("(prefers-reduced-motion: reduce)"),
  dark = window.matchMedia("(prefers-color-scheme: dark)");

const me = { preset: "", centre: {}, state: null, shape: null, head: {}, list: [], here: -1, cursor: null };
Object.assign(me, { wrong: { sentence: "", field: "" }, drawn: 0, busy: false });
let core = null,
  again = null,
  timers = {},
  moves = 0;

const theme = makeTheme();
const unit = () => me.state.units.length,
  stage = makeStage(element("scene"), element("mark"), element, data.colours, () => still.matches, unit),
  { view } = stage;
const diagrams = makeDiagrams(element("diagrams"), element("unrolled"), data.colours, theme, (s) => shown.setCursor(s));
const address = makeAddress(data.readings);
const ask = makeAsker(() => me.shape);
makePrint(element("scene"), view, (on) => {
  theme.onPaper(on);
  diagrams.onPaper(on);
});
const context = {
  handle: () => presetOf().handle,
  span: (name) => spanOf(name, me.centre[name], (presetOf() || {}).spans?.[name]),
  value: (name) => me.state.base[name],
};
const controls = makeControls(element("fields"), element("handle"), data.quantities, (name, value) => {
  me.state.base[name] = value;
  update();
});

const equilibria = makeEquilibria(me, data, context, theme, ask, update);
const shown = makeShown(me, data, { stage, diagrams, controls, context, equilibria, ask });

const presetOf = () => data.presets.find((one) => one.name === me.preset);

// a state to begin with

function begin(name) {
  const one = data.presets.find((preset) => preset.name === name);
  enter(name, copied(one.state), one.shape);
}

/* seed: s, beta and dbeta of the shape between two ends with which this file was saved. */
function enter(name, state, seed = null) {
  Object.assign(me, { preset: name, centre: copied(state.base), state, list: [], here: -1, cursor: null });
  shown.setCursor(null);
  Object.assign(element("preset"), { value: name, title: presetOf().title }); // which the menu may cut
  for (const part of ["sentence", "source"]) element(part).textContent = presetOf()[part];
  set(element("message"), "");
  element("list").replaceChildren();
  update({ fresh: true, seed });
}

/* Follow the address: whether it has a state. */
function follow() {
  const known = address.read();
  if (known?.state) {
    const { name, shape } = data.presets.find((one) => one.name === known.preset) || data.presets[0];
    enter(name, known.state, isEnds(known.state) ? shape : null);
  } else if (known) {
    begin(data.presets[0].name);
    set(element("message"), "This link is not complete: copy it again from the page.");
  }
  return known !== null;
}

// a shape of the state

/* how: fresh, for another rod; chosen, for another equilibrium; refit, for a rod that must be seen whole. */
function update(how = {}) {
  const since = performance.now();
  moves += 1;
  try {
    const one = caseOf(me.state, letters),
      near = how.seed ? { ...how.seed, one } : served && (how.fresh || how.chosen) ? null : me.shape;
    if (one.varies && !served) throw new Refused(SERVER);
    const shape = one.varies ? null : one.kind === "start" ? marched(core, one) : neighbour(one, near);
    if (!shape && served) return askShape(one, how, since);
    again = null;
    if (shape) return took(shape, { method: "in this page" }, how, since);
    throw new Refused("No equilibrium was found next to the one before. Move the slider back, or use workbench explore.");
  } catch (error) {
    return refuse(error);
  }
}

/* The shape between two ends next to another one, or null. */
const neighbour = (one, near) => (near?.one.kind === "ends" && !near.one.varies ? moved(core, one, near) : null);

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
    const lost = !how.fresh && !how.chosen, // the state names the equilibrium of an earlier one
      head = await post("/shape", { state: me.state, lost });
    if (isOld()) return;
    const { error, condition, numbers, contacts, point_forces, equilibrium } = head,
      arrays = Object.fromEntries(Object.entries(head.arrays).map(([name, row]) => [name, Float64Array.from(row)])),
      facts = { error: error ?? NaN, condition: condition ?? NaN, sound: true, shown: 1, numbers };
    if (one.leaves) Object.assign(facts, { contacts, pointForces: point_forces });
    if (equilibrium) me.state.equilibrium = equilibrium; // that was let go
    took(interpolated(core, one, arrays, facts), head, how, since);
  } catch (error) {
    if (!isOld()) refuse(error);
  } finally {
    me.busy = false;
    const next = again;
    again = null;
    if (next) update(next);
  }
}

function took(shape, head, how, since) {
  const solved = performance.now(),
    isOther = (name) => me.shape?.one[name] !== shape.one[name],
    refit = how.refit || how.chosen || isOther("side") || isOther("kind") || isOther("leaves");
  Object.assign(me, { shape, head, wrong: { sentence: "", field: "" } });
  const locked = element("lock").checked && view.drawn && !how.fresh ? view.drawn.scale : null;
  view.show(shape, { fresh: how.fresh, refit: refit && locked === null, scale: locked });
  const drawn = performance.now();
  diagrams.show(shape, me.state.units, view.drawn.scale);
  shown.showState();
  showSubject(shape.one.side);
  me.drawn += 1;
  document.dispatchEvent(
    new CustomEvent("drawn", {
      detail: { since, solve: solved - since, draw: drawn - solved, diagrams: performance.now() - drawn },
    }),
  );
  later("numbers", PATIENCE.numbers, afterwards);
  if (shape.one.kind !== "ends") {
    clearTimeout(timers.list);
    me.list = [];
    return;
  }
  if (shape.one.varies) return;
  if (served && (!how.chosen || !me.list.length)) later("list", PATIENCE.list, equilibria.ask);
}

function showSubject(side) {
  const subject = `A rod ${side === "inside" ? "in" : "on"} a cylinder`;
  set(element("subject"), subject);
  document.title = subject;
  element("page").dataset.subject = subject; // of a print
}

function afterwards() {
  shown.showNumbers();
  link();
  if (served) later("more", PATIENCE.more, shown.askNumbers);
}

function later(name, wait, work) {
  clearTimeout(timers[name]);
  timers[name] = setTimeout(work, wait);
}

function refuse(error) {
  if (!(error instanceof Refused)) throw error;
  if (!error.sentence) return;
  me.wrong = { sentence: error.sentence, field: error.field };
  shown.showState();
}

// the address, and what is pressed

/* The same rod between its two ends: the shape stays, and the state names it. */
function byEnds() {
  const { shape, state } = me,
    { energy } = observables(shape);
  if (shape.one.varies)
    return refuse(new Refused("A rod with weight or friction is not taken between its ends here: give Ends."));
  if (shape.shown < 1)
    return refuse(new Refused("Only a part of this rod is shown, so its far end is not known: make it shorter."));
  me.state = heldState(state, shape.one, shape.beta[shape.beta.length - 1], { dbeta0: shape.dbeta[0], energy });
  me.centre = copied(me.state.base);
  return update({ refit: true, seed: shape });
}

const link = () => address.show({ preset: me.preset, state: me.state });

function prepare() {
  element("preset").append(...data.presets.map((one) => new Option(one.title, one.name)));
  element("sliding").append(...SLIDING.map((one) => new Option(one, one)));
  element("reading").append(...Object.entries(data.readings).map(([name, [words]]) => new Option(words, name)));
  element("no-webgl").hidden = Boolean(view.scene);
  for (const button of document.querySelectorAll(".served")) button.hidden = !served;
  const acts = {
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
  const chosen = {
    preset: begin,
    reading: (reading) => (Object.assign(me.state, { reading }), update()),
    sliding: (sliding) => (Object.assign(me.state.base, { sliding }), update({ refit: true })),
    contact: (kind) => (setContact(me.state, kind === "unilateral"), update({ refit: true, chosen: true })),
    side: (side) => (Object.assign(me.state.base, { side }), update({ refit: true })),
    push: view.showPush,
  };
  for (const [id, act] of Object.entries(chosen))
    element(id).addEventListener("change", ({ target }) => act(target.value));
  element("cursor").addEventListener("input", (event) =>
    shown.setCursor((Number(event.target.value) / 1000) * me.shape.s[me.shape.s.length - 1]),
  );
  view.picked = shown.setCursor;
  dark.addEventListener("change", () => {
    theme.forget();
    diagrams.paint();
    equilibria.branches.paint();
  });
  window.addEventListener("hashchange", follow);
}

async function start() {
  core = await coreOf(data.core);
  prepare();
  if (!follow()) begin(data.presets[0].name);
}

globalThis.page = Object.assign(me, { begin, enter, update, view, ...equilibria });
start();
