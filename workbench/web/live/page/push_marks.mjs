// The push on the rod as a ribbon or as arrows that stand off it: as tall as the push is strong, in its colours, on the
// side away from the wall. An arrow points as the cylinder pushes, or would have to pull.

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
const corner = ({ x, y, z, ox, oy, value }, one, height, normal) => {
  const off = one.sign * (0.8 * one.a + height);
  return [x + off * ox, y + off * oy, z, ...normal, value];
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
  const rings = corners.length / STRIDE / SIDES;
  return { corners: Float32Array.from(corners), triangles: rings ? wallTriangles(rings, SIDES) : new Uint32Array() };
}

/* Radius and height of the rings of an arrow, from the rod outward. */
function profile(height, a, pulls) {
  const point = Math.min(POINT * a, height),
    neck = pulls ? point : height - point,
    rings = [[SHAFT, pulls ? height : 0], [SHAFT, neck], [HEAD, neck]].map(([radius, at]) => [radius * a, at]);
  const all = [[0, pulls ? height : 0], ...rings, [0, pulls ? 0 : height]];
  return pulls ? all.reverse() : all;
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
