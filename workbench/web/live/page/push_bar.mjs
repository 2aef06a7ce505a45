// The bar of the colours of the push: its name, the colours, and ticks below them.

import { ramp, wordsOf } from "./colours.mjs";
import { minus, tickText, ticks } from "./text.mjs";

const TICKS = 4,
  TONES = 256;

/* Show a scale in a box of a name, a canvas and ticks. */
export function showBar(box, code, scale, unit) {
  const { low, end } = scale,
    key = `${low} ${end} ${unit}`,
    [name, pushes, canvas, marks] = [".name", ".pushes", "canvas", ".ticks"].map((part) => box.querySelector(part));
  if (box.dataset.shown === key) return;
  box.dataset.shown = key;
  name.textContent = minus(end > 0 ? wordsOf(code, scale, unit) : "no push");
  pushes.hidden = !(end > 0);
  if (pushes.hidden) return;
  Object.assign(canvas, { width: TONES, height: 1 });
  canvas.getContext("2d").putImageData(new ImageData(ramp(code, TONES, low / end), TONES, 1), 0, 0);
  marks.replaceChildren(
    ...ticks(low, end, TICKS).map((value) => {
      const mark = document.createElement("span");
      mark.textContent = tickText(value, end);
      mark.style.left = `${(100 * (value - low)) / (end - low)}%`;
      return mark;
    }),
  );
}
