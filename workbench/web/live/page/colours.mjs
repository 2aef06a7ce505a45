// The colours of the push; their table and the rules of their scale come from workbench/figures/colours.py.

/* The drawn scale of pushes between two values: from -end, or from 0 without a pull, to a round end. */
export function scaleOf({ ends, uniform, beyond, rounding }, [least, largest]) {
  const size = Math.max(Math.abs(least), Math.abs(largest));
  if (!(size > 0)) return { low: 0, end: 0 };
  const wanted = size * (least > uniform * size ? beyond : 1),
    power = 10 ** Math.floor(Math.log10(wanted)),
    end = power * [...ends, 10 * ends[1]].find((one) => one * power >= wanted * (1 - 1e-9));
  return { low: least < -rounding * size ? -end : 0, end };
}

/* What a scale is called. */
export const wordsOf = ({ words, pullWords }, { low }, unit) => words.replace("{unit}", unit) + (low < 0 ? pullWords : "");

/* Red, green and blue (0 to 255) of a push; end: the push that has the darkest blue. */
export function pushColour({ stops }, push, end) {
  const share = end > 0 ? Math.min(Math.max(push / end, -1), 1) : 0,
    j = Math.max(stops.findIndex(([at]) => at >= share), 1),
    [at, from] = stops[j - 1],
    [until, to] = stops[j];
  return from.map((v, k) => Math.round(v + ((to[k] - v) * (share - at)) / (until - at)));
}

export const css = (rgb) => `rgb(${rgb.join(" ")})`;

/* The colours of pushes from `low` to 1 as bytes, four each. */
export function ramp(code, count, low = -1) {
  const share = (i) => low + ((1 - low) * i) / (count - 1);
  return Uint8ClampedArray.from(Array.from({ length: count }, (_, i) => [...pushColour(code, share(i), 1), 255]).flat());
}
