// A turntable: a rod in a figure, with sliders, a colour bar and a triad.

import { scaleOf } from "./colours.mjs";
import { makeSlider } from "./controls.mjs";
import { make, set } from "./details.mjs";
import { makePrint } from "./print.mjs";
import { solvedSource, storedSource } from "./rod_sources.mjs";
import { makeStage } from "./stage.mjs";

const LAP = 12, // s of one turn
  REST = 150; // ms until what is slower is computed

/* Make a figure turn. core: the compiled core. */
export function turntable(figure, data, code, core, calm) {
  const part = (name) => figure.querySelector(`.${name}`),
    canvas = part("rod");
  const source = data.arrays ? storedSource(data, core) : solvedSource(data, core),
    scale = data.extremes ? scaleOf(code, data.extremes) : null; // one for all its rods
  figure.classList.add("live"); // now the canvas has its size
  const stage = makeStage(canvas, part("spot"), part, code, calm, () => data.units.length),
    { view } = stage;
  if (!view.scene) {
    figure.classList.remove("live");
    part("told").textContent = "This browser offers no WebGL 2, so the rod cannot be turned here.";
    return null;
  }
  const sliders = source.sliders.map((slider, k) => made(part("sliders"), slider, `${figure.id}-slider-${k}`));
  let busy = false,
    spinning = 0,
    resting = 0;

  const frames = framesOf(figure);

  function show(how = {}) {
    const { shape, note, rows = [] } = source.now();
    for (const row of sliders) row.show();
    for (const frame of frames) frame(source.sliders);
    if (note || !source.facts) set(part("told"), note);
    part("told").classList.toggle("wrong", !shape);
    listed(part("case"), rows);
    if (!shape) return;
    view.show(shape, { ...how, scale });
    clearTimeout(resting);
    resting = setTimeout(() => {
      const crossed = stage.showCrossings(shape);
      if (source.facts && !note) set(part("told"), source.facts(shape, crossed));
    }, REST);
    stage.showLegend(data.units);
  }

  /* One drawing a frame, of the newest place. */
  function changed() {
    if (busy) return;
    busy = true;
    requestAnimationFrame(() => {
      busy = false;
      show();
    });
  }

  function spin(on) {
    part("spin").setAttribute("aria-pressed", String(on));
    cancelAnimationFrame(spinning);
    let before = performance.now();
    const step = (now) => {
      view.turn((2 * Math.PI * (now - before)) / 1000 / LAP, 0);
      before = now;
      spinning = requestAnimationFrame(step);
    };
    if (on) spinning = requestAnimationFrame(step);
  }

  sliders.forEach((row, k) =>
    row.input.addEventListener("input", () => {
      source.sliders[k].move(Number(row.input.value));
      row.show();
      changed();
    }),
  );
  const acts = {
    spin: () => spin(part("spin").getAttribute("aria-pressed") !== "true"),
    front: () => spin(false),
    again: () => {
      source.reset();
      show({ refit: true });
    },
  };
  for (const [name, act] of Object.entries(acts)) part(name)?.addEventListener("click", act);
  canvas.addEventListener("pointerdown", () => spin(false));
  if (!part("still")) makePrint(canvas, view); // else paper gets the still picture
  scrollsPast(canvas);
  show({ fresh: true });
  return Object.assign(figure, { view, show, spin });
}

/* Frame, in each picture of a row of rods, the rod at the place of the slider of its axis. */
function framesOf(figure) {
  return [...figure.querySelectorAll("[data-rods]")].map((picture) => {
    const rods = JSON.parse(picture.dataset.rods),
      box = picture.querySelector(".enlarge").appendChild(make("i", { className: "framed" }));
    return (sliders) => {
      const [left, top, right, bottom] = rods[sliders[Number(picture.dataset.axis)].place()].map((share) => 100 * share);
      Object.assign(box.style, {
        left: `${left}%`,
        top: `${top}%`,
        width: `${right - left}%`,
        height: `${bottom - top}%`,
      });
    };
  });
}

/* The wheel scrolls the page until the view is touched, and again once the pointer has left it. */
function scrollsPast(canvas) {
  let held = false;
  canvas.addEventListener("pointerdown", () => (held = true));
  canvas.addEventListener("pointerleave", () => (held = false));
  const passes = (event) => {
    if (!held && !event.ctrlKey) event.stopPropagation();
  };
  canvas.parentElement.addEventListener("wheel", passes, { capture: true, passive: true });
}

function made(box, slider, id) {
  const input = makeSlider({ max: slider.most, step: slider.step || 1, id }),
    value = make("output", { htmlFor: id }),
    label = make("label", { htmlFor: id }, `${slider.words} `, make("b", {}, slider.symbol));
  box.append(make("div", {}, label, input, value));
  const show = () => {
    if (Number(input.value) !== slider.place()) input.value = slider.place();
    set(value, slider.text());
    input.setAttribute("aria-valuetext", slider.text());
  };
  return { input, show };
}

/* The observables of the rod: words and value in each row. */
function listed(box, rows) {
  box.replaceChildren(...rows.map(([words, value]) => make("div", {}, make("dt", {}, words), make("dd", {}, value))));
  box.hidden = !rows.length;
}
