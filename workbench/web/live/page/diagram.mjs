// A line diagram on a canvas, from the rows of numbers of curves.mjs.

import { css, pushColour } from "./colours.mjs";
import { number, tickText, ticks } from "./text.mjs";
import { range } from "./range.mjs";

const LEFT = 58, // at least
  LABEL = 25, // beside the ticks at the left
  RIGHT = 12,
  TOP = 8,
  FOOT = 36;
const LETTER = 11,
  DIGIT = 0.65, // of the height of a letter, at most
  FLAT = 6, // how many times more of a panel one direction may fill where both have one scale
  LEAST_SCALES = 1.05,
  LEAST_RANGE = 5,
  TONES = 32,
  FINER = 4, // columns of a coloured line in a pixel, as its colour may change within one
  NEAR = 0.7; // pixels
// as in the figures: opacity of the bands of pull and of the areas of push
export const BAND = 0.14,
  AREA = 0.25;

/* The context of a canvas of so many pixels of the page; ratio: its own pixels for one of these. */
export function paper(canvas, width, height, ratio) {
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)],
    ctx = canvas.getContext("2d");
  if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
  canvas.style.height = `${height}px`;
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  return ctx;
}

/* The scales of a diagram in a box of so many pixels. left: its margin, at least, which has room for the widest tick. */
export function frameOf(spec, width, height, left = LEFT) {
  const w = width - left - RIGHT,
    h = height - TOP - FOOT,
    more = [spec.zero ? 0 : NaN, spec.level ?? NaN];
  let [x0, x1] = extent(spec.x, [], spec.least),
    [y0, y1] = extent(spec.y, more, spec.least);
  if (!spec.rising) [x0, x1] = padded(x0, x1, 0.04);
  [y0, y1] = padded(y0, y1, 0.07);
  const [across, down] = [(x1 - x0) / w, (y1 - y0) / h],
    unit = Math.max(across, down);
  if (spec.equal && unit <= FLAT * Math.min(across, down)) {
    const cx = (x0 + x1) / 2,
      cy = (y0 + y1) / 2;
    [x0, x1, y0, y1] = [cx - (unit * w) / 2, cx + (unit * w) / 2, cy - (unit * h) / 2, cy + (unit * h) / 2];
  }
  const room = LABEL + DIGIT * LETTER * Math.max(...heights(spec, y0, y1).map(([, text]) => text.length));
  if (room > left) return frameOf(spec, width, height, room);
  const px = (v) => left + ((v - x0) / (x1 - x0)) * w,
    py = (v) => TOP + h - ((v - y0) / (y1 - y0)) * h;
  return {
    left,
    w,
    h,
    x0,
    x1,
    y0,
    y1,
    px,
    py,
    width,
    height,
    back: (p) => x0 + ((p - left) / w) * (x1 - x0),
    stretch: w / (x1 - x0) / (h / (y1 - y0)),
  };
}

/* The ticks between two heights, each with its text. */
const heights = ({ flipped }, low, high) => ticks(low, high, 4).map((v) => [v, tickText(flipped ? -v || 0 : v, high - low)]);

const padded = (low, high, share) => [low - share * (high - low), high + share * (high - low)];

/* Smallest and largest value; a row without a difference, or with less than `least`, gets room about it. */
export function extent(values, more = [], least = 0) {
  const [low, high] = range([...values, ...more].filter(Number.isFinite));
  if (!(low <= high)) return [0, 1];
  const size = Math.max(Math.abs(low), Math.abs(high)) || 1;
  if (high - low < least) return [(low + high - least) / 2, (low + high + least) / 2]; // less is rounding
  if (high - low < 1e-6 * size) return [low - 0.05 * size, high + 0.05 * size]; // a constant is drawn as level
  return [low, high];
}

/* The points of a line in pixels. */
export const thinned = (xs, ys, rising) => kept(xs, ys, rising).map((i) => [xs[i], ys[i]]);

/* Which points of a line are drawn. Over x: in each column of pixels the first, the lowest and the highest; of another
   curve those a pixel's part apart. */
function kept(xs, ys, rising) {
  const found = [],
    last = xs.length - 1;
  if (!rising) {
    xs.forEach((x, i) => {
      const before = found[found.length - 1];
      if (before === undefined || i === last || Math.hypot(x - xs[before], ys[i] - ys[before]) > NEAR) found.push(i);
    });
    return found;
  }
  for (let i = 0; i <= last;) {
    let [j, low, high] = [i, i, i];
    while (j < last && Math.floor(xs[j + 1]) === Math.floor(xs[i])) {
      j++;
      if (ys[j] < ys[low]) low = j;
      if (ys[j] > ys[high]) high = j;
    }
    const chosen = new Set([i, low, high, ...(j === last ? [j] : [])]);
    found.push(...[...chosen].sort((a, b) => a - b));
    i = j + 1;
  }
  return found;
}

/* end: the push that has the darkest blue. */
export function paintDiagram(ctx, spec, frame, theme, code, end) {
  const { left, w, h, px, py } = frame;
  ctx.clearRect(0, 0, frame.width, frame.height);
  ctx.font = `${LETTER}px ${theme.font}`;
  const xs = Array.from(spec.x, px),
    ys = Array.from(spec.y, py),
    chosen = kept(spec.push && spec.rising ? xs.map((x) => FINER * x) : xs, ys, spec.rising),
    points = chosen.map((i) => [xs[i], ys[i]]);
  gridOf(ctx, frame, theme);
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, TOP, w, h);
  ctx.clip();
  if (spec.shaded) for (const one of stretches(spec.x, spec.y)) shade(ctx, one, spec, frame, code);
  if (spec.zero) rule(ctx, left, py(0), left + w, py(0), theme.soft, 1);
  for (const { x, y, look: [width, colour] } of spec.lines || [])
    line(ctx, thinned(Array.from(x, px), Array.from(y, py)), theme[colour], width);
  if (spec.push) for (const part of unbroken(chosen, spec)) pushLine(ctx, part, xs, ys, spec.push, theme, code, end);
  else if (!spec.lines) line(ctx, points, theme.line, 1.8);
  if (spec.level !== undefined) levelOf(ctx, spec, frame, theme);
  if (spec.dot) spot(ctx, points[0], 3.5, theme.ink);
  ctx.restore();
  labels(ctx, spec, frame, theme);
}

/* The cursor: a mark on the line and, over s, a line through it. */
export function paintCursor(ctx, frame, [x, y], vertical, theme) {
  if (vertical) rule(ctx, frame.px(x), TOP, frame.px(x), TOP + frame.h, theme.mark, 1);
  spot(ctx, [frame.px(x), frame.py(y)], 4.5, theme.mark);
}

/* The stretches of a row of pushes with one sign: from, to, whether they are pulls; none where there is no pull. */
export function stretches(x, push) {
  const found = [];
  if (!push.some((v) => v < 0)) return found;
  let from = x[0];
  for (let i = 1; i <= x.length; i++) {
    const pulls = push[i - 1] < 0;
    if (i < x.length && push[i] < 0 === pulls) continue;
    const to = i < x.length ? x[i - 1] + ((x[i] - x[i - 1]) * push[i - 1]) / (push[i - 1] - push[i]) : x[i - 1];
    found.push({ from, to, pulls });
    from = to;
  }
  return found;
}

/* As in the figures: a band of orange where the cylinder would have to pull, and blue below the line where it pushes. */
function shade(ctx, { from, to, pulls }, spec, { px, py, h }, code) {
  ctx.globalAlpha = pulls ? BAND : AREA;
  ctx.fillStyle = css(pulls ? code.pulled : code.pushed);
  if (pulls) ctx.fillRect(px(from), TOP, px(to) - px(from), h);
  else {
    ctx.beginPath();
    ctx.lineTo(px(from), py(0));
    spec.x.forEach((x, i) => x >= from && x <= to && ctx.lineTo(px(x), py(spec.y[i])));
    ctx.lineTo(px(to), py(0));
    ctx.fill();
  }
  ctx.globalAlpha = 1;
}

/* The points of a curve in pieces, each without a jump of y. */
function unbroken(chosen, { y, jump = Infinity }) {
  const cuts = chosen.flatMap((i, k) => (k && Math.abs(y[i] - y[chosen[k - 1]]) > jump ? [k] : []));
  return [0, ...cuts].map((from, k) => chosen.slice(from, cuts[k]));
}

/* A line in the colours of the push at its points, on a casing that is seen on every paper. */
function pushLine(ctx, chosen, xs, ys, push, theme, code, end) {
  const points = chosen.map((i) => [xs[i], ys[i]]);
  const toneOf = (v) => (v < 0 ? -0.5 : 0.5) + Math.trunc((TONES * v) / (end || 1)); // none spans 0, where the tint changes
  line(ctx, points, theme.soft, 2.7);
  for (let i = 1, from = 0; i < points.length; i++) {
    const tone = toneOf((push[chosen[i - 1]] + push[chosen[i]]) / 2),
      next = i + 1 < points.length ? toneOf((push[chosen[i]] + push[chosen[i + 1]]) / 2) : NaN;
    if (tone === next) continue;
    line(ctx, points.slice(from, i + 1), css(pushColour(code, tone, TONES)), 1.8);
    from = i;
  }
}

function gridOf(ctx, { px, py, x0, x1, y0, y1, left, w, h }, theme) {
  for (const v of ticks(x0, x1, 6)) rule(ctx, px(v), TOP, px(v), TOP + h, theme.faint, 1);
  for (const v of ticks(y0, y1, 4)) rule(ctx, left, py(v), left + w, py(v), theme.faint, 1);
}

function levelOf(ctx, spec, { px, py, left, w }, theme) {
  const y = py(spec.level);
  ctx.setLineDash([4, 3]);
  rule(ctx, left, y, left + w, y, theme.level, 1);
  ctx.setLineDash([]);
  for (const [from, to] of spec.ranges) {
    const middle = (px(from) + px(to)) / 2,
      half = Math.max(px(to) - px(from), LEAST_RANGE) / 2;
    rule(ctx, middle - half, y, middle + half, y, theme.level, 3.5);
  }
}

function labels(ctx, spec, { px, py, x0, x1, y0, y1, left, w, h, height }, theme) {
  ctx.fillStyle = theme.soft;
  ctx.textAlign = "center";
  for (const v of ticks(x0, x1, 6)) ctx.fillText(tickText(v, x1 - x0), px(v), TOP + h + 14);
  ctx.fillText(spec.xlabel, left + w / 2, height - 6);
  ctx.textAlign = "right";
  for (const [v, text] of heights(spec, y0, y1)) ctx.fillText(text, left - 5, py(v) + 4);
  ctx.save();
  ctx.translate(11, TOP + h / 2);
  ctx.rotate(-Math.PI / 2);
  ctx.textAlign = "center";
  ctx.fillText(spec.ylabel, 0, 0);
  ctx.restore();
}

/* The title of a diagram, and by how much the scale of one direction is larger; stretch: of the horizontal over the
   vertical. */
export function titleOf(spec, { stretch }) {
  if (!("equal" in spec) || Math.max(stretch, 1 / stretch) <= LEAST_SCALES) return spec.title;
  const [label, times] = stretch > 1 ? [spec.xlabel, stretch] : [spec.ylabel, 1 / stretch];
  return `${spec.title}; ${label.split(" [")[0]} drawn ${number(times, 2)} times larger`;
}

/* A straight line. */
const rule = (ctx, x0, y0, x1, y1, colour, width) => line(ctx, [[x0, y0], [x1, y1]], colour, width);

function line(ctx, points, colour, width) {
  ctx.beginPath();
  for (const [x, y] of points) ctx.lineTo(x, y);
  Object.assign(ctx, { strokeStyle: colour, lineWidth: width, lineJoin: "round" });
  ctx.stroke();
}

/* A disc, or with a width of its line a ring. */
export function spot(ctx, [x, y], radius, colour, width = 0) {
  ctx.beginPath();
  ctx.arc(x, y, radius, 0, 2 * Math.PI);
  Object.assign(ctx, { fillStyle: colour, strokeStyle: colour, lineWidth: width });
  if (width) ctx.stroke();
  else ctx.fill();
}
