// The shapes of cases whose stations are stored in the file.

import { interpolated } from "./rod_shape.mjs";

const ROWS = ["beta", "dbeta", "alpha", "z"]; // of the stored arrays of a case

/* The shape of a stored case. data: the plain data of workbench/web/turntable/stored.py. */
export function storedShape(core, data, index) {
  const n = data.stations.length,
    one = { ...data.shared, ...data.cases[index].numbers };
  const row = (k) => data.arrays.subarray((4 * index + k) * n, (4 * index + k + 1) * n);
  const stations = { s: Float64Array.from(data.stations, (u) => u * one.L) };
  ROWS.forEach((name, k) => (stations[name] = Float64Array.from(row(k))));
  one.kind = "start";
  [one.beta, one.alpha] = [stations.beta[0], stations.alpha[0]];
  return interpolated(core, one, stations, { error: 0, condition: NaN, sound: true, shown: 1 });
}

/* Base64 of numbers of four bytes, as such. */
export function numbersOf(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}
