"use strict";
// The page: the inputs make a state, the server answers with arrays, the arrays are drawn. No mechanics here.

const DEGREE = Math.PI / 180;
const TYPES = { f4: Float32Array, u1: Uint8Array, u4: Uint32Array };
const RATIO = [-0.95, 0.5]; // of nu
const WIDER = 5; // the ends of a slider, as a factor of the value of the preset
const SMOOTH = 6, COARSEST = 3, SLOW = 1.2; // ms that drawing may take while a slider moves; largest and smallest factor by which pixels are made larger
const GROWN = 1.3, SHRUNK = 2; // factors of the size in the last front view
const PATIENCE = { whole: 200, link: 100, numbers: 150, equilibria: 500 }; // ms of rest before a longer request

const SceneHandle = { inject: ["view"], emits: ["ready"], template: "<span></span>",
  mounted() { this.$nextTick(() => this.$emit("ready", this.view)); } };

class Refused extends Error {
  constructor(reply) { super(reply.sentence); this.reply = reply; }
}

async function post(path, body, signal) {
  let answer;
  try {
    answer = await fetch(path, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body), signal });
  } catch {
    if (signal && signal.aborted) throw new Refused({ sentence: "", field: "" });
    throw new Refused({ sentence: "The server does not answer; start workbench explore again", field: "" });
  }
  if (!answer.ok) {
    const isReply = (answer.headers.get("Content-Type") || "").includes("json");
    throw new Refused(isReply ? await answer.json() : { sentence: await answer.text(), field: "" });
  }
  return answer;
}

function unpacked(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const arrays = {};
  for (const [name, type, count, at] of head.arrays) arrays[name] = new TYPES[type](buffer, 4 + length + at, count);
  return { head, arrays };
}

const toHash = (data) => btoa(String.fromCharCode(...new TextEncoder().encode(JSON.stringify(data)))).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
const fromHash = (text) => JSON.parse(new TextDecoder().decode(Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0))));

const copied = (data) => JSON.parse(JSON.stringify(data));
let view = null, actors = {}, keys = {}, polygons = {}, waiting = {}, asking = {}, busy = false, again = null; // not observed by Vue

const app = Vue.createApp({
  components: { SceneHandle },
  data: () => ({
    presets: [], readings: [], preset: "", centre: {}, state: { base: {}, units: {} }, fields: [], head: {}, rows: [], warnings: [],
    list: [], unlisted: "", searching: false, wrong: { sentence: "", field: "" }, curves: null, took: {}, message: "", studyText: "",
    nothing: { points: [0, 0, 0], polys: [1, 0] },
    mouse: [{ button: 1, action: "Rotate" }, { button: 2, action: "Pan" }, { button: 3, action: "Zoom", scrollEnabled: true },
      { button: 1, action: "Pan", shift: true }],
  }),
  watch: {
    here() { // scroll the list, not the page
      this.$nextTick(() => {
        const box = this.$refs.list, row = box?.querySelector("tr.here");
        if (row) box.scrollTop = row.offsetTop - (box.clientHeight - row.offsetHeight) / 2;
      });
    },
  },
  computed: {
    units() { return this.state.units || {}; },
    source() { return (this.presets.find((one) => one.name === this.preset) || {}).source; },
    here() {
      const at = this.state.equilibrium;
      if (!at || !this.list.length) return -1;
      const far = (key) => { const all = this.list.map((one) => one[key]), wide = Math.max(...all) - Math.min(...all) || 1; return (one) => Math.abs(one[key] - at[key]) / wide; };
      const slope = far("dbeta0"), energy = far("energy"), away = this.list.map((one) => slope(one) + energy(one));
      return away.indexOf(Math.min(...away));
    },
    diagrams() {
      const c = this.curves, { length, force } = this.units;
      return [
        { title: "Developed curve (unrolled cylinder), seen from outside", x: c.across, y: c.up, xlabel: `ρα [${length}]`, ylabel: `z [${length}]`, equal: this.head.squeeze === 1, least: 1e-6 * this.state.base.L, dot: true, height: 230 },
        { title: "Angle from the axis to the tangent", x: c.s, y: c.beta, xlabel: `s [${length}]`, ylabel: "β [°]", least: 0.2 },
        { title: "Potential G and the level h", x: c.angle, y: c.potential, xlabel: "β [°]", ylabel: `G [1/${length}²]`, level: { y: c.level[0], ranges: visited(c.beta) } },
        { title: "Push of the cylinder per length (shaded: pull)", x: c.s, y: c.push, xlabel: `s [${length}]`, ylabel: `push [${force}/${length}]`, zero: true, bands: below(c.s, c.push) },
      ];
    },
  },
  async mounted() {
    const reply = await (await fetch("/presets")).json();
    this.presets = reply.presets;
    this.readings = reply.readings;
    window.addEventListener("hashchange", () => this.follow());
    if (!this.follow()) this.begin(this.presets[0].name);
  },
  methods: {
    begin(name) {
      const one = this.presets.find((p) => p.name === name);
      this.enter(name, copied(one.state));
    },
    enter(name, state) {
      this.preset = name;
      this.centre = copied({ ...state.base });
      this.state = state;
      this.list = [];
      this.unlisted = this.message = "";
      keys.turn = true; // reset the camera
      this.ask({ fresh: true });
    },
    follow() {
      if (location.hash.length < 2 || location.hash === keys.hash) return location.hash.length > 1;
      try {
        const { preset, state } = fromHash(location.hash.slice(1));
        if (typeof state.base !== "object" || typeof state.units !== "object") throw new Error();
        this.enter(this.presets.some((p) => p.name === preset) ? preset : this.presets[0].name, state);
        return true;
      } catch {
        this.wrong = { sentence: "This link is invalid", field: "" };
        return false;
      }
    },
    // a number of the state: stored, shown, and on a slider
    span(f) { return (this.presets.find((p) => p.name === this.preset)?.spans || {})[f.name]; },
    range(f) {
      const c = this.centre[f.name];
      if (f.kind === "ratio") return RATIO;
      if (f.kind === "positive") return [c / WIDER, c * WIDER];
      if (Array.isArray(this.span(f))) return this.span(f);
      const far = this.span(f) || (f.kind === "angle" ? (f.name === "betaL" ? 2 : 1) * Math.PI : 4 * Math.abs(c || 0) || 1);
      return [-far, far];
    },
    position(f) {
      const [low, high] = this.range(f), v = this.state.base[f.name];
      return 1000 * (f.kind === "positive" ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low));
    },
    slid(f, event) {
      const [low, high] = this.range(f), u = event.target.value / 1000;
      this.set(f, Number((f.kind === "positive" ? low * (high / low) ** u : low + u * (high - low)).toPrecision(6)));
    },
    shown(f) {
      const v = this.state.base[f.name];
      return v === null || v === undefined ? "" : Number((f.kind === "angle" ? v / DEGREE : v).toPrecision(7));
    },
    typed(f, event) {
      const text = event.target.value, v = Number(text);
      this.set(f, text === "" ? null : f.kind === "angle" ? v * DEGREE : v);
    },
    set(f, value) { this.state.base[f.name] = value; this.ask(); },
    dropped(f) { return ((this.head.meaning || {})[f.name] || "").includes("dropped"); },
    digits: (v) => written(Number(v.toPrecision(5))),
    ms: (v) => (v === undefined ? "" : `${v.toFixed(1)} ms`),
    looks: (part) => part === "rod" ? { specular: 0.3, specularPower: 25, interpolation: 2, ambient: 0.12, diffuse: 0.9 } : { ambient: 0.5, diffuse: 0.55 },
    // one request at a time; of those that wait only the last is sent
    async ask(how = {}) {
      const at = performance.now();
      if (busy) { again = { ...how, fresh: how.fresh || (again || {}).fresh }; return; }
      busy = true;
      try {
        const near = how.fresh || this.head.problem !== "ends" ? undefined : this.head.ticket;
        if (!how.fresh && !how.chosen && this.state.equilibrium && !near) delete this.state.equilibrium;
        const answer = await post("/shape", { state: this.state, near: how.chosen ? undefined : near, rod_has: keys.rod, wall_has: keys.wall });
        const { head, arrays } = unpacked(await answer.arrayBuffer());
        const back = performance.now();
        this.take(head, arrays);
        const drawn = this.draw(head, arrays);
        this.took = { solve: 1e3 * head.seconds.solve, mesh: 1e3 * head.seconds.mesh, back: back - at, draw: drawn - back };
        document.dispatchEvent(new CustomEvent("drawn", { detail: { ...this.took, all: drawn - (how.since || at) } }));
        this.later(how);
      } catch (error) {
        if (!(error instanceof Refused)) throw error;
        this.wrong = error.reply;
      } finally {
        busy = false;
        if (again) { const next = again; again = null; this.ask({ ...next, since: at }); }
      }
    },
    take(head, arrays) {
      this.wrong = { sentence: "", field: "" };
      this.head = Object.freeze(head);
      this.fields = head.fields;
      if (head.which) this.state.equilibrium = head.which;
      this.curves = Vue.markRaw(arrays);
    },
    link() {
      keys.hash = "#" + toHash({ preset: this.preset, state: this.state });
      history.replaceState(null, "", keys.hash);
    },
    later(how) {
      clearTimeout(waiting.link);
      waiting.link = setTimeout(() => this.link(), PATIENCE.link);
      clearTimeout(waiting.numbers);
      waiting.numbers = setTimeout(() => this.more("/numbers", (reply) => { this.rows = reply.rows; this.warnings = reply.warnings; }), PATIENCE.numbers);
      if (this.head.problem !== "ends") { this.list = []; return; }
      if (how.chosen) return;
      clearTimeout(waiting.list);
      this.searching = true;
      waiting.list = setTimeout(() => this.more("/equilibria", (reply) => this.found(reply.rows), (why) => this.found([], why)), PATIENCE.equilibria);
    },
    found(rows, why = "") {
      this.list = rows;
      this.unlisted = why;
      this.searching = false;
      if (this.head.method === "difference" && this.here >= 0) this.choose(this.here); // followed to 1e-6: now solved exactly
    },
    async more(path, then, refused = (why) => { this.message = why; }) {
      const ticket = this.head.ticket;
      if (asking[path]) asking[path].abort(); // the server then stops that search
      const mine = asking[path] = new AbortController();
      try {
        const reply = await (await post(path, { state: this.state, ticket }, mine.signal)).json();
        if (ticket === this.head.ticket) then(reply);
      } catch (error) {
        if (mine.signal.aborted) return; // a newer request replaced it
        if (!(error instanceof Refused)) throw error;
        if (ticket === this.head.ticket) refused(error.reply.sentence);
      }
    },
    async byEnds() {
      try {
        const state = await (await post("/ends", { state: this.state })).json();
        this.enter(this.preset, state);
      } catch (error) { this.refuse(error); }
    },
    choose(i) {
      const { dbeta0, energy } = this.list[i];
      this.state.equilibrium = { dbeta0, energy };
      this.ask({ chosen: true });
    },
    step(by) { this.choose((Math.max(this.here, 0) + by + this.list.length) % this.list.length); },
    refuse(error) {
      if (!(error instanceof Refused)) throw error;
      this.wrong = error.reply;
    },
    // the scene
    ready(handle) {
      view = handle;
      for (const actor of view.renderer.getActors()) {
        const id = (actor.get("representationId") || {}).representationId;
        if (id) actors[id] = actor;
      }
      if (keys.scene) this.draw(...keys.scene);
    },
    draw(head, arrays) {
      if (!view) { keys.scene = [head, arrays]; return performance.now(); }
      for (const part of ["wall", "rod"]) {
        const data = actors[part].getMapper().getInputData(0), points = data.getPointData();
        data.getPoints().setData(arrays[`${part}.points`], 3);
        for (const [name, role] of [["normals", "setNormals"], ["colours", "setScalars"]]) {
          const array = points.getArrayByName(name);
          array.setData(arrays[`${part}.${name}`], 3);
          points[role](array); // vtk.js takes it only once it has three components
        }
        if (arrays[`${part}.polygons`]) polygons[part] = { all: arrays[`${part}.polygons`], few: arrays[`${part}.coarse`] };
        const some = keys.turn || keys.coarse < SLOW ? polygons[part].all : polygons[part].few || polygons[part].all;
        if (data.getPolys().getData() !== some) data.getPolys().setData(some);
        keys[part] = head[`${part}_key`];
        points.modified();
        data.modified();
      }
      actors.wall.getProperty().setFrontfaceCulling(head.side === "inside"); // cut open: the near half is not drawn
      this.follows();
      view.renderer.resetCameraClippingRange();
      if (keys.turn) { keys.turn = false; this.face(); this.weigh(); } else this.sketch();
      view.renderWindow.render();
      return performance.now();
    },
    // where drawing is slow (no graphics card), fewer pixels and triangles while a slider moves, all of them at rest
    weigh() {
      const gl = view.openglRenderWindow.get3DContext(), from = performance.now();
      view.renderWindow.render();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // waits until they are drawn
      keys.coarse = Math.min(Math.max(Math.sqrt((performance.now() - from) / SMOOTH), 1), COARSEST);
    },
    sketch() {
      if (keys.coarse < SLOW) return;
      const box = view.container.getBoundingClientRect(), scale = (window.devicePixelRatio || 1) / keys.coarse;
      const size = [box.width, box.height].map((v) => Math.max(Math.floor(v * scale), 10)), now = view.openglRenderWindow.getSize();
      if (size[0] !== now[0] || size[1] !== now[1]) view.openglRenderWindow.setSize(...size);
      clearTimeout(waiting.whole);
      waiting.whole = setTimeout(() => this.whole(), PATIENCE.whole);
    },
    whole() {
      const data = actors.rod.getMapper().getInputData(0);
      data.getPolys().setData(polygons.rod.all);
      data.modified();
      view.resize();
    },
    // a rod that has grown or shrunk much is seen from farther or nearer, from the same side
    follows() {
      const { middle, size } = this.extent(), camera = view.renderer.getActiveCamera();
      if (!keys.size || (size < GROWN * keys.size && size > keys.size / SHRUNK)) return;
      const side = camera.getDirectionOfProjection();
      camera.setParallelScale((camera.getParallelScale() * size) / keys.size);
      camera.set({ focalPoint: middle, position: middle.map((v, i) => v - 2 * size * side[i]) });
      view.style.setCenterOfRotation(middle);
      keys.size = size;
    },
    extent() {
      const [x0, x1, y0, y1, z0, z1] = view.renderer.computeVisiblePropBounds();
      return { middle: [(x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2], size: Math.hypot(x1 - x0, y1 - y0, z1 - z0) };
    },
    face() {
      if (!view) return;
      keys.size = this.extent().size;
      const alpha = (this.curves ? this.curves.across[this.curves.across.length >> 1] : 0), [x0, x1, y0, y1, z0, z1] = view.renderer.computeVisiblePropBounds();
      const { middle } = this.extent(), lift = 0.3; // rad by which the camera looks down
      const camera = view.renderer.getActiveCamera(), turn = Number.isFinite(alpha) ? alpha / Math.max(x1, 1e-12) : 0;
      camera.setParallelProjection(true);
      camera.set({ focalPoint: middle, viewUp: [0, 0, 1], position: [middle[0] + Math.cos(turn), middle[1] + Math.sin(turn), middle[2] + Math.tan(lift)] });
      view.renderer.resetCamera();
      const [wide, high] = view.openglRenderWindow.getSize(), across = Math.hypot(x1 - x0, y1 - y0) / Math.SQRT2;
      const tall = (z1 - z0) * Math.cos(lift) + across * Math.sin(lift);
      camera.setParallelScale(0.53 * Math.max(tall, (across * high) / wide));
      view.style.setCenterOfRotation(middle);
      view.renderWindow.render();
    },
    // downloads
    save(data, type, name) {
      const url = URL.createObjectURL(data instanceof Blob ? data : new Blob([data], { type }));
      Object.assign(document.createElement("a"), { href: url, download: name }).click();
      setTimeout(() => URL.revokeObjectURL(url), 1000);
    },
    async picture() {
      const made = view.openglRenderWindow.captureNextImage("image/png");
      view.renderWindow.render();
      const bytes = Uint8Array.from(atob((await made).split(",")[1]), (c) => c.charCodeAt(0));
      this.save(bytes, "image/png", `${this.preset}.png`);
      this.message = "The picture is saved in your downloads.";
    },
    async download(kind) {
      this.message = "";
      try {
        const answer = await post("/download", { kind, state: this.state, ticket: this.head.ticket });
        this.save(await answer.blob(), "", `${this.preset}.${kind}`);
        this.message = `The ${kind.toUpperCase()} file is saved in your downloads.`;
      } catch (error) {
        if (!(error instanceof Refused)) throw error;
        this.message = error.reply.sentence;
      }
    },
    async copyStudy() {
      try {
        this.studyText = (await (await post("/study", { state: this.state })).json()).text;
        this.$refs.study.showModal();
        await this.copy(this.studyText, "The study is copied.");
      } catch (error) { this.refuse(error); }
    },
    copyLink() { this.link(); return this.copy(location.href, "The link is copied."); },
    async copy(text, then) {
      try {
        await navigator.clipboard.writeText(text);
        this.message = then;
      } catch { this.message = "The browser does not allow copying; copy the address bar or the text by hand."; }
    },
  },
});

// the intervals of beta along the rod, within one rotation [degrees]
function visited(beta) {
  let low = Infinity, high = -Infinity;
  for (const b of beta) { low = Math.min(low, b); high = Math.max(high, b); }
  if (high - low >= 360) return [[-180, 180]];
  const shift = 360 * Math.floor((low + 180) / 360);
  low -= shift; high -= shift;
  return high <= 180 ? [[low, high]] : [[low, 180], [-180, high - 360]];
}

// the intervals of s on which values are negative
function below(s, values) {
  const found = [];
  let from = null;
  for (let i = 0; i < s.length; i++) {
    if (values[i] < 0 && from === null) from = s[i];
    if (values[i] >= 0 && from !== null) { found.push([from, s[i]]); from = null; }
  }
  return from === null ? found : [...found, [from, s[s.length - 1]]];
}

app.use(vue_vtk);
app.component("RodDiagram", RodDiagram);
window.page = app.mount("#page");
