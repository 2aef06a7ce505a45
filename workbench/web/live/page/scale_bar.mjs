// A bar of a round length along the axis, as long as a camera sees it.

import { number } from "./text.mjs";

const LONGEST = 100, // pixels
  SHORTEST = 12; // of one that says anything: the camera looks along the axis

/* Set the bar for a view in a canvas. */
export function showScale(box, { camera, drawn }, canvas, unit) {
  const perUnit = (Math.abs(Math.cos(camera.elevation)) * drawn.squeeze * canvas.clientHeight) / (2 * camera.half),
    power = 10 ** Math.floor(Math.log10(LONGEST / perUnit)),
    length = power * [5, 2, 1].find((one) => one * power * perUnit <= LONGEST);
  box.hidden = !(length * perUnit > SHORTEST) || Math.cos(camera.elevation) < 0.3;
  box.style.setProperty("--wide", `${(length * perUnit).toFixed(1)}px`);
  const text = `${number(length)} ${unit} along the axis`;
  if (box.textContent !== text) box.textContent = text;
}
