// WebGL 2 for the scene: a program, surfaces, textures, and targets to draw into.

import { STRIDE } from "./tube.mjs";

/* The program of two shaders. */
export function linked(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
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

export function surface(gl) {
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
export function covering(gl, part) {
  part.covered = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, part.covered);
  gl.enableVertexAttribArray(3);
  gl.vertexAttribPointer(3, 1, gl.FLOAT, false, 4, 0);
  return part;
}

export function fill(gl, part, corners, triangles) {
  gl.bindVertexArray(part.array);
  gl.bindBuffer(gl.ARRAY_BUFFER, part.corners);
  gl.bufferData(gl.ARRAY_BUFFER, corners, gl.DYNAMIC_DRAW);
  if (!triangles) return;
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
  part.size = triangles.length;
}

export function shown(gl, part) {
  gl.bindVertexArray(part.array);
  gl.drawElements(gl.TRIANGLES, part.size, gl.UNSIGNED_INT, 0);
}

/* A new texture of a sampler; around the cylinder it repeats. */
export function textured(gl, sampler, unit, filter) {
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, unit ? gl.REPEAT : gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  gl.uniform1i(sampler, unit);
}

/* A target with four samples a pixel, kept for the next picture of the same size. */
export function sampled(gl, state, width, height) {
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

export function plain(gl, width, height) {
  const target = gl.createFramebuffer(),
    one = gl.createRenderbuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, target);
  gl.bindRenderbuffer(gl.RENDERBUFFER, one);
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA8, width, height);
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, one);
  return target;
}
