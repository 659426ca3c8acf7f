// SPDX-License-Identifier: LGPL-2.1-or-later
// Paints a frame by WebGL 2, or by a plain canvas where there is none.
"use strict";

const FORCE_COLOUR = [0.84, 0.2, 0.42], TOOL_COLOUR = [0.53, 0.58, 0.63], TOOL_SHARE = 0.22;

const SHARED = `#version 300 es
precision highp float;
`;
// Places become those of WebGL: `rows` has the camera, `middle` its centre, `fit` pixels to the unit square.
const PLACE = `
uniform mat3 rows; uniform vec3 middle; uniform vec2 fit, pan; uniform float depth;
vec4 placed(vec3 p) { vec3 v = rows * (p - middle); return vec4(v.xy * fit + pan, -v.z * depth, 1.0); }
`;
const FACE_VERTEX = SHARED + PLACE + `
in vec3 position; in float value; in vec2 corner; out vec3 seen; flat out float level; out vec2 place;
void main() { seen = rows * (position - middle); level = value; place = corner; gl_Position = placed(position); }`;
const FACE_FRAGMENT = SHARED + `
uniform sampler2D colours; uniform float edges; in vec3 seen; flat in float level; in vec2 place; out vec4 colour;
void main() {
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  float light = 0.62 + 0.38 * abs(dot(normal, normalize(vec3(-0.25, 0.35, 1.0))));
  vec2 width = max(fwidth(place), vec2(1e-6)), far = min(place, 1.0 - place) / width;
  float line = edges * (1.0 - smoothstep(0.4, 1.3, min(far.x, far.y))) * clamp(0.35 / max(width.x, width.y), 0.0, 1.0);
  colour = vec4(texture(colours, vec2((level + 0.5) / 256.0, 0.5)).rgb * light * (1.0 - 0.38 * line), 1.0);
}`;
// The ellipsoid c + A s, |s| = 1, is the ellipse c + S d, |d| = 1, in a parallel view: S is the root of the part of
// R A A R^T across the view.
const BALL_VERTEX = SHARED + PLACE + `
uniform float pixels; in vec3 position, diagonal, mixed; in float value; out float level, reach; out vec3 inverse;
void main() {
  mat3 shape = mat3(diagonal.x, mixed.z, mixed.y, mixed.z, diagonal.y, mixed.x, mixed.y, mixed.x, diagonal.z);
  mat3 turned = rows * shape, square = turned * transpose(turned);
  float a = square[0][0], b = square[1][0], c = square[1][1], root = sqrt(max(a * c - b * b, 1e-12 * (a + c) * (a + c)));
  float largest = sqrt(0.5 * (a + c) + sqrt(0.25 * (a - c) * (a - c) + b * b)), size = sqrt(a + c + 2.0 * root);
  inverse = vec3(c + root, -b, a + root) * largest / (root * size);
  level = value; reach = sqrt(square[2][2]) * depth;
  gl_Position = placed(position); gl_PointSize = max(2.0 * largest * pixels, 2.0);
}`;
const BALL_FRAGMENT = SHARED + `
uniform sampler2D colours; in float level, reach; in vec3 inverse; out vec4 colour;
void main() {
  vec2 p = (2.0 * gl_PointCoord - 1.0) * vec2(1.0, -1.0);
  vec2 d = vec2(dot(inverse.xy, p), dot(inverse.yz, p)); float inside = 1.0 - dot(d, d);
  if (inside < 0.0) discard;
  vec3 normal = vec3(d, sqrt(inside));
  float light = 0.58 + 0.42 * max(dot(normal, normalize(vec3(-0.25, 0.35, 1.0))), 0.0);
  colour = vec4(texture(colours, vec2((level + 0.5) / 256.0, 0.5)).rgb * light, 1.0);
  gl_FragDepth = gl_FragCoord.z - 0.5 * reach * normal.z;
}`;
const SOLID_VERTEX = SHARED + PLACE + `
in vec3 position; out vec3 seen;
void main() { seen = rows * (position - middle); gl_Position = placed(position); }`;
const SOLID_FRAGMENT = SHARED + `
uniform vec4 tint; in vec3 seen; out vec4 colour;
void main() {
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  colour = vec4(tint.rgb * (0.65 + 0.35 * abs(normal.z)) * tint.a, tint.a);
}`;

/** Thin pyramids with a head from the tails to the tips, as triangles. */
function arrowTriangles(ends, width) {
  const result = [];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  for (let i = 0; i + 5 < ends.length; i += 6) {
    const tail = ends.subarray(i, i + 3), tip = ends.subarray(i + 3, i + 6);
    const along = [0, 1, 2].map((axis) => tip[axis] - tail[axis]), length = Math.hypot(...along);
    if (!(length > 0)) continue;
    const d = along.map((value) => value / length), helper = Math.abs(d[2]) < 0.8 ? [0, 0, 1] : [1, 0, 0];
    let u = cross(d, helper);
    const size = Math.hypot(...u);
    u = u.map((value) => value / size);
    const v = cross(d, u), head = Math.min(5 * width, 0.45 * length);
    const ring = (at, radius) => [0, 1, 2].map((k) => {
      const c = Math.cos(k * 2.0944) * radius, s = Math.sin(k * 2.0944) * radius;
      return [0, 1, 2].map((axis) => tail[axis] + at * d[axis] + c * u[axis] + s * v[axis]);
    });
    const foot = ring(0, 0.45 * width), neck = ring(length - head, 0.45 * width), brim = ring(length - head, 1.5 * width);
    for (let k = 0; k < 3; ++k) {
      const n = (k + 1) % 3;
      result.push(...foot[k], ...foot[n], ...neck[n], ...foot[k], ...neck[n], ...neck[k], ...brim[k], ...brim[n], ...tip);
    }
    result.push(...brim[0], ...brim[2], ...brim[1], ...foot[0], ...foot[1], ...foot[2]);
  }
  return new Float32Array(result);
}

class WebglPainter {
  constructor(canvas, gl) {
    Object.assign(this, { canvas, gl, name: "webgl", drawn: null, drawnField: null, counts: {} });
    this.faces = this.program(FACE_VERTEX, FACE_FRAGMENT);
    this.balls = this.program(BALL_VERTEX, BALL_FRAGMENT);
    this.solids = this.program(SOLID_VERTEX, SOLID_FRAGMENT);
    this.buffers = {};
    for (const name of ["facePlaces", "faceLevels", "faceCorners", "faceIndices", "centres", "levels", "diagonals", "mixed", "arrows",
      "tools"])
      this.buffers[name] = gl.createBuffer();
    this.texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
  }

  program(vertex, fragment) {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    return program;
  }

  fill(name, values, target) {
    this.gl.bindBuffer(target || this.gl.ARRAY_BUFFER, this.buffers[name]);
    this.gl.bufferData(target || this.gl.ARRAY_BUFFER, values, this.gl.DYNAMIC_DRAW);
  }

  /** Corners are not shared between faces: each has the colour of its face. */
  loadBodies({ content, reach }) {
    const gl = this.gl, n = content.faces.length / 4;
    const places = new Float32Array(12 * n), corners = new Uint8Array(8 * n), indices = new Uint32Array(6 * n);
    for (let face = 0; face < n; ++face) {
      for (let k = 0; k < 4; ++k) {
        const from = 3 * content.faces[4 * face + k];
        places.set(content.positions.subarray(from, from + 3), 12 * face + 3 * k);
        corners[8 * face + 2 * k] = k === 1 || k === 2 ? 1 : 0;
        corners[8 * face + 2 * k + 1] = k >= 2 ? 1 : 0;
      }
      indices.set([0, 1, 2, 0, 2, 3].map((k) => 4 * face + k), 6 * face);
    }
    this.fill("facePlaces", places);
    this.fill("faceCorners", corners);
    this.fill("faceIndices", indices, gl.ELEMENT_ARRAY_BUFFER);
    this.fill("centres", content.particles);
    this.fill("diagonals", content.shapes.subarray(0, content.shapes.length / 2));
    this.fill("mixed", content.shapes.subarray(content.shapes.length / 2));
    const arrows = arrowTriangles(content.arrows, 0.0035 * reach);
    this.fill("arrows", arrows);
    this.fill("tools", content.tools);
    this.counts = { faces: n, particles: content.shapes.length / 6, arrows: arrows.length / 3, tools: content.tools.length / 3 };
  }

  loadField({ content, field, table }) {
    const gl = this.gl, { faces, particles } = this.counts, levels = new Uint8Array(4 * faces);
    for (let k = 0; k < 4 * faces; ++k) levels[k] = content.faceValues[field * faces + (k >> 2)];
    this.fill("faceLevels", levels);
    this.fill("levels", content.particleValues.subarray(field * particles, (field + 1) * particles));
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, table);
  }

  use(program, task, attributes) {
    const gl = this.gl, { camera, width, height } = task, at = (name) => gl.getUniformLocation(program, name);
    gl.useProgram(program);
    const scale = camera.scale(width, height), rows = camera.rows();
    gl.uniformMatrix3fv(at("rows"), false, [0, 1, 2].flatMap((axis) => rows.map((row) => row[axis])));
    gl.uniform3fv(at("middle"), camera.centre);
    gl.uniform2f(at("fit"), 2 * scale / width, 2 * scale / height);
    gl.uniform2f(at("pan"), 2 * camera.pan[0] / width, 2 * camera.pan[1] / height);
    gl.uniform1f(at("depth"), 0.25 / camera.extent);
    gl.uniform1f(at("pixels"), scale * task.ratio);
    gl.uniform1f(at("edges"), task.switches.edges ? 1 : 0);
    for (let place = 0; place < 4; ++place) gl.disableVertexAttribArray(place);
    for (const [name, buffer, size, kind] of attributes) {
      const place = gl.getAttribLocation(program, name);
      if (place < 0) continue;
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[buffer]);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, kind, false, 0, 0);
    }
    return at;
  }

  draw(task) {
    const gl = this.gl, { width, height, ratio, switches } = task;
    if (this.drawn !== task.key) this.loadBodies(task);
    if (this.drawn !== task.key || this.drawnField !== task.field) this.loadField(task);
    this.drawn = task.key;
    this.drawnField = task.field;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    const { FLOAT, UNSIGNED_BYTE } = gl;
    if (switches.elements && this.counts.faces) {
      this.use(this.faces, task, [["position", "facePlaces", 3, FLOAT], ["value", "faceLevels", 1, UNSIGNED_BYTE],
        ["corner", "faceCorners", 2, UNSIGNED_BYTE]]);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffers.faceIndices);
      gl.drawElements(gl.TRIANGLES, 6 * this.counts.faces, gl.UNSIGNED_INT, 0);
    }
    if (switches.particles && this.counts.particles) {
      this.use(this.balls, task, [["position", "centres", 3, FLOAT], ["value", "levels", 1, UNSIGNED_BYTE],
        ["diagonal", "diagonals", 3, FLOAT], ["mixed", "mixed", 3, FLOAT]]);
      gl.drawArrays(gl.POINTS, 0, this.counts.particles);
    }
    if (switches.forces && this.counts.arrows) {
      const at = this.use(this.solids, task, [["position", "arrows", 3, FLOAT]]);
      gl.uniform4f(at("tint"), ...FORCE_COLOUR, 1);
      gl.drawArrays(gl.TRIANGLES, 0, this.counts.arrows);
    }
    if (switches.tools && this.counts.tools) {
      const at = this.use(this.solids, task, [["position", "tools", 3, FLOAT]]);
      gl.uniform4f(at("tint"), ...TOOL_COLOUR, TOOL_SHARE);
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
      gl.depthMask(false);
      gl.drawArrays(gl.TRIANGLES, 0, this.counts.tools);
      gl.depthMask(true);
    }
  }
}

/** Painter's order on a plain canvas: slower, for browsers without WebGL. */
class PlainPainter {
  constructor(canvas) {
    Object.assign(this, { canvas, name: "canvas" });
  }

  shapes({ content, field, camera, switches, width, height }) {
    const result = [], scale = camera.scale(width, height);
    const all = (places) => {
      const seen = [];
      for (let i = 0; i < places.length; i += 3) seen.push(camera.project([places[i], places[i + 1], places[i + 2]], scale));
      return seen;
    };
    if (switches.elements) {
      const points = all(content.positions), n = content.faces.length / 4;
      for (let face = 0; face < n; ++face) {
        const corners = [0, 1, 2, 3].map((k) => points[content.faces[4 * face + k]]);
        const [a, b] = [[0, 2], [1, 3]].map(([i, j]) => corners[j].map((value, axis) => value - corners[i][axis]));
        const normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        const light = 0.62 + 0.38 * Math.abs(normal[2]) / (Math.hypot(...normal) || 1);
        result.push({ corners, near: corners.reduce((sum, corner) => sum + corner[2], 0) / 4, light,
          level: content.faceValues[field * n + face] });
      }
    }
    if (switches.particles)
      all(content.particles).forEach((centre, k) => {
        const { axes, turn, reach } = this.ellipse(content.shapes, k, camera.rows());
        result.push({ centre, near: centre[2] + scale * reach, axes: axes.map((axis) => Math.max(scale * axis, 1)), turn,
          light: 0.95, level: content.particleValues[field * content.shapes.length / 6 + k] });
      });
    result.sort((one, other) => one.near - other.near);
    return { shapes: result, arrows: switches.forces ? all(content.arrows) : [], tools: switches.tools ? all(content.tools) : [] };
  }

  /** Half axes and turn of the ellipse that an ellipsoid is in the view, and how far it reaches towards the viewer. */
  ellipse(shapes, k, rows) {
    const [x, y, z] = shapes.subarray(3 * k, 3 * k + 3), [yz, zx, xy] = shapes.subarray(shapes.length / 2 + 3 * k);
    const shape = [[x, xy, zx], [xy, y, yz], [zx, yz, z]], dot = (one, other) => one.reduce((sum, entry, i) => sum + entry * other[i], 0);
    const turned = rows.map((row) => shape.map((column) => dot(row, column)));
    const a = dot(turned[0], turned[0]), b = dot(turned[0], turned[1]), c = dot(turned[1], turned[1]), half = Math.hypot((a - c) / 2, b);
    return { axes: [1, -1].map((sign) => Math.sqrt(Math.max((a + c) / 2 + sign * half, 0))), turn: Math.atan2(2 * b, a - c) / 2,
      reach: Math.hypot(...turned[2]) };
  }

  draw(task) {
    const { width, height, ratio, table } = task, context = this.canvas.getContext("2d");
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    context.scale(ratio, ratio);
    context.translate(width / 2, height / 2);
    const { shapes, arrows, tools } = this.shapes(task);
    const outline = (points) => {
      context.beginPath();
      points.forEach((point, k) => (k ? context.lineTo(point[0], -point[1]) : context.moveTo(point[0], -point[1])));
      context.closePath();
    };
    context.lineWidth = 0.5;
    for (const shape of shapes) {
      const colour = [0, 1, 2].map((c) => Math.round(shape.light * table[4 * shape.level + c]));
      context.fillStyle = `rgb(${colour})`;
      context.strokeStyle = task.switches.edges ? "rgba(0,0,0,0.35)" : context.fillStyle;
      if (shape.corners) outline(shape.corners);
      else { context.beginPath(); context.ellipse(shape.centre[0], -shape.centre[1], ...shape.axes, -shape.turn, 0, 2 * Math.PI); }
      context.fill();
      context.stroke();
    }
    const css = (colour) => `rgb(${colour.map((part) => Math.round(255 * part))})`;
    context.strokeStyle = css(FORCE_COLOUR);
    context.lineWidth = 1.4;
    for (let k = 0; k + 1 < arrows.length; k += 2) this.arrow(context, arrows[k], arrows[k + 1]);
    context.fillStyle = css(TOOL_COLOUR);
    context.globalAlpha = TOOL_SHARE;
    for (let k = 0; k + 2 < tools.length; k += 3) { outline(tools.slice(k, k + 3)); context.fill(); }
    context.globalAlpha = 1;
  }

  arrow(context, tail, tip) {
    const dx = tip[0] - tail[0], dy = tip[1] - tail[1], length = Math.hypot(dx, dy) || 1, head = Math.min(7, 0.5 * length) / length;
    context.beginPath();
    context.moveTo(tail[0], -tail[1]);
    context.lineTo(tip[0], -tip[1]);
    for (const side of [-0.45, 0.45]) {
      context.moveTo(tip[0], -tip[1]);
      context.lineTo(tip[0] - head * (dx - side * dy), -(tip[1] - head * (dy + side * dx)));
    }
    context.stroke();
  }
}

function makePainter(canvas) {
  // The drawing is kept so that the page can be printed.
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: true, premultipliedAlpha: true, preserveDrawingBuffer: true });
  return gl ? new WebglPainter(canvas, gl) : new PlainPainter(canvas);
}
