// A view of the rod with what stands about it: triad, scale, bar of colours, badges, two buttons.

import { axesOf, dot } from "./camera.mjs";
import { ramp, wordsOf } from "./colours.mjs";
import { make, putPixels, set } from "./details.mjs";
import { makeView } from "./rod_view.mjs";
import { crossings, tightBends } from "./self_contact.mjs";
import { PUSH, minus, number, stated, tickText, ticks } from "./text.mjs";

/* The stage in a canvas. part: the element of a name. unit: that of length. The others: as of `makeView`. */
export function makeStage(canvas, mark, part, code, calm, unit) {
  const view = makeView(canvas, mark, code, calm);
  view.moved = (camera) => {
    drawTriad(part("triad"), camera);
    showScale(part("scale"), view, canvas, unit());
  };
  for (const name of ["fit", "front"]) part(name).addEventListener("click", () => view[name]());

  /* The colours of what is drawn, and whether its axis is compressed. units: of the case. */
  function showLegend(units) {
    const { squeeze, scale } = view.drawn;
    part("squeeze").hidden = squeeze >= 1;
    set(part("squeeze"), `Axis compressed 1 : ${(1 / squeeze).toPrecision(3)}`);
    showBar(part("bar"), code, scale, stated(PUSH, units));
  }

  /* Ring the places where a shape passes through itself, which takes longer than a move of a slider may, and its tight bends;
     the first of these. */
  function showCrossings(shape) {
    const crossed = crossings(shape),
      rung = [...crossed, ...tightBends(shape, crossed)];
    view.setRings(rung);
    part("crossed").hidden = !rung.length;
    return crossed;
  }

  return { view, showLegend, showCrossings };
}

const LONGEST = 100, // pixels
  SHORTEST = 12; // of one that says anything: the camera looks along the axis

/* Set the bar of a round length along the axis, as long as the camera of a view sees it. */
function showScale(box, { camera, drawn }, canvas, unit) {
  const perUnit = (Math.abs(Math.cos(camera.elevation)) * drawn.squeeze * canvas.clientHeight) / (2 * camera.half),
    power = 10 ** Math.floor(Math.log10(LONGEST / perUnit)),
    length = power * [5, 2, 1].find((one) => one * power * perUnit <= LONGEST);
  box.hidden = !(length * perUnit > SHORTEST) || Math.cos(camera.elevation) < 0.3;
  box.style.setProperty("--wide", `${(length * perUnit).toFixed(1)}px`);
  set(box, `${number(length)} ${unit} along the axis`);
}

const TICKS = 3,
  TONES = 256;

/* Show the colours of the push in a box of their name, a canvas and ticks. */
function showBar(box, code, scale, [unit, size]) {
  const [low, end] = [scale.low * size, scale.end * size],
    key = `${low} ${end} ${unit}`,
    [name, pushes, canvas, marks] = [".name", ".pushes", "canvas", ".ticks"].map((part) => box.querySelector(part));
  if (box.dataset.shown === key) return;
  box.dataset.shown = key;
  name.textContent = minus(end > 0 ? wordsOf(code, scale, unit) : "no push");
  pushes.hidden = !(end > 0);
  if (pushes.hidden) return;
  Object.assign(canvas, { width: TONES, height: 1 });
  putPixels(canvas, ramp(code, TONES, low / end));
  marks.replaceChildren(
    ...ticks(low, end, TICKS).map((value) => {
      const mark = make("span", {}, tickText(value, end));
      mark.style.left = `${(100 * (value - low)) / (end - low)}%`;
      return mark;
    }),
  );
}

const ARM = 26,
  LETTER = 10, // beyond the end of its arm
  CLEAR = 9, // of the other arms
  MIDDLE = 44; // pixels
const AXES = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };

/* Draw the directions of the axes x, y and z as the camera sees them into an SVG element. */
function drawTriad(box, camera) {
  if (!box.firstChild) prepare(box);
  const { right, up, toward } = axesOf(camera),
    seen = (way) => [dot(way, right), -dot(way, up)];
  for (const [name, way] of Object.entries(AXES)) {
    const [arm, letter] = [box.querySelector(`line.${name}`), box.querySelector(`text.${name}`)];
    const [x, y] = seen(way),
      size = Math.hypot(x, y),
      far = ARM + LETTER / Math.max(size, 0.2),
      others = Object.keys(AXES).filter((other) => other !== name),
      [u, v] = others.reduce((place, other) => clearOf(place, seen(AXES[other])), [far * x, far * y]);
    arm.setAttribute("x2", (MIDDLE + ARM * x).toFixed(1));
    arm.setAttribute("y2", (MIDDLE + ARM * y).toFixed(1));
    letter.setAttribute("x", (MIDDLE + u).toFixed(1));
    letter.setAttribute("y", (MIDDLE + v).toFixed(1));
    const shown = size > 0.25 || dot(way, toward) > 0 ? "1" : "0.4";
    arm.setAttribute("opacity", shown);
    letter.setAttribute("opacity", size > 0.2 ? shown : "0");
  }
}

/* The place of a letter, moved off the arm in the direction (x, y) where it stands on it; both from where the arms begin. */
export function clearOf([u, v], [x, y]) {
  const size = Math.hypot(x, y),
    along = (u * x + v * y) / size,
    off = (v * x - u * y) / size;
  if (!(along > 0 && along < ARM * size + CLEAR && Math.abs(off) < CLEAR)) return [u, v];
  const more = (off < 0 ? -CLEAR : CLEAR) - off;
  return [u - (more * y) / size, v + (more * x) / size];
}

function prepare(box) {
  for (const name of Object.keys(AXES)) {
    const arm = document.createElementNS(box.namespaceURI, "line"),
      letter = document.createElementNS(box.namespaceURI, "text");
    arm.setAttribute("class", name);
    arm.setAttribute("x1", MIDDLE);
    arm.setAttribute("y1", MIDDLE);
    letter.setAttribute("class", name);
    letter.textContent = name;
    box.append(arm, letter);
  }
}
