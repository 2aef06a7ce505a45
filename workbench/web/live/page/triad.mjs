// The directions of the axes x, y and z as the camera sees them.

import { axesOf, dot } from "./camera.mjs";

const ARM = 26,
  LETTER = 36,
  MIDDLE = 44; // pixels
const AXES = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };

/* Draw the triad into an SVG element. */
export function drawTriad(box, camera) {
  if (!box.firstChild) prepare(box);
  const { right, up, toward } = axesOf(camera);
  for (const [name, way] of Object.entries(AXES)) {
    const [arm, letter] = [box.querySelector(`line.${name}`), box.querySelector(`text.${name}`)];
    const x = dot(way, right),
      y = -dot(way, up);
    arm.setAttribute("x2", (MIDDLE + ARM * x).toFixed(1));
    arm.setAttribute("y2", (MIDDLE + ARM * y).toFixed(1));
    letter.setAttribute("x", (MIDDLE + LETTER * x).toFixed(1));
    letter.setAttribute("y", (MIDDLE + LETTER * y).toFixed(1));
    const shown = Math.hypot(x, y) > 0.25 || dot(way, toward) > 0 ? "1" : "0.4";
    arm.setAttribute("opacity", shown);
    letter.setAttribute("opacity", Math.hypot(x, y) > 0.2 ? shown : "0");
  }
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
