// A camera without perspective that turns about the vertical axis, and what it must see.

import { range } from "./range.mjs";

const ABOVE = 0.28; // rad by which the camera looks down in the front view
const LONG = 4; // the least length of a rod that lies along a wide view, in radii of the cylinder
const STEEPEST = 1.5; // rad
export const MARGIN = 1.07; // how much more is seen than the rod
const SMALL = 0.5; // share of the view below which a rod is seen from nearer

/* The camera's directions: to the right, up, and toward the eye. lying: the axis of the cylinder runs to the right. */
export function axesOf({ azimuth, elevation, lying }) {
  const [ca, sa, ce, se] = [Math.cos(azimuth), Math.sin(azimuth), Math.cos(elevation), Math.sin(elevation)],
    along = [-se * ca, -se * sa, ce],
    toward = [ce * ca, ce * sa, se];
  return lying ? { right: along, up: [sa, -ca, 0], toward } : { right: [-sa, ca, 0], up: along, toward };
}

/* How far a point lies to the side of the cylinder's axis, as the camera sees it. */
export const aside = ([x, y], { azimuth }) => y * Math.cos(azimuth) - x * Math.sin(azimuth);

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/* Left, right, bottom and top of points (x, y, z, x, ...) as the camera sees them, with a radius about each. */
export function seen(camera, points, radius) {
  const { right, up } = axesOf(camera);
  let [x0, x1, y0, y1] = [Infinity, -Infinity, Infinity, -Infinity];
  for (let i = 0; i < points.length; i += 3) {
    const p = [points[i], points[i + 1], points[i + 2]],
      x = dot(p, right),
      y = dot(p, up);
    ((x0 = Math.min(x0, x)), (x1 = Math.max(x1, x)), (y0 = Math.min(y0, y)), (y1 = Math.max(y1, y)));
  }
  return { x0: x0 - radius, x1: x1 + radius, y0: y0 - radius, y1: y1 + radius };
}

/* The camera in the same direction that sees all of a rectangle; aspect: width of the view over its height. */
export function fitted(camera, { x0, x1, y0, y1 }, aspect) {
  const half = (MARGIN / 2) * Math.max(y1 - y0, (x1 - x0) / aspect);
  return { ...camera, x: (x0 + x1) / 2, y: (y0 + y1) / 2, half };
}

/* Whether the rectangle leaves the view or fills little of it. */
export function needsFit(camera, { x0, x1, y0, y1 }, aspect) {
  const { x, y, half } = camera,
    wide = half * aspect;
  const leaves = x0 < x - wide || x1 > x + wide || y0 < y - half || y1 > y + half;
  return leaves || Math.max((y1 - y0) / (2 * half), (x1 - x0) / (2 * wide)) < SMALL;
}

/* Turned by angles to the right and up, as the hand moves. */
export function turned(camera, right, up) {
  const [by, tilt] = camera.lying ? [-up, right] : [right, up];
  return {
    ...camera,
    azimuth: camera.azimuth + by,
    elevation: Math.min(Math.max(camera.elevation + tilt, -STEEPEST), STEEPEST),
  };
}

/* Between two cameras; share: from 0 to 1. */
export function between(from, to, share) {
  const eased = share * share * (3 - 2 * share),
    found = {};
  for (const key of Object.keys(to))
    if (key === "lying") found[key] = to[key];
    else
      found[key] =
      key === "half" ? from[key] * (to[key] / from[key]) ** eased : from[key] + eased * (to[key] - from[key]);
  return found;
}

/* The matrix, column by column, that takes points of the scene into the view; depth: what is seen before and behind. */
export function matrix(camera, aspect, depth) {
  const { right, up, toward } = axesOf(camera),
    { x, y, half } = camera,
    wide = half * aspect;
  const row = (axis, size, shift) => [axis[0] / size, axis[1] / size, axis[2] / size, -shift / size];
  const rows = [
    row(right, wide, x),
    row(up, half, y),
    row(
      toward.map((v) => -v),
      depth,
      0,
    ),
    [0, 0, 0, 1],
  ];
  return Float32Array.from({ length: 16 }, (_, i) => rows[i % 4][i >> 2]);
}

export const LOW_SIDE_DOWN = (-2 * Math.PI) / 3; // azimuth of a lying view that looks down on alpha = 0, as in the stills

/* The camera before the middle of a rod; wide: lying, where the rod is longer than its cylinder is thick. The low side of
   a rod with weight is then at the bottom. */
export function facing({ alpha, z, one }, wide) {
  let [x, y] = [0, 0];
  for (const v of alpha) {
    x += Math.cos(v);
    y += Math.sin(v);
  }
  const lying = wide && range(z)[1] - range(z)[0] > LONG * one.R,
    middle = Math.hypot(x, y) > 0.05 * alpha.length ? Math.atan2(y, x) : alpha[alpha.length >> 1];
  return { azimuth: lying && one.weight > 0 ? LOW_SIDE_DOWN : middle, elevation: ABOVE, lying };
}
