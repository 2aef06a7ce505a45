// The colour code of the push; its table comes from workbench/data/push_colours.py.

/* Red, green and blue (0 to 255) of a push; largest: the push that has the darkest blue. */
export function pushColour({ stops, pull }, push, largest) {
  if (push < 0) return pull;
  const share = largest > 0 ? Math.min(push / largest, 1) : 0;
  const j = Math.max(
      1,
      stops.findIndex(([at]) => at >= share),
    ),
    [at, from] = stops[j - 1],
    [until, to] = stops[j];
  return from.map((v, k) => Math.round(v + ((to[k] - v) * (share - at)) / (until - at)));
}

export const css = (rgb) => `rgb(${rgb.join(" ")})`;

/* The colours from no push to the largest as bytes, four each. */
export function ramp(code, count) {
  return Uint8Array.from(Array.from({ length: count }, (_, i) => [...pushColour(code, i, count - 1), 255]).flat());
}
