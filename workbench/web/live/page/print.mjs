// The page on paper: a copy of the rod, as a browser prints no WebGL, and diagrams fine enough for a printer.

import { make, putPixels } from "./details.mjs";

const FINE = 3, // pixels for one of the page
  WIDE = 1600; // pixels of the copy

/* Have a copy of the rod before its canvas while the page is printed. */
export function makePrint(canvas, view, diagrams, theme) {
  let copy = null;

  function before() {
    if (copy || !view.shape) return;
    theme.onPaper(true);
    diagrams.setFine(FINE);
    if (!view.scene || view.scene.isLost()) return;
    const [w, h] = [WIDE, Math.round((WIDE * Math.max(canvas.clientHeight, 1)) / Math.max(canvas.clientWidth, 1))];
    copy = make("canvas", { className: "printed", width: w, height: h });
    putPixels(copy, view.pixels(w, h));
    canvas.before(copy);
    view.rest();
  }

  function after() {
    theme.onPaper(false);
    diagrams.setFine(1);
    if (copy) copy.remove();
    copy = null;
  }

  window.addEventListener("beforeprint", before);
  window.addEventListener("afterprint", after);
  window.matchMedia("print").addEventListener("change", ({ matches }) => (matches ? before() : after()));
}
