"use strict";
// The interactive view in the report: vtk.js and the scene are unpacked from the page itself, no address is contacted. The
// still picture stays where the browser has no WebGL, where scripts are off, and on paper.

const ABOVE = 0.3; // rad by which the camera looks down
const LYING = 1.3; // how much taller than wide a rod must be to be laid on its side, where the page is wide
const STEP = 1.25; // of a press on + or -
const MOUSE = [{ button: 1, action: "Rotate" }, { button: 2, action: "Pan" }, { button: 3, action: "Zoom", scrollEnabled: true },
  { button: 1, action: "Pan", shift: true }];

async function unpacked(id) {
  const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const plus = (a, s, b) => a.map((value, i) => value + s * b[i]);
const unit = (a) => { const size = Math.sqrt(dot(a, a)); return a.map((value) => value / size); };

// a component beside those of vtk.js that hands out the view once it exists
const Handle = (ready) => ({ inject: ["view"], mounted() { this.$nextTick(() => ready(this.view)); }, render: () => null });

function mounted(viewport, parts, ready) {
  const handle = Handle(ready), empty = { points: [0, 0, 0], polys: [1, 0] };
  const app = Vue.createApp({
    render() {
      const [view, shape, mesh, values, array] = ["vtk-view", "vtk-geometry-representation", "vtk-polydata", "vtk-point-data", "vtk-data-array"].map(Vue.resolveComponent);
      const h = Vue.h;
      return h(view, { background: [1, 1, 1], interactorSettings: MOUSE }, () => [
        ...parts.map((part) => h(shape, { key: part.name, id: part.name, property: looks(part) }, () =>
          h(mesh, empty, () => h(values, null, () => h(array, { name: "normals", numberOfComponents: 3, values: empty.points }))))),
        h(handle)]);
    },
  });
  app.use(vue_vtk);
  app.mount(viewport);
}

const looks = (part) => part.name === "wall"
  ? { opacity: part.opacity, ambient: 0.5, diffuse: 0.55 }
  : { ambient: 0.12, diffuse: 0.9, specular: 0.3, specularPower: 25, interpolation: 2 };

function fill(view, parts) {
  const actors = {};
  for (const actor of view.renderer.getActors()) actors[(actor.get("representationId") || {}).representationId] = actor;
  for (const part of parts) {
    const actor = actors[part.name], mapper = actor.getMapper(), data = mapper.getInputData(0), values = data.getPointData();
    mapper.setScalarVisibility(false);
    actor.getProperty().setColor(...part.colour);
    data.getPoints().setData(new Float32Array(part.points), 3);
    const normals = values.getArrayByName("normals");
    normals.setData(new Float32Array(part.normals), 3);
    values.setNormals(normals); // vtk.js takes it only once it has three components
    data.getPolys().setData(new Uint32Array(part.polygons));
    values.modified();
    data.modified();
  }
}

// The camera in front of the rod, turned about the axis by an angle; as near as the box allows
function face(viewport, view, scene, turned) {
  const wide = viewport.clientWidth, high = viewport.clientHeight; // the view itself gets its size only later
  const [x0, x1, y0, y1, z0, z1] = view.renderer.computeVisiblePropBounds();
  const lies = wide > high && z1 - z0 > LYING * (x1 - x0);
  const angle = scene.azimuth + turned, out = [Math.cos(angle), Math.sin(angle), 0], axis = [0, 0, 1];
  let toward = plus(out.map((value) => Math.cos(ABOVE) * value), Math.sin(ABOVE), axis);
  if (lies) toward = plus(toward, Math.tan(ABOVE), cross(out, axis));
  toward = unit(toward);
  const flat = unit(plus(axis, -dot(toward, axis), toward)), up = lies ? cross(toward, flat) : flat, right = cross(up, toward);
  let across = 0, tall = 0;
  for (const x of [x0, x1]) for (const y of [y0, y1]) for (const z of [z0, z1]) {
    const corner = [x - (x0 + x1) / 2, y - (y0 + y1) / 2, z - (z0 + z1) / 2];
    across = Math.max(across, Math.abs(dot(corner, right)));
    tall = Math.max(tall, Math.abs(dot(corner, up)));
  }
  const middle = [(x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2], camera = view.renderer.getActiveCamera();
  camera.setParallelProjection(true);
  camera.set({ focalPoint: middle, viewUp: up, position: plus(middle, 10 * Math.max(across, tall), toward) });
  camera.setParallelScale(1.02 * Math.max(tall, (across * high) / wide));
  view.style.setCenterOfRotation(middle);
  drawn(view);
}

function nearer(view, factor) {
  const camera = view.renderer.getActiveCamera();
  camera.setParallelScale(camera.getParallelScale() / factor);
  drawn(view);
}

function drawn(view) {
  view.renderer.resetCameraClippingRange();
  view.renderWindow.render();
}

// The wheel scrolls the page until the view is touched, and again once the pointer has left it.
function behave(viewport, view) {
  let held = false;
  viewport.addEventListener("pointerdown", () => { held = true; }, true);
  viewport.addEventListener("pointerleave", () => { held = false; });
  viewport.addEventListener("wheel", (event) => { if (!held && !event.ctrlKey) event.stopPropagation(); }, true);
  view.openglRenderWindow.getContainer().style.touchAction = "pan-y";
}

async function begin(figure) {
  const viewport = figure.querySelector(".viewport"), message = figure.querySelector(".message");
  if (!document.createElement("canvas").getContext("webgl2")) { message.textContent = "This browser has no WebGL, so only the still picture is shown."; return; }
  for (const id of ["vue.js", "vtk.js"]) document.head.append(Object.assign(document.createElement("script"), { textContent: await unpacked(id) }));
  const scene = JSON.parse(await unpacked("scene"));
  figure.classList.add("live", "ready");
  let turned = 0, untouched = true;
  mounted(viewport, scene.parts, (view) => settled(() => { // until then its parts are replaced and its camera is reset
    fill(view, scene.parts);
    behave(viewport, view);
    const turn = (angle) => { turned = angle; untouched = true; face(viewport, view, scene, turned); };
    const acts = { front: () => turn(0), side: () => turn(-Math.PI / 2), nearer: () => nearer(view, STEP),
      farther: () => nearer(view, 1 / STEP), still: () => figure.classList.toggle("live") };
    for (const button of figure.querySelectorAll("button")) button.addEventListener("click", acts[button.name]);
    viewport.addEventListener("pointerdown", () => { untouched = false; }, true);
    new ResizeObserver(() => settled(() => { if (untouched && viewport.clientWidth) turn(turned); })).observe(viewport);
    turn(0);
    figure.view = view;
  }));
}

const settled = (then) => setTimeout(() => requestAnimationFrame(() => requestAnimationFrame(then)), 50);

const figure = document.querySelector("figure.turns");
new IntersectionObserver((seen, watch) => {
  if (!seen.some((one) => one.isIntersecting)) return;
  watch.disconnect();
  begin(figure);
}, { rootMargin: "400px" }).observe(figure);
