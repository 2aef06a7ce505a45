// What lies over the picture of the rod: the mark of the cursor, rings, and which s of the rod is under a pointer.

import { aside, axesOf, dot } from "./camera.mjs";
import { make } from "./details.mjs";
import { pointAt } from "./rod_shape.mjs";

const RING = 1.1,
  RINGS = [10, 26], // diameter of a ring in radii of the rod; its ends in pixels
  MOST_RINGS = 40;

/* me: the view's shape, what of it is drawn, and the camera. mark: the element of the cursor's mark. */
export function makeOverlay(canvas, mark, me, scene) {
  let rung = [];

  /* Put the mark at s, or nowhere. */
  function setMark(at) {
    me.at = at;
    place();
  }

  /* Ring the places (x, y, z) where the rod passes through itself. */
  function setRings(places) {
    for (const { box } of rung) box.remove();
    rung = places.slice(0, MOST_RINGS).map((spot) => {
      const box = make("i", { className: "ring" });
      mark.before(box);
      return { spot, box };
    });
    if (me.camera) placeRings();
  }

  function placeRings() {
    const size = (RING * me.shape.one.a * canvas.clientHeight) / (2 * me.camera.half),
      wide = Math.min(Math.max(size, RINGS[0]), RINGS[1]);
    for (const { spot: [u, v, w], box } of rung) {
      const { x, y, behind } = onScreen([u, v, me.drawn.squeeze * w]);
      box.hidden = behind || !scene || scene.isLost();
      Object.assign(box.style, { width: `${wide}px`, height: `${wide}px` });
      box.style.transform = `translate(${(x - wide / 2).toFixed(1)}px, ${(y - wide / 2).toFixed(1)}px)`;
    }
  }

  function place() {
    if (me.shape) {
      me.moved(me.camera);
      placeRings();
    }
    mark.hidden = !me.at || !me.shape || !scene;
    if (mark.hidden) return;
    const { x, y, behind } = onScreen([me.at.x, me.at.y, me.drawn.squeeze * me.at.z]);
    mark.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    mark.classList.toggle("behind", behind);
  }

  function onScreen(p) {
    const { right, up, toward } = axesOf(me.camera),
      size = canvas.clientHeight / (2 * me.camera.half),
      { one } = me.shape;
    const x = dot(p, right),
      behind = one.sign > 0 && p[0] * toward[0] + p[1] * toward[1] < 0 && Math.abs(aside(p, me.camera)) < one.R;
    return {
      x: canvas.clientWidth / 2 + (x - me.camera.x) * size,
      y: canvas.clientHeight / 2 - (dot(p, up) - me.camera.y) * size,
      depth: dot(p, toward),
      behind,
    };
  }

  /* The s of the rod under the pointer, or null. */
  function sAt(px, py) {
    if (!me.shape) return null;
    const { one, s } = me.shape,
      near = (one.a * canvas.clientHeight) / (2 * me.camera.half) + 6;
    let best = null,
      nearest = -Infinity;
    for (let i = 0; i < s.length; i++) {
      const spot = onScreen(pointAt(me.shape, i, me.drawn.squeeze)),
        off = Math.hypot(spot.x - px, spot.y - py);
      if (off > near || spot.behind) continue;
      const score = spot.depth - (off / near) * one.a * 3;
      if (score > nearest) [best, nearest] = [s[i], score];
    }
    return best;
  }

  return { setMark, setRings, placeRings, place, sAt };
}
