// Rod and cylinder by WebGL 2: two surfaces, one light from above the eye's left shoulder, one from the eye.

import { axesOf, matrix } from "./camera.mjs";
import { ramp } from "./colours.mjs";
import { covering, fill, linked, plain, sampled, shown, surface, textured } from "./webgl.mjs";
import { STRIDE, endTriangles, wallTriangles } from "./tube.mjs";

const TONES = 1024; // so many that the change from pull to push is sharp
const OUTLINE = 1 / 350; // of the height of a view: the width of the outline of a hidden stretch
const VERTEX = `#version 300 es
in vec3 place; in vec3 normal; in float push; in float cover;
uniform mat4 view; uniform mat3 turn;
out vec3 way, spot, outward; out float value, shaded;
void main() { shaded = cover; gl_Position = view * vec4(place, 1.0); way = turn * normal; spot = place; outward = normal; value = push; }`;
const ROD = 0,
  WALL = 1,
  HIDDEN = 2, // what a fragment belongs to; HIDDEN: a stretch behind the wall, in outline
  INK = 3; // marks that say nothing of the push
const UNIFORMS = ["view", "turn", "wall", "part", "ramp", "light", "line", "hidden", "ends", "depth", "covered"];
const FRAGMENT = `#version 300 es
precision highp float;
in vec3 way, spot, outward; in float value, shaded;
uniform sampler2D ramp, light; uniform vec3 wall, line; uniform vec3 hidden; uniform vec2 ends; uniform int part;
uniform float depth, covered;
out vec4 colour;
void main() {
  if (part == INK) { colour = vec4(0.55 * line, 1.0); return; }
  vec3 n = normalize(way);
  if (!gl_FrontFacing) n = -n;
  bool isRod = part == ROD;
  float rises = dot(outward, normalize(vec3(spot.xy, 0.0))); // away from the axis
  if (part == HIDDEN) {
    float share = n.z < hidden.x && rises > -0.5 ? hidden.y : 0.0; // not the lower side of a rod beyond the horizon
    colour = vec4(line * share, 1.0 - (1.0 - share) * (1.0 - hidden.z));
    return;
  }
  float reaches = isRod ? 1.0 - depth * min(shaded + covered * (0.25 - 0.25 * rises), 1.0)
    : abs(outward.z) > 0.5 ? 1.0
    : texture(light, vec2(atan(spot.y, spot.x) / 6.2831853, (spot.z - ends.x) / (ends.y - ends.x))).r;
  vec3 base = isRod ? texture(ramp, vec2(0.5 + 0.5 * value, 0.5)).rgb : wall;
  float key = max(dot(n, vec3(-0.40, 0.55, 0.73)), 0.0), eye = max(n.z, 0.0);
  float bright = reaches * (isRod ? 0.46 + 0.42 * key + 0.24 * eye : 0.68 + 0.2 * key + 0.24 * eye);
  float edge = isRod ? mix(0.55, 1.0, smoothstep(0.02, 0.36, eye)) : 1.0;
  float shine = max(dot(n, vec3(-0.215, 0.296, 0.931)), 0.0);
  shine *= shine; shine *= shine; shine *= shine; shine *= shine; shine *= shine; // to the power 32
  colour = vec4(base * bright * edge + (isRod ? 0.18 * shine : 0.0), 1.0);
}`.replace(/\b(ROD|WALL|HIDDEN|INK)\b/g, (name) => ({ ROD, WALL, HIDDEN, INK })[name]);

/* Draws in a canvas; null without WebGL 2. onContext(lost): called when the browser takes the drawing context away (true)
   and when it has given it back (false): then all buffers are new and empty. */
export function makeScene(canvas, code, onContext) {
  const gl = canvas.getContext("webgl2", {
    antialias: false,
    alpha: true,
    premultipliedAlpha: true,
    preserveDrawingBuffer: false,
  });
  if (!gl) return null;
  let { where, surfaces, state } = resources(gl, code);
  canvas.addEventListener("webglcontextlost", (event) => {
    event.preventDefault(); // only then does the browser give it back
    onContext(true);
  });
  canvas.addEventListener("webglcontextrestored", () => {
    ({ where, surfaces, state } = resources(gl, code));
    onContext(false);
  });

  /* The tube: its corners, number of rings and sides, and how much other stretches cover each. The ends share its corners. */
  function setRod(corners, count, sides, covered) {
    const known = state.walls[sides];
    if (!known || known.count < count)
      state.walls = { [sides]: { count: 2 * count, triangles: wallTriangles(2 * count, sides), fresh: true } };
    fill(gl, surfaces.rod, corners, state.walls[sides].fresh ? state.walls[sides].triangles : null);
    state.walls[sides].fresh = false;
    surfaces.rod.size = 6 * (count - 1) * sides;
    gl.bindBuffer(gl.ARRAY_BUFFER, surfaces.rod.covered);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(corners.length / STRIDE), gl.DYNAMIC_DRAW);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, covered);
    const first = count * sides;
    fill(gl, surfaces.ends, corners.subarray(STRIDE * first), endTriangles(0, sides));
  }

  /* What stands off the rod to show the push, and what marks its contacts; null for nothing. */
  function setMarks(marks, inks) {
    for (const [to, from] of [[surfaces.marks, marks], [surfaces.inks, inks]]) {
      to.size = 0;
      if (from) fill(gl, to, from.corners, from.triangles);
    }
  }

  function setWall({ corners, triangles, low, high }, open, depth) {
    fill(gl, surfaces.wall, corners, triangles);
    gl.uniform2f(where.ends, low, high);
    gl.uniform1f(where.covered, open ? 0 : 1);
    Object.assign(state, { open, depth });
  }

  /* The light on the wall beside the rod, and the rod's radius. */
  function setLight({ width, height, bytes }, a) {
    state.a = a;
    gl.activeTexture(gl.TEXTURE1);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R8, width, height, 0, gl.RED, gl.UNSIGNED_BYTE, bytes);
  }

  function paint(camera, width, height) {
    const aspect = width / height,
      { right, up, toward } = axesOf(camera);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(where.view, false, matrix(camera, aspect, state.depth));
    gl.uniformMatrix3fv(
      where.turn,
      false,
      [0, 1, 2].flatMap((k) => [right[k], up[k], toward[k]]),
    );
    gl.enable(gl.CULL_FACE);
    gl.cullFace(state.open ? gl.FRONT : gl.BACK); // of an open wall the near half is not drawn
    gl.uniform1i(where.part, WALL);
    shown(gl, surfaces.wall);
    gl.cullFace(gl.BACK);
    if (!state.open) {
      const share = Math.min((2 * OUTLINE * camera.half) / state.a, 1); // of the radius
      gl.uniform3f(where.hidden, Math.sqrt(1 - (1 - share) ** 2), code.line, code.shade);
      gl.uniform1i(where.part, HIDDEN);
      gl.depthFunc(gl.GREATER);
      (gl.depthMask(false), gl.enable(gl.BLEND));
      shown(gl, surfaces.rod);
      (gl.depthMask(true), gl.disable(gl.BLEND));
      gl.depthFunc(gl.LESS);
    }
    gl.uniform1i(where.part, ROD);
    for (const part of [surfaces.rod, surfaces.ends]) shown(gl, part);
    gl.disable(gl.CULL_FACE);
    shown(gl, surfaces.marks);
    gl.uniform1i(where.part, INK);
    shown(gl, surfaces.inks);
  }

  /* Draw at so many pixels for one pixel of the page; smooth: with four samples a pixel. */
  function draw(camera, ratio, smooth) {
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio)),
      height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    if (!smooth) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      paint(camera, width, height);
      return;
    }
    const target = sampled(gl, state, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    paint(camera, width, height);
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, target);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /* The scene as pixels, row by row from the top: red, green, blue and opacity. */
  function pixels(camera, width, height) {
    const [high, low] = [sampled(gl, {}, width, height), plain(gl, width, height)],
      bytes = new Uint8Array(4 * width * height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, high);
    paint(camera, width, height);
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, high);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, low);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, low);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    const found = new Uint8ClampedArray(bytes.length);
    for (let y = 0; y < height; y++)
      found.set(bytes.subarray(4 * width * (height - 1 - y), 4 * width * (height - y)), 4 * width * y);
    for (let i = 0; i < found.length; i += 4)
      // edges are stored as shares of their colour
      if (found[i + 3] > 0 && found[i + 3] < 255)
        for (let k = 0; k < 3; k++) found[i + k] = (255 * found[i + k]) / found[i + 3];
    return found;
  }

  const wait = () => gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // until all is drawn
  const isLost = () => gl.isContextLost();
  return { setRod, setMarks, setWall, setLight, draw, pixels, wait, isLost, largest: gl.getParameter(gl.MAX_RENDERBUFFER_SIZE) };
}

/* The program, its buffers and colours; after a loss of the context they are made again. */
function resources(gl, code) {
  const program = linked(gl, VERTEX, FRAGMENT),
    where = {};
  for (const name of UNIFORMS) where[name] = gl.getUniformLocation(program, name);
  gl.useProgram(program);
  const share = (rgb) => rgb.map((v) => v / 255);
  gl.uniform3fv(where.wall, share(code.surface));
  gl.uniform3fv(where.line, share(code.outline));
  gl.uniform1f(where.depth, code.depth);
  textured(gl, where.ramp, 0, gl.NEAREST);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, TONES, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(ramp(code, TONES)));
  textured(gl, where.light, 1, gl.LINEAR);
  gl.enable(gl.DEPTH_TEST);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  return {
    where,
    surfaces: { rod: covering(gl, surface(gl)), ends: surface(gl), wall: surface(gl), marks: surface(gl), inks: surface(gl) },
    state: { open: false, depth: 1, a: 1, smooth: null, walls: {} },
  };
}
