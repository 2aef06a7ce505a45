"use strict";
// A small line diagram as SVG, from values alone.

const WIDE = 400, LEFT = 52, RIGHT = 16, TOP = 6, FOOT = 34, MOST = 1200;

function niceTicks(low, high, count) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((m) => m * power >= raw * 0.999);
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k <= high / step + 1e-9; k++) ticks.push(k * step);
  return ticks;
}

function extent(lists, least = 0) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) for (const v of list) if (Number.isFinite(v)) { low = Math.min(low, v); high = Math.max(high, v); }
  if (!(low <= high)) return [0, 1];
  const size = Math.max(Math.abs(low), Math.abs(high), 1e-300);
  if (high - low < least) return [(low + high - least) / 2, (low + high + least) / 2]; // smaller differences are rounding
  if (high - low < 1e-6 * size) return [low - 0.05 * size, high + 0.05 * size]; // a constant is drawn as level
  return [low, high];
}

const written = (v) => (Math.abs(v) < 1e-12 ? "0" : String(Number(v.toPrecision(6)))).replaceAll("-", "−").replace("e+", "e");

const RodDiagram = {
  props: { title: String, x: Object, y: Object, xlabel: String, ylabel: String, height: { type: Number, default: 170 },
    equal: Boolean, zero: Boolean, bands: { type: Array, default: () => [] }, level: { type: Object, default: null },
    least: { type: Number, default: 0 }, dot: Boolean, fit: { type: Array, default: null } },
  computed: {
    frame() {
      const w = WIDE - LEFT - RIGHT, h = this.height - TOP - FOOT;
      let [x0, x1] = extent([this.x], this.least), [y0, y1] = this.fit || extent([this.y, this.zero ? [0] : [], this.level ? [this.level.y] : []], this.least);
      const pad = 0.06 * (y1 - y0);
      y0 -= pad; y1 += pad;
      if (this.equal) {
        const unit = Math.max((x1 - x0) / w, (y1 - y0) / h), cx = (x0 + x1) / 2, cy = (y0 + y1) / 2;
        [x0, x1, y0, y1] = [cx - unit * w / 2, cx + unit * w / 2, cy - unit * h / 2, cy + unit * h / 2];
      }
      const px = (v) => LEFT + ((v - x0) / (x1 - x0)) * w, py = (v) => TOP + h - ((v - y0) / (y1 - y0)) * h;
      return { w, h, px, py, xs: niceTicks(x0, x1, 6), ys: niceTicks(y0, y1, 4), x0, x1, y0, y1 };
    },
    path() {
      const { px, py } = this.frame, every = Math.max(1, Math.ceil(this.x.length / MOST)), parts = [];
      for (let i = 0; i < this.x.length; i += every) parts.push(`${px(this.x[i]).toFixed(1)} ${py(this.y[i]).toFixed(1)}`);
      const last = this.x.length - 1;
      if (last % every) parts.push(`${px(this.x[last]).toFixed(1)} ${py(this.y[last]).toFixed(1)}`);
      return "M" + parts.join("L");
    },
  },
  methods: { written },
  data: () => ({ WIDE, LEFT, TOP, FOOT }),
  template: `
    <figure class="diagram"><figcaption>{{ title }}</figcaption>
      <svg :viewBox="'0 0 ' + WIDE + ' ' + height" role="img" :aria-label="title">
        <clipPath :id="'c-' + title.length + height"><rect :x="LEFT" :y="TOP" :width="frame.w" :height="frame.h" /></clipPath>
        <g stroke="#d5dae1" stroke-width="0.7">
          <line v-for="v in frame.xs" :key="'x' + v" :x1="frame.px(v)" :x2="frame.px(v)" :y1="TOP" :y2="TOP + frame.h" />
          <line v-for="v in frame.ys" :key="'y' + v" :x1="LEFT" :x2="LEFT + frame.w" :y1="frame.py(v)" :y2="frame.py(v)" />
        </g>
        <g :clip-path="'url(#c-' + title.length + height + ')'">
          <rect v-for="(b, i) in bands" :key="i" :x="frame.px(b[0])" :width="Math.max(frame.px(b[1]) - frame.px(b[0]), 0.8)"
                :y="TOP" :height="frame.h" fill="#e69f00" fill-opacity="0.25" />
          <line v-if="zero" :x1="LEFT" :x2="LEFT + frame.w" :y1="frame.py(0)" :y2="frame.py(0)" stroke="#5b6675" />
          <path :d="path" fill="none" stroke="#0072b2" stroke-width="1.8" stroke-linejoin="round" />
          <template v-if="level">
            <line :x1="LEFT" :x2="LEFT + frame.w" :y1="frame.py(level.y)" :y2="frame.py(level.y)" stroke="#b3261e" stroke-dasharray="4 3" />
            <line v-for="(r, i) in level.ranges" :key="'r' + i" :x1="frame.px(r[0])" :x2="frame.px(r[1])" :y1="frame.py(level.y)"
                  :y2="frame.py(level.y)" stroke="#b3261e" stroke-width="3.5" stroke-linecap="round" />
          </template>
          <circle v-if="dot" :cx="frame.px(x[0])" :cy="frame.py(y[0])" r="3.5" fill="#1c2430" />
        </g>
        <text v-for="v in frame.xs" :key="'tx' + v" :x="frame.px(v)" :y="TOP + frame.h + 13" text-anchor="middle">{{ written(v) }}</text>
        <text v-for="v in frame.ys" :key="'ty' + v" :x="LEFT - 5" :y="frame.py(v) + 4" text-anchor="end">{{ written(v) }}</text>
        <text :x="LEFT + frame.w / 2" :y="height - 5" text-anchor="middle">{{ xlabel }}</text>
        <text :x="0" :y="0" :transform="'translate(10 ' + (TOP + frame.h / 2) + ') rotate(-90)'" text-anchor="middle">{{ ylabel }}</text>
      </svg>
    </figure>`,
};
