// The diagrams beside the rod: their canvases, and the cursor that they share with the rod.

import { diagrams, valuesAt } from "./curves.mjs";
import { make, set } from "./details.mjs";
import { frameOf, paintCursor, paintDiagram, paper, titleOf } from "./diagram.mjs";

const [WIDTH, HEIGHT] = [370, 165],
  PRINTED = 3; // pixels of a canvas for one of the page, at least, on paper

/* The diagrams in `box`, the last of them folded; the unrolled view, which has the axis of the rod above it, in
   `below`. */
export function makeDiagrams(box, below, code, theme, pointed) {
  let shown = [],
    shape = null,
    at = null,
    end = 0,
    fine = 1,
    wasOpen = false;
  const folded = make("details", {}, make("summary", { textContent: "One more diagram" }));
  folded.addEventListener("toggle", paint);

  function build(specs) {
    for (const place of [box, below]) place.replaceChildren();
    shown = specs.map((spec) => {
      const title = make("figcaption"),
        canvas = make("canvas", { id: `d-${spec.key}`, role: "img" });
      const place = { developed: below, well: folded }[spec.key] ?? box;
      place.append(make("figure", { className: "diagram" }, title, canvas));
      const one = { canvas, title, spec, frame: null };
      for (const name of ["pointerdown", "pointermove"])
        canvas.addEventListener(name, (event) => pointed(nearest(one, event.offsetX, event.offsetY)));
      canvas.addEventListener("pointerleave", (event) => event.pointerType !== "touch" && pointed(null)); // a finger may leave
      return one;
    });
    box.append(folded);
  }

  function show(next, units, scale) {
    [shape, end] = [next, scale.end];
    const specs = diagrams(shape, units);
    if (!shown.length) build(specs);
    shown.forEach((one, i) => {
      one.spec = specs[i];
      one.canvas.setAttribute("aria-label", specs[i].title);
    });
    paint();
  }

  function paint() {
    if (!shape) return;
    const ratio = Math.max(window.devicePixelRatio || 1, fine),
      here = at === null ? null : valuesAt(shape, at);
    const frames = (left) =>
      shown.map(({ canvas, spec }) => frameOf(spec, canvas.clientWidth || WIDTH, spec.height || HEIGHT, left));
    const left = Math.max(...frames().map((frame) => frame.left)); // of all, so that one place is above the other
    frames(left).forEach((frame, k) => (shown[k].frame = frame));
    for (const one of shown) {
      const ctx = paper(one.canvas, one.frame.width, one.frame.height, ratio);
      set(one.title, titleOf(one.spec, one.frame));
      paintDiagram(ctx, one.spec, one.frame, theme(), code, end);
      if (here) paintCursor(ctx, one.frame, one.spec.cursor(here), one.spec.alongRod, theme());
    }
  }

  /* The s that a pointer in a diagram means, or null. */
  function nearest({ frame, spec }, x, y) {
    const { s, beta, alpha, z } = shape;
    if (spec.alongRod) return Math.min(Math.max(frame.back(x), 0), s[s.length - 1]);
    let best = null,
      least = 30 ** 2;
    for (let i = 0; i < s.length; i++) {
      const [u, v] = spec.cursor({ beta: beta[i], alpha: alpha[i], z: z[i] }),
        off = (frame.px(u) - x) ** 2 + (spec.byX ? 0 : (frame.py(v) - y) ** 2);
      if (off < least) [best, least] = [s[i], off];
    }
    return best;
  }

  const watch = new ResizeObserver(() => paint());
  for (const place of [box, below]) watch.observe(place);
  return {
    show,
    paint,
    setCursor: (s) => {
      at = s;
      paint();
    },
    onPaper: (on) => {
      fine = on ? PRINTED : 1;
      if (on) wasOpen = folded.open;
      folded.open = on || wasOpen; // paper cannot be unfolded
      paint();
    },
  };
}
