// The rod as a tube and the cylinder as a wall: rings where the shape needs them, and their triangles.

import { range } from "./range.mjs";

const LEAST_SIDES = 8,
  MOST_SIDES = 40;
const SHADE = 0.2; // rad by which a section may turn between two rings, or the light on the tube has edges
const TONES = 24; // rings at least from no push to the largest
const ROUGH = 2.5; // times as far apart, while a slider moves
export const TALLEST = 9; // diameters; a taller scene is compressed along the axis, or the rod would be too thin
export const STRIDE = 7; // numbers of a corner: place, normal, push as a share of the largest
const AROUND = 120; // sides of the wall

/* By which factor the axis is compressed, at most 1. */
export function squeezeOf({ one, z }) {
  const [low, high] = range(z);
  return Math.min(1, (TALLEST * 2 * Math.max(one.R, one.rho + one.a)) / Math.max(high - low, 1e-300));
}

/* The stations at which rings stand, so that the tube is off by no more than a length; largest: the largest push.
   moves: whether the light and the colours may be rougher. */
export function rings(shape, tolerance, largest, moves = false) {
  const { one, s, beta, kappa, dbeta, push } = shape,
    chosen = [0],
    last = s.length - 1,
    rough = moves ? ROUGH : 1;
  let due = 0;
  for (let i = 1; i <= last; i++) {
    const h = Math.max(s[i] - s[i - 1], 1e-300),
      turn = Math.hypot(dbeta[i], Math.sin(beta[i]) / one.rho);
    const faster =
      (Math.abs(dbeta[i] - dbeta[i - 1]) + Math.abs(Math.sin(beta[i]) - Math.sin(beta[i - 1])) / one.rho) / h;
    const bend = kappa[i] + one.a * (turn * turn + faster); // of the lines along the surface, at most
    const rate = Math.max(Math.sqrt(bend / (8 * tolerance)), turn / (SHADE * rough));
    const tones = largest > 0 ? ((TONES / rough) * Math.abs(push[i] - push[i - 1])) / largest : 0;
    const step = Math.max(rate * h, tones);
    if (due > 0 && due + step > 1) {
      chosen.push(i - 1);
      due = 0;
    }
    due += step;
  }
  chosen.push(last);
  return chosen;
}

/* The number of sides with which a section is off by no more than a length; even, so that a corner touches the wall. */
export function sidesFor(a, tolerance) {
  const n = Math.PI / Math.acos(Math.max(1 - tolerance / a, 0));
  return Math.min(Math.max(2 * Math.ceil(n / 2), LEAST_SIDES), MOST_SIDES);
}

/* The corners of the tube: rings one after the other, then of each flat end a ring and its middle. */
export function tube(shape, chosen, sides, squeeze, largest) {
  const { one } = shape,
    count = chosen.length,
    corners = new Float32Array(STRIDE * (count * sides + 2 * (sides + 1))),
    around = circle(sides);
  let at = 0;
  const put = (...numbers) => {
    for (const v of numbers) corners[at++] = v;
  };
  const ring = (frame, flat) => {
    const { x, y, z, ox, oy, oz, bx, by, bz, value } = frame;
    for (const [c, d] of around) {
      const nx = c * ox + d * bx,
        ny = c * oy + d * by,
        nz = c * oz + d * bz;
      corners[at] = x + one.a * nx;
      corners[at + 1] = y + one.a * ny;
      corners[at + 2] = z + one.a * nz;
      corners[at + 3] = flat ? flat[0] : nx;
      corners[at + 4] = flat ? flat[1] : ny;
      corners[at + 5] = flat ? flat[2] : nz;
      corners[at + 6] = value;
      at += STRIDE;
    }
  };
  const frames = framesAt(shape, chosen, squeeze, largest);
  for (const frame of frames) ring(frame);
  for (const [frame, way] of [
    [frames[0], -1],
    [frames[count - 1], 1],
  ]) {
    const flat = frame.along.map((v) => way * v);
    ring(frame, flat);
    put(frame.x, frame.y, frame.z, ...flat, frame.value);
  }
  return corners;
}

/* Place, outward normal, binormal and tangent of the drawn curve at a station, and the push there as a share. */
export function frameAt({ x, y, z, alpha, beta, tilt, push }, i, squeeze, largest) {
  const [u, v] = [Math.sin(beta[i]), squeeze * Math.cos(beta[i])],
    b = squeeze < 1 ? Math.atan2(u, v) : beta[i],
    lean = squeeze < 1 ? Math.atan2(Math.sin(tilt[i]), Math.cos(tilt[i]) * Math.hypot(u, v)) : tilt[i];
  const [ca, sa, cb, sb, ct, st] = [alpha[i], b, lean].flatMap((angle) => [Math.cos(angle), Math.sin(angle)]),
    [ax, ay, az] = [-sb * sa, sb * ca, cb]; // the tangent without the tilt
  return {
    x: x[i],
    y: y[i],
    z: squeeze * z[i],
    ox: ct * ca - st * ax,
    oy: ct * sa - st * ay,
    oz: -st * az,
    bx: cb * sa,
    by: -cb * ca,
    bz: sb,
    along: [ct * ax + st * ca, ct * ay + st * sa, ct * az],
    value: largest > 0 ? push[i] / largest : 0,
  };
}

/* The frames of rings. Off the wall each is turned about the tangent as little as it can be from the one before: the
   azimuth of a rod near the axis says nothing of its section. */
export function framesAt(shape, chosen, squeeze, largest) {
  const frames = chosen.map((i) => frameAt(shape, i, squeeze, largest));
  if (shape.one.leaves) frames.forEach((frame, k) => k && unturn(frame, frames[k - 1]));
  return frames;
}

function unturn(frame, { ox, oy, oz }) {
  const u = ox * frame.ox + oy * frame.oy + oz * frame.oz,
    v = ox * frame.bx + oy * frame.by + oz * frame.bz,
    size = Math.hypot(u, v) || 1;
  for (const k of ["x", "y", "z"]) {
    const [o, b] = [frame[`o${k}`], frame[`b${k}`]];
    frame[`o${k}`] = (u * o + v * b) / size;
    frame[`b${k}`] = (u * b - v * o) / size;
  }
}

/* The triangles of a tube's wall between rings, in order, so that the first belong to a tube of fewer rings. */
export function wallTriangles(count, sides) {
  const found = new Uint32Array(6 * (count - 1) * sides);
  let at = 0;
  for (let i = 0; i < count - 1; i++)
    for (let j = 0; j < sides; j++) {
      const a = i * sides + j,
        b = i * sides + ((j + 1) % sides),
        c = b + sides,
        d = a + sides;
      found.set([a, c, b, a, d, c], at);
      at += 6;
    }
  return found;
}

/* The triangles of the two flat ends, which follow `first` corners. */
export function endTriangles(first, sides) {
  const found = [];
  for (const [start, way] of [
    [first, -1],
    [first + sides + 1, 1],
  ])
    for (let j = 0; j < sides; j++) {
      const a = start + j,
        b = start + ((j + 1) % sides),
        middle = start + sides;
      found.push(...(way > 0 ? [a, middle, b] : [a, b, middle]));
    }
  return Uint32Array.from(found);
}

/* Corners and triangles of the cylinder, a little longer than the rod; with flat ends where the rod lies outside. */
export function cylinder({ one, z }, squeeze) {
  const beyond = one.a + 0.35 * one.R,
    [least, most] = range(z),
    [low, high] = [squeeze * least - beyond, squeeze * most + beyond],
    around = circle(AROUND),
    corners = [],
    rim = (height, normal) => around.forEach(([c, s]) => corners.push(one.R * c, one.R * s, height, ...normal(c, s), 0));
  for (const height of [low, high]) rim(height, (c, s) => [c, s, 0]);
  let triangles = wallTriangles(2, AROUND);
  if (one.sign > 0) {
    for (const [height, way] of [
      [low, -1],
      [high, 1],
    ]) {
      rim(height, () => [0, 0, way]);
      corners.push(0, 0, height, 0, 0, way, 0);
    }
    triangles = Uint32Array.from([...triangles, ...endTriangles(2 * AROUND, AROUND)]);
  }
  // the rings of the rod run the other way around
  for (let i = 0; i < triangles.length; i += 3) [triangles[i + 1], triangles[i + 2]] = [triangles[i + 2], triangles[i + 1]];
  return { corners: Float32Array.from(corners), triangles, low, high };
}

/* Cosine and sine of so many angles, evenly around. */
export const circle = (n) =>
  Array.from({ length: n }, (_, j) => [Math.cos((2 * Math.PI * j) / n), Math.sin((2 * Math.PI * j) / n)]);
