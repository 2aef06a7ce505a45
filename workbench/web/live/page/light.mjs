// How much of the light from all around reaches the wall beside the rod that touches it, over the unrolled wall, and the
// rod beside other stretches of it. The laws are those of workbench/scene/surfaces.py.

import { onLines } from "./rod_shape.mjs";
import { framesAt } from "./tube.mjs";

const BUDGET = 2e6,
  ROUGH = 2e5; // visits of texels, at rest and while a slider moves
const LEAST = 2,
  MOST = 8, // texels in a radius of the rod
  LARGEST = 2048; // texels around or along

/* Bytes, 255 where all light arrives; u runs around from azimuth 0, v along from the lower end. wall: its ends. */
export function wallLight({ one, x, y, z, alpha }, squeeze, { low, high }, { depth, reach }, rough) {
  const { R, rho, a } = one,
    radii = one.leaves ? x.map((v, i) => Math.hypot(v, y[i])) : x.map(() => rho),
    steps = Array.from(z, (_, i) => (i ? Math.hypot(rho * (alpha[i] - alpha[i - 1]), squeeze * (z[i] - z[i - 1])) : 0)),
    length = steps.reduce((sum, step) => sum + step, 0);
  const fine = Math.cbrt(((rough ? ROUGH : BUDGET) * a) / (4 * reach ** 2 * Math.max(length, a))),
    texel = a / Math.min(Math.max(fine, LEAST), MOST),
    count = (size) => Math.min(Math.max(Math.ceil(size / texel), 4), LARGEST);
  const width = count(2 * Math.PI * R),
    height = count(high - low),
    far = (reach ** 2 - 1) * a ** 2, // squared distance from the line of contact
    nearest = new Float32Array(width * height).fill(far);
  const turn = (2 * Math.PI) / width,
    rise = (high - low) / height,
    wide = Math.min(Math.ceil(Math.acos(Math.max(1 - far / (2 * R * rho), -1)) / turn), width >> 1),
    tall = Math.ceil(Math.sqrt(far) / rise),
    across = new Float32Array(2 * wide + 1);
  const put = (azimuth, place, r) => {
    const off = one.leaves ? (R - r) ** 2 - a ** 2 : 0; // more than of a rod on the wall
    if (off >= far) return;
    const middle = Math.round(azimuth / turn - 0.5),
      row = Math.round((place - low) / rise - 0.5);
    for (let i = -wide; i <= wide; i++) across[i + wide] = off + 2 * R * r * (1 - Math.cos((middle + i + 0.5) * turn - azimuth));
    for (let j = Math.max(row - tall, 0); j <= Math.min(row + tall, height - 1); j++) {
      const along = (low + (j + 0.5) * rise - place) ** 2;
      for (let i = -wide; i <= wide; i++) {
        const at = j * width + ((((middle + i) % width) + width) % width);
        if (across[i + wide] + along < nearest[at]) nearest[at] = across[i + wide] + along;
      }
    }
  };
  for (let i = 1; i < z.length; i++) {
    const parts = Math.ceil(steps[i] / texel);
    for (let k = 0; k < parts; k++) {
      const u = k / parts;
      const [azimuth, place, r] = [alpha, z, radii].map((row) => row[i - 1] + u * (row[i] - row[i - 1]));
      put(azimuth, squeeze * place, r);
    }
  }
  put(alpha[z.length - 1], squeeze * z[z.length - 1], radii[z.length - 1]);
  const all = far / (far + a ** 2),
    bytes = Uint8Array.from(nearest, (v) => 255 * (1 - depth * (1 - v / (v + a ** 2) / all)));
  return { width, height, bytes };
}

const NEAR = 3.5, // radii between a ring and a sphere that covers it
  APART = Math.PI, // radii along the rod: nearer spheres are the same stretch
  SPHERES = 20_000; // at most

/* The share of all directions that other stretches of the rod cover, at each side of each ring: as spheres at every radius
   along them. */
export function coveredTube(shape, chosen, sides, squeeze) {
  const { a } = shape.one,
    covered = new Float32Array(chosen.length * sides),
    spheres = spheresOf(shape, squeeze),
    cells = new Map(),
    turn = (2 * Math.PI) / sides,
    cellOf = (v) => Math.floor(v / (NEAR * a)),
    keyOf = (i, j, k) => (i * 4096 + j) * 1048576 + k;
  spheres.forEach((one, n) => {
    const key = keyOf(...one.place.map(cellOf));
    if (cells.has(key)) cells.get(key).push(n);
    else cells.set(key, [n]);
  });
  framesAt(shape, chosen, squeeze, 0).forEach((frame, ring) => {
    const near = [],
      i = chosen[ring];
    const [ci, cj, ck] = [frame.x, frame.y, frame.z].map(cellOf);
    for (let u = -1; u <= 1; u++)
      for (let v = -1; v <= 1; v++)
        for (let w = -1; w <= 1; w++)
          for (const n of cells.get(keyOf(ci + u, cj + v, ck + w)) || []) {
            const { s, place, weight } = spheres[n],
              x = place[0] - frame.x,
              y = place[1] - frame.y,
              z = place[2] - frame.z;
            if (Math.abs(s - shape.s[i]) > APART * a && x * x + y * y + z * z < (NEAR * a) ** 2) near.push(x, y, z, weight);
          }
    for (let side = 0; side < sides && near.length; side++)
      covered[ring * sides + side] = coveredAt(frame, Math.cos(turn * side), Math.sin(turn * side), near, a);
  });
  return covered;
}

/* Of a point of a section; near: of each sphere its place from the centre, and its weight. */
function coveredAt({ ox, oy, oz, bx, by, bz }, c, d, near, a) {
  const nx = c * ox + d * bx,
    ny = c * oy + d * by,
    nz = c * oz + d * bz;
  let sum = 0;
  for (let k = 0; k < near.length; k += 4) {
    const u = near[k] - a * nx,
      v = near[k + 1] - a * ny,
      w = near[k + 2] - a * nz,
      facing = u * nx + v * ny + w * nz,
      away = Math.max(Math.sqrt(u * u + v * v + w * w), a);
    if (facing > 0) sum += (near[k + 3] * facing * a * a) / (away * away * away);
  }
  return sum;
}

/* Spheres at every radius along the rod; two stand for a stretch as long as they are wide. */
function spheresOf({ one, s, x, y, z }, squeeze) {
  const length = s[s.length - 1],
    count = Math.min(Math.max(Math.floor(length / one.a), 2), SPHERES),
    places = Array.from({ length: count + 1 }, (_, k) => Math.min((k * length) / count, length)),
    [across, aside, heights] = [x, y, z].map((row) => onLines(s, row, places)),
    weight = length / count / (2 * one.a);
  return places.map((at, k) => ({ s: at, place: [across[k], aside[k], squeeze * heights[k]], weight }));
}
