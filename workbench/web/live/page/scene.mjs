// Rod and cylinder by WebGL 2: two surfaces, one light from above the eye's left shoulder, one from the eye.

import { axesOf, matrix } from "./camera.mjs";
import { ramp } from "./colours.mjs";
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
  HIDDEN = 2; // what a fragment belongs to; HIDDEN: a stretch behind the wall, in outline
const UNIFORMS = ["view", "turn", "wall", "part", "ramp", "light", "line", "hidden", "ends", "depth", "covered"];
const FRAGMENT = `#version 300 es
precision highp float;
in vec3 way, spot, outward; in float value, shaded;
uniform sampler2D ramp, light; uniform vec3 wall, line; uniform vec3 hidden; uniform vec2 ends; uniform int part;
uniform float depth, covered;
out vec4 colour;
void main() {
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
}`.replace(/\b(ROD|WALL|HIDDEN)\b/g, (name) => ({ ROD, WALL, HIDDEN })[name]);

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

  /* What stands off the rod to show the push; null for nothing. */
  function setMarks(marks) {
    surfaces.marks.size = 0;
    if (marks) fill(gl, surfaces.marks, marks.corners, marks.triangles);
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
  const program = linked(gl),
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
    surfaces: { rod: covering(gl, surface(gl)), ends: surface(gl), wall: surface(gl), marks: surface(gl) },
    state: { open: false, depth: 1, a: 1, smooth: null, walls: {} },
  };
}

function linked(gl) {
  const program = gl.createProgram();
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, VERTEX],
    [gl.FRAGMENT_SHADER, FRAGMENT],
  ]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  ["place", "normal", "push", "cover"].forEach((name, i) => gl.bindAttribLocation(program, i, name));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(program));
  return program;
}

function surface(gl) {
  const found = { array: gl.createVertexArray(), corners: gl.createBuffer(), triangles: gl.createBuffer(), size: 0 };
  gl.bindVertexArray(found.array);
  gl.bindBuffer(gl.ARRAY_BUFFER, found.corners);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, found.triangles);
  [
    [3, 0],
    [3, 3],
    [1, 6],
  ].forEach(([size, first], i) => {
    gl.enableVertexAttribArray(i);
    gl.vertexAttribPointer(i, size, gl.FLOAT, false, 4 * STRIDE, 4 * first);
  });
  return found;
}

/* A surface of which each corner has a number of its own: how much other stretches cover it; of others it is 0. */
function covering(gl, part) {
  part.covered = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, part.covered);
  gl.enableVertexAttribArray(3);
  gl.vertexAttribPointer(3, 1, gl.FLOAT, false, 4, 0);
  return part;
}

function fill(gl, part, corners, triangles) {
  gl.bindVertexArray(part.array);
  gl.bindBuffer(gl.ARRAY_BUFFER, part.corners);
  gl.bufferData(gl.ARRAY_BUFFER, corners, gl.DYNAMIC_DRAW);
  if (!triangles) return;
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
  part.size = triangles.length;
}

function shown(gl, part) {
  gl.bindVertexArray(part.array);
  gl.drawElements(gl.TRIANGLES, part.size, gl.UNSIGNED_INT, 0);
}

/* A new texture of a sampler; around the cylinder it repeats. */
function textured(gl, sampler, unit, filter) {
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, unit ? gl.REPEAT : gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  gl.uniform1i(sampler, unit);
}

/* A target with four samples a pixel, kept for the next picture of the same size. */
function sampled(gl, state, width, height) {
  if (state.smooth && state.smooth.width === width && state.smooth.height === height) return state.smooth.target;
  if (state.smooth) {
    gl.deleteFramebuffer(state.smooth.target);
    for (const one of state.smooth.parts) gl.deleteRenderbuffer(one);
  }
  const target = gl.createFramebuffer(),
    samples = Math.min(4, gl.getParameter(gl.MAX_SAMPLES));
  gl.bindFramebuffer(gl.FRAMEBUFFER, target);
  const parts = [
    [gl.RGBA8, gl.COLOR_ATTACHMENT0],
    [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT],
  ].map(([kind, place]) => {
    const one = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, one);
    gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, kind, width, height);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, one);
    return one;
  });
  state.smooth = { target, parts, width, height };
  return target;
}

function plain(gl, width, height) {
  const target = gl.createFramebuffer(),
    one = gl.createRenderbuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, target);
  gl.bindRenderbuffer(gl.RENDERBUFFER, one);
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA8, width, height);
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, one);
  return target;
}
