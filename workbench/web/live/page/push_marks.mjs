// The push on the rod as a ribbon or as arrows that stand off it: as tall as the push is strong, in its colours, on the
// side away from the wall. An arrow points as the cylinder pushes, or would have to pull. And the contacts of a rod that may
// leave the cylinder.

import { onLines } from "./rod_shape.mjs";
import { STRIDE, frameAt, wallTriangles } from "./tube.mjs";

const TALL = [4, 0.6], // radii of the rod, and of the cylinder: the larger is the height of the largest push
  ROOM = 0.9; // of the space that a rod inside has
const SPACING = 2.5, // radii between two arrows
  MOST = 120, // arrows
  LEAST = 0.04; // of the largest push: a shorter arrow is not drawn
const SHAFT = 0.2,
  HEAD = 0.5,
  POINT = 1.6, // in radii of the rod: those of an arrow, and the length of its head
  SIDES = 8;
const COLLAR = [1.25, 0.15], // radius and half width, in radii of the rod
  LINE = 0.1, // in radii of the rod: that of the line of a gap
  SHORTEST = 0.3, // of the longest arrow: that of the least point force
  SEEN = 0.05; // radii of the rod: a smaller gap is not seen

/* How far the largest push reaches from the rod. */
export function tallest({ a, R, rho, sign }) {
  const tall = Math.max(TALL[0] * a, TALL[1] * R);
  return sign > 0 ? tall : Math.min(tall, ROOM * (rho + R - a));
}

/* Corners and triangles, or null for none. kind: "ribbon" or "arrows"; chosen: the stations of a ribbon. */
export function pushMarks(kind, shape, chosen, squeeze, largest) {
  if (!(largest > 0) || !["ribbon", "arrows"].includes(kind)) return null;
  return (kind === "ribbon" ? ribbon : arrows)(shape, chosen, squeeze, largest);
}

/* A point at a height over the rod's surface, with a normal. */
const corner = ({ x, y, z, ox, oy, oz, value }, one, height, normal) => {
  const off = one.sign * (0.8 * one.a + height);
  return [x + off * ox, y + off * oy, z + off * oz, ...normal, value];
};

function ribbon(shape, chosen, squeeze, largest) {
  const { one } = shape,
    corners = [],
    triangles = [];
  chosen.forEach((i, k) => {
    const frame = frameAt(shape, i, squeeze, largest),
      normal = [frame.bx, frame.by, frame.bz].map((v) => one.sign * v);
    for (const height of [0, Math.abs(frame.value) * tallest(one)]) corners.push(...corner(frame, one, height, normal));
    if (k) triangles.push(2 * k - 2, 2 * k - 1, 2 * k, 2 * k - 1, 2 * k + 1, 2 * k);
  });
  return { corners: Float32Array.from(corners), triangles: Uint32Array.from(triangles) };
}

/* Each arrow is five rings; the first and the last have no size, so that nothing is seen between two arrows. */
function arrows(shape, _, squeeze, largest) {
  const { one, s } = shape,
    count = Math.min(Math.max(Math.round(one.L / (SPACING * one.a)), 2), MOST),
    corners = [];
  for (let k = 0, i = 0; k < count; k++) {
    const where = (s[s.length - 1] * (k + 0.5)) / count;
    while (i < s.length - 1 && s[i] < where) i++;
    const frame = frameAt(shape, i, squeeze, largest),
      height = Math.abs(frame.value) * tallest(one);
    if (Math.abs(frame.value) > LEAST) for (const ring of profile(height, one.a, frame.value < 0)) corners.push(...round(frame, one, ring));
  }
  return strip(corners);
}

/* The surface through rings one after the other. */
function strip(corners) {
  const rings = corners.length / STRIDE / SIDES;
  return { corners: Float32Array.from(corners), triangles: rings ? wallTriangles(rings, SIDES) : new Uint32Array() };
}

/* Of a rod that may leave the cylinder: a collar where each contact begins and ends, an arrow for each point force of the
   wall, and a line to the wall at the widest gap; null for another rod. */
export function contactMarks(shape, squeeze) {
  const { one, contacts, pointForces } = shape;
  if (!one.leaves) return null;
  const rows = Object.keys(shape).filter((name) => shape[name].length === shape.s.length && name !== "s"),
    frame = (s) => frameAt(Object.fromEntries(rows.map((name) => [name, onLines(shape.s, shape[name], [s])])), 0, squeeze, 0),
    largest = Math.max(...pointForces.map(([, force]) => force)),
    corners = [];
  for (const at of edgesOf(contacts, one).map(frame))
    for (const [radius, shift] of [[0, -1], [1, -1], [1, 1], [0, 1]])
      corners.push(...hoop(at, COLLAR[0] * radius * one.a, COLLAR[1] * shift * one.a));
  for (const [s, force] of pointForces)
    for (const ring of profile(tallest(one) * (SHORTEST + ((1 - SHORTEST) * force) / largest), one.a, false))
      corners.push(...round(frame(s), one, ring));
  const widest = widestGap(shape),
    [wall, rod] = [-shape.gap[widest] - 1.8 * one.a, -1.8 * one.a]; // as heights of `corner`
  if (isOff(shape))
    for (const [radius, height] of [[0, wall], [LINE, wall], [LINE, rod], [0, rod]])
      corners.push(...round(frame(shape.s[widest]), one, [radius * one.a, height]));
  return strip(corners);
}

const widestGap = ({ gap }) => gap.indexOf(Math.max(...gap)),
  isOff = (shape) => shape.gap[widestGap(shape)] > SEEN * shape.one.a;

/* What the marks are, in words; "" for a rod that has none. */
export function wordsOfMarks(shape) {
  const { one, contacts, pointForces } = shape,
    off = one.leaves && isOff(shape);
  return [
    off ? "pale: off the wall" : "",
    one.leaves && edgesOf(contacts, one).length ? "collar: a contact begins or ends" : "",
    one.leaves && pointForces.length ? "arrow: a point force of the wall" : "",
    off ? "line: the widest gap" : "",
  ].filter(Boolean).join(" · ");
}

/* Where contacts begin and end, without the ends of the rod and without points. */
const edgesOf = (contacts, { L }) =>
  contacts.filter(([begin, end]) => end > begin).flat().filter((s) => s > 1e-6 * L && s < (1 - 1e-6) * L);

/* Radius and height of the rings of an arrow, from the rod outward. */
function profile(height, a, pulls) {
  const point = Math.min(POINT * a, height),
    neck = pulls ? point : height - point,
    rings = [[SHAFT, pulls ? height : 0], [SHAFT, neck], [HEAD, neck]].map(([radius, at]) => [radius * a, at]);
  const all = [[0, pulls ? height : 0], ...rings, [0, pulls ? 0 : height]];
  return pulls ? all.reverse() : all;
}

/* A ring about the rod, shifted along it. */
function hoop({ x, y, z, ox, oy, oz, bx, by, bz, along: [u, v, w] }, radius, shift) {
  return Array.from({ length: SIDES }, (_, j) => {
    const [c, d] = [Math.cos((2 * Math.PI * j) / SIDES), Math.sin((2 * Math.PI * j) / SIDES)],
      [nx, ny, nz] = [c * ox + d * bx, c * oy + d * by, c * oz + d * bz];
    return [x + radius * nx + shift * u, y + radius * ny + shift * v, z + radius * nz + shift * w, nx, ny, nz, 0];
  }).flat();
}

function round(frame, one, [radius, height]) {
  const { bx, by, bz, along } = frame,
    [u, v] = one.sign > 0 ? [[bx, by, bz], along] : [along, [bx, by, bz]];
  return Array.from({ length: SIDES }, (_, j) => {
    const angle = (2 * Math.PI * j) / SIDES,
      normal = u.map((_, k) => Math.cos(angle) * u[k] + Math.sin(angle) * v[k]),
      numbers = corner(frame, one, height, normal);
    for (let k = 0; k < 3; k++) numbers[k] += radius * normal[k];
    return numbers;
  }).flat();
}
