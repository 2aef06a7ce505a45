// The ends of a row of values.

/* The smallest and the largest of those that are numbers. */
export function range(values) {
  let low = Infinity,
    high = -Infinity;
  for (const v of values) {
    if (v < low) low = v;
    if (v > high) high = v;
  }
  return [low, high];
}
