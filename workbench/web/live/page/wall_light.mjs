// How much of the light from all around reaches the wall beside the rod that touches it, over the unrolled wall.
// The law is that of workbench/scene/shading.py.

const BUDGET = 2e6,
  ROUGH = 2e5; // visits of texels, at rest and while a slider moves
const LEAST = 2,
  MOST = 8, // texels in a radius of the rod
  LARGEST = 2048; // texels around or along

/* Bytes, 255 where all light arrives; u runs around from azimuth 0, v along from the lower end. wall: its ends. */
export function wallLight({ one, alpha, z }, squeeze, { low, high }, { depth, reach }, rough) {
  const { R, rho, a } = one,
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
  const put = (azimuth, place) => {
    const middle = Math.round(azimuth / turn - 0.5),
      row = Math.round((place - low) / rise - 0.5);
    for (let i = -wide; i <= wide; i++) across[i + wide] = 2 * R * rho * (1 - Math.cos((middle + i + 0.5) * turn - azimuth));
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
      put(alpha[i - 1] + u * (alpha[i] - alpha[i - 1]), squeeze * (z[i - 1] + u * (z[i] - z[i - 1])));
    }
  }
  put(alpha[z.length - 1], squeeze * z[z.length - 1]);
  const all = far / (far + a ** 2),
    bytes = Uint8Array.from(nearest, (v) => 255 * (1 - depth * (1 - v / (v + a ** 2) / all)));
  return { width, height, bytes };
}
