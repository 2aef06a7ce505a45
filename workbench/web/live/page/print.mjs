// The page on paper: a copy of the rod, as a browser prints no WebGL.

import { make, putPixels } from "./details.mjs";

const WIDE = 1600; // pixels of the copy

/* Have a copy of the rod before its canvas while the page is printed. onPaper(on): what else changes. */
export function makePrint(canvas, view, onPaper = () => {}) {
  let copy = null;

  function before() {
    if (copy || !view.shape) return;
    onPaper(true);
    if (!view.scene || view.scene.isLost()) return;
    const [w, h] = [WIDE, Math.round((WIDE * Math.max(canvas.clientHeight, 1)) / Math.max(canvas.clientWidth, 1))];
    copy = make("canvas", { className: "printed", width: w, height: h });
    putPixels(copy, view.pixels(w, h));
    canvas.before(copy);
    view.rest();
  }

  function after() {
    onPaper(false);
    if (copy) copy.remove();
    copy = null;
  }

  window.addEventListener("beforeprint", before);
  window.addEventListener("afterprint", after);
  window.matchMedia("print").addEventListener("change", ({ matches }) => (matches ? before() : after()));
}
