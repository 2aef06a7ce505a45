// The branch diagram: an observable along the branches of equilibria, over a load or an end angle. A click takes the rod
// that is drawn there.

import { set } from "./details.mjs";
import { frameOf, paintDiagram, paper, spot } from "./diagram.mjs";
import { quantityOf } from "./rod_case.mjs";
import { minus, stated } from "./text.mjs";

const HIGH = 230,
  NEAR = 14, // pixels from the pointer
  SHARE = 0.25; // of the slider of a field, to either side
const STABLE = [2.6, "ink"],
  UNSTABLE = [1.2, "soft"]; // pixels and colour of a line, as in the figures
const LIMIT = "Not all branches are drawn: the page follows them for 8 s. The command workbench equilibria --axis has no limit.";

/* The stretches of a piece of a branch, of its field x and its values y: of a count those of one number each, as nobody
   knows where between two points it changes. */
export function runs(x, y, isCount) {
  const ends = [...y.keys()].filter((i) => i > 0 && isCount && y[i] !== y[i - 1]);
  return [0, ...ends].map((from, k) => ({ x: x.slice(from, ends[k]), y: y.slice(from, ends[k]) }));
}

/* The diagram in a figure with two menus, a canvas and a note. names: fields and what is shown. ask(body, then, refused,
   isOld): of the server. pick(field, value, equilibrium): take a rod. */
export function makeBranches(figure, names, quantities, theme, ask, pick) {
  const [shows, field] = figure.querySelectorAll("select"),
    canvas = figure.querySelector("canvas"),
    note = figure.querySelector("[role='status']");
  let now = { list: [] }, // the state, observables of its rod, the list of equilibria, and the base of their state
    curves = null,
    range = [], // of the field, over which they are followed
    key = "",
    near = null,
    frame = null;

  const titleOf = (name) => quantities[quantityOf(name)].slice(0, 2).join(", ");
  for (const [menu, list] of [
    [field, names.fields],
    [shows, names.shown],
  ])
    menu.append(...list.map((name) => new Option(titleOf(name), name)));
  field.addEventListener("change", () => follow());
  shows.addEventListener("change", () => paint());
  canvas.addEventListener("pointermove", ({ offsetX, offsetY }) => paint((near = nearest(offsetX, offsetY))));
  canvas.addEventListener("pointerleave", () => paint((near = null)));
  canvas.addEventListener("click", ({ offsetX, offsetY }) => {
    const at = curves && nearest(offsetX, offsetY);
    if (at) pick(field.value, at.field, { dbeta0: at.dbeta0, energy: at.energy });
  });
  new ResizeObserver(() => paint()).observe(canvas.parentElement);

  const unitOf = (name) => stated(quantities[quantityOf(name)][2], now.state.units, name),
    scaled = (name, value) => value * unitOf(name)[1];
  const labelOf = (name) => {
    const [[symbol], [unit]] = [quantities[quantityOf(name)], unitOf(name)];
    return unit ? `${symbol} [${unit}]` : symbol;
  };

  /* Follow the branches of a state, unless those that are drawn are its own. span: the slider's ends of a field. */
  function show(next, span) {
    now = { ...now, ...next, base: { ...next.state.base }, span };
    follow();
  }

  /* Whose branches these are: all of the state but the field along them. */
  const keyOf = () => JSON.stringify([field.value, now.state.units, { ...now.state.base, [field.value]: 0 }]);

  function follow() {
    const { state, span } = now,
      name = field.value,
      value = state.base[name],
      wanted = keyOf();
    if (wanted === key && value >= range[0] && value <= range[1]) return paint();
    const [low, high] = span(name),
      half = SHARE * (high - low),
      isOld = () => key !== wanted;
    [key, curves, range] = [wanted, null, [value - half, value + half]];
    paint();
    set(note, "following the branches …");
    const took = (reply) => {
      curves = reply;
      set(note, reply.missing ? LIMIT : "");
      paint();
    };
    const body = { state, field: name, low: range[0], high: range[1] };
    ask(body, took, (why) => set(note, why), isOld);
  }

  /* The equilibria of the list, and the points of the branches between their ends, which may be taken. */
  function* places() {
    for (const one of now.list) yield { ...one, field: now.base[field.value] };
    for (const piece of curves?.pieces || [])
      for (let k = 1; k < piece.field.length - 1; k++)
        yield Object.fromEntries(Object.keys(piece).map((name) => [name, piece[name][k]]));
  }

  const spotOf = (place) => [frame.px(scaled(field.value, place.field)), frame.py(scaled(shows.value, place[shows.value]))];

  function nearest(x, y) {
    let [best, least] = [null, NEAR];
    for (const place of places()) {
      const [u, v] = spotOf(place),
        off = Math.hypot(u - x, v - y);
      if (off < least) [best, least] = [place, off];
    }
    return best;
  }

  /* found: the observables of the rod that is shown. */
  function mark(state, found) {
    now = { ...now, state, found };
    if (key !== keyOf()) {
      [key, curves] = ["", null];
      set(note, "");
    }
    paint();
  }

  function paint() {
    const isDrawn = curves?.pieces.length > 0;
    canvas.hidden = !isDrawn;
    if (!isDrawn) return;
    const name = shows.value,
      wide = canvas.clientWidth,
      ratio = window.devicePixelRatio || 1,
      ctx = paper(canvas, wide, HIGH, ratio),
      colours = theme(),
      isCount = names.counts.includes(name),
      lines = curves.pieces.flatMap((piece) => {
        const [x, y] = [piece.field.map((value) => scaled(field.value, value)), piece[name].map((value) => scaled(name, value))];
        return runs(x, y, isCount).map((run) => ({ ...run, look: piece.index === 0 ? STABLE : UNSTABLE }));
      });
    const spec = {
      lines,
      x: lines.flatMap(({ x }) => x),
      y: lines.flatMap(({ y }) => y),
      rising: true,
      xlabel: labelOf(field.value),
      ylabel: labelOf(name),
    };
    canvas.setAttribute("aria-label", minus(`${titleOf(name)} over ${titleOf(field.value)}; the list below has the same rods`));
    frame = frameOf(spec, wide, HIGH);
    paintDiagram(ctx, spec, frame, colours);
    for (const one of now.list) spot(ctx, spotOf({ ...one, field: now.base[field.value] }), 3.2, colours.ink);
    const { found, state } = now;
    for (const [place, colour, radius] of [
      [near, colours.soft, 4.5],
      [found && { ...found, field: state.base[field.value] }, colours.mark, 6],
    ])
      if (place) spot(ctx, spotOf(place), radius, colour, 2);
  }

  return { show, mark, paint, places, spotOf };
}
