// The view of the rod: what is drawn, from where, and the hands that turn it.

import { between, facing, fitted, needsFit, seen, turned } from "./camera.mjs";
import { scaleOf } from "./colours.mjs";
import { make } from "./details.mjs";
import { hands } from "./hands.mjs";
import { coveredTube, wallLight } from "./light.mjs";
import { makeOverlay } from "./overlay.mjs";
import { contactMarks, pushMarks, tallest } from "./push_marks.mjs";
import { range } from "./range.mjs";
import { pointAt } from "./rod_shape.mjs";
import { makeScene } from "./scene.mjs";
import { circle, cylinder, rings, sidesFor, squeezeOf, tube } from "./tube.mjs";

const FINE = 0.12,
  COARSE = 0.8; // pixels that the tube may be off at rest, and while a slider moves
const WIDE = 1.15; // aspect of a view along which a rod may lie
const REST = 160,
  EASE = 240; // ms until all is drawn finely, and of a change of the camera
const BUDGET = 2.5,
  COARSEST = 3; // ms that drawing may take while a slider moves; largest factor by which pixels grow
const LOST = "The browser has stopped drawing in three dimensions here. The rod comes back as soon as the browser allows it.";
const AROUND = circle(24);

/* The view in a canvas. code: the colours of the push. calm: whether the camera must not move by itself. A long
   rod lies along a wide view. */
export function makeView(canvas, mark, code, calm) {
  const me = { shape: null, drawn: null, camera: null, target: null, ratio: 1, touched: false, at: null, push: "colours" };
  Object.assign(me, { picked: () => {}, moved: () => {} });
  let resting = 0,
    easing = 0;
  const told = noteBeside(canvas);
  const scene = makeScene(canvas, code, (lost) => {
    told(lost ? LOST : "");
    if (me.shape) over.placeRings();
    if (lost || !me.shape) return;
    filled();
    weigh();
  });
  const frontOf = (shape) => facing(shape, aspect() > WIDE);
  const aspect = () => Math.max(canvas.clientWidth, 1) / Math.max(canvas.clientHeight, 1);
  const pixelRatio = () => window.devicePixelRatio || 1;

  /* Draw a shape. fresh: seen from its front; refit: at least with all of it in the view; scale: that of its colours. */
  function show(shape, { fresh = false, refit = false, scale: given = null } = {}) {
    const squeeze = squeezeOf(shape),
      wall = cylinder(shape, squeeze),
      scale = given ?? scaleOf(code, range(shape.push));
    const drawn = { squeeze, wall, scale, points: pointsOf(shape, squeeze, wall) };
    Object.assign(me, { shape, drawn });
    setRings([]); // they take longer than a move of a slider may
    if (fresh || !me.camera) {
      me.camera = frontOf(shape);
      me.touched = false;
    }
    const bounds = boundsFrom(me.camera),
      mustFit = fresh || refit || !me.camera.half;
    if (mustFit) me.touched = false;
    if (!me.camera.half || fresh) jump(fitted(me.camera, bounds, aspect()));
    else if (mustFit || (!me.touched && needsFit(me.target, bounds, aspect())))
      ease(fitted(me.camera, bounds, aspect()));
    if (!scene) return;
    filled();
    if (fresh) weigh();
  }

  /* Give the scene the wall and the rod, and draw them. */
  function filled() {
    const { wall } = me.drawn,
      { one } = me.shape,
      reach = Math.max(one.R, range(me.shape.x.map((v, i) => Math.hypot(v, me.shape.y[i])))[1] + reachOf(one));
    scene.setWall(wall, one.sign < 0, 2 * (reach + Math.max(Math.abs(wall.low), Math.abs(wall.high))));
    mesh(COARSE * me.ratio, true);
    paint(false);
    later();
  }

  function mesh(pixels, moves = false) {
    const { shape, drawn } = me,
      tolerance = (pixels * 2 * me.target.half) / Math.max(canvas.clientHeight * pixelRatio(), 1),
      chosen = setRod(scene, shape, drawn, tolerance, moves);
    scene.setMarks(pushMarks(me.push, shape, chosen, drawn.squeeze, drawn.scale.end), contactMarks(shape, drawn.squeeze));
    scene.setLight(wallLight(shape, drawn.squeeze, drawn.wall, code, moves), shape.one.a);
    me.rings = chosen.length;
  }

  function paint(fine) {
    if (!scene || !me.shape) return;
    scene.draw(me.camera, pixelRatio() / (fine ? 1 : me.ratio), fine);
    place();
  }

  /* Where drawing is slow (no graphics card), fewer pixels while something moves. */
  function weigh() {
    me.ratio = 1;
    (paint(false), scene.wait());
    const from = performance.now();
    (paint(false), scene.wait());
    me.ratio = Math.min(Math.max(Math.sqrt((performance.now() - from) / BUDGET), 1), COARSEST);
  }

  function later() {
    clearTimeout(resting);
    resting = setTimeout(() => {
      if (scene && me.shape) {
        mesh(FINE);
        paint(true);
      }
    }, REST);
  }

  function ease(to) {
    const from = me.camera,
      begun = performance.now();
    me.target = to;
    cancelAnimationFrame(easing);
    if (calm()) {
      me.camera = to;
      paint(false);
      later();
      return;
    }
    const step = (now) => {
      const share = Math.min(Math.max((now - begun) / EASE, 0), 1);
      me.camera = share < 1 ? between(from, to, share) : to;
      (paint(false), later());
      if (share < 1) easing = requestAnimationFrame(step);
    };
    easing = requestAnimationFrame(step);
  }

  /* At once; a change of the camera that is under way ends. */
  const jump = (camera) => {
    cancelAnimationFrame(easing);
    me.camera = me.target = camera;
  };
  const moveTo = (camera) => {
    jump(camera);
    paint(false);
    later();
  };
  /* How far what is drawn reaches from the centreline. */
  const reachOf = (one) =>
    one.a + ((me.push !== "colours" || me.shape.pointForces?.length) && one.sign > 0 ? tallest(one) : 0);
  const boundsFrom = (camera) => seen(camera, me.drawn.points, reachOf(me.shape.one));

  /* All of the rod, from the same side. */
  function fit() {
    me.touched = false;
    ease(fitted(me.camera, boundsFrom(me.camera), aspect()));
  }

  /* All of the rod, from its front. */
  function front() {
    const camera = frontOf(me.shape),
      full = 2 * Math.PI,
      way = camera.azimuth - me.camera.azimuth;
    me.touched = false;
    ease(
      fitted({ ...camera, azimuth: me.camera.azimuth + way - full * Math.round(way / full) }, boundsFrom(camera), aspect()),
    );
  }

  /* Show the push as "colours", and as "ribbon" or "arrows" too. */
  function showPush(kind) {
    me.push = kind;
    if (!me.shape) return;
    ease(fitted(me.camera, boundsFrom(me.camera), aspect()));
    if (scene) filled();
  }

  const turn = (by, up) => {
    const camera = turned(me.camera, by, up);
    moveTo(me.touched ? camera : keepSize(fitted(camera, boundsFrom(camera), aspect())));
  };
  const keepSize = (camera) => ({ ...camera, half: Math.max(camera.half, me.camera.half) });
  const zoom = (factor) => {
    me.touched = true;
    moveTo({ ...me.camera, half: me.camera.half / factor });
  };
  const shift = (x, y) => {
    const size = (2 * me.camera.half) / canvas.clientHeight;
    me.touched = true;
    moveTo({ ...me.camera, x: me.camera.x - x * size, y: me.camera.y + y * size });
  };

  const over = makeOverlay(canvas, mark, me, scene),
    { setMark, setRings, place } = over;
  if (scene) hands(canvas, { turn, zoom, shift, fit, picked: (x, y) => me.picked(x === null ? null : over.sAt(x, y)) });
  new ResizeObserver(() => {
    if (me.shape) {
      if (!me.touched) jump(fitted(me.camera, boundsFrom(me.camera), aspect()));
      paint(false);
      later();
    }
  }).observe(canvas);
  return Object.assign(me, {
    scene,
    bounds: boundsFrom,
    show,
    fit,
    front,
    showPush,
    turn,
    setMark,
    setRings,
    paint,
    pixels: (w, h) => picture(me, scene, w, h),
    rest: () => {
      clearTimeout(resting);
      mesh(FINE);
      paint(true);
    },
  });
}

/* A sentence in place of the picture, "" for none. */
function noteBeside(canvas) {
  const note = make("p", { className: "lost", role: "status" });
  canvas.after(note);
  return (text) => {
    note.textContent = text;
    canvas.style.opacity = text ? 0 : 1; // browsers draw a sign of their own
  };
}

/* Give the scene the rod, so that it is off by no more than a length; returns the stations of its rings. */
function setRod(scene, shape, { squeeze, scale }, tolerance, moves = false) {
  const chosen = rings(shape, tolerance, scale.end, moves),
    sides = sidesFor(shape.one.a, tolerance),
    covered = coveredTube(shape, chosen, sides, squeeze);
  scene.setRod(tube(shape, chosen, sides, squeeze, scale.end), chosen.length, sides, covered);
  return chosen;
}

/* The scene as pixels of a picture, as fine as it is large. */
function picture(me, scene, width, height) {
  setRod(scene, me.shape, me.drawn, (FINE * 2 * me.camera.half) / height);
  return scene.pixels(me.touched ? me.camera : fitted(me.camera, me.bounds(me.camera), width / height), width, height);
}

/* The points that a view must contain: the rod's centreline and the ends of the wall. */
function pointsOf(shape, squeeze, { low, high }) {
  const { one } = shape,
    n = shape.s.length,
    found = new Float32Array(3 * (n + 2 * AROUND.length));
  for (let i = 0; i < n; i++) found.set(pointAt(shape, i, squeeze), 3 * i);
  const inner = one.sign > 0 ? one.R - one.a : one.R;
  [low, high].forEach((height, k) =>
    AROUND.forEach(([c, s], i) => found.set([inner * c, inner * s, height], 3 * (n + k * AROUND.length + i))),
  );
  return found;
}
