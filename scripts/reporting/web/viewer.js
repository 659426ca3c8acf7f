// SPDX-License-Identifier: LGPL-2.1-or-later
// The turnable view: unpacks the frames, turns the camera, writes axes. drawing.js paints.
"use strict";

function unpacked(text, Kind) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Kind(bytes.buffer);
}

/** Frames as arrays; what is as in an earlier frame is a number that refers to it. */
class Frames {
  constructor(view) {
    this.view = view;
    this.ready = new Map();
  }

  text(frame, key) {
    const own = this.view.frames[frame][key];
    return typeof own === "number" ? this.view.frames[own][key] : own;
  }

  /** Places in units of the axes. */
  places(text) {
    const whole = unpacked(text, Uint16Array), { low, span } = this.view, result = new Float32Array(whole.length);
    for (let i = 0; i < whole.length; ++i) result[i] = low[i % 3] + whole[i] / 65535 * span[i % 3];
    return result;
  }

  get(frame) {
    if (!this.ready.has(frame)) {
      const packed = this.view.frames[frame];
      this.ready.set(frame, {
        positions: this.places(packed.positions), faces: unpacked(this.text(frame, "faces"), Uint32Array),
        faceValues: unpacked(packed.faceValues, Uint8Array), particles: this.places(packed.particles),
        particleValues: unpacked(packed.particleValues, Uint8Array),
        // Symmetric matrices A of ellipsoids c + A s: all diagonals, then yz, zx, xy of all.
        shapes: Float32Array.from(unpacked(this.text(frame, "shapes"), Int8Array), (entry) => entry / 127 * packed.radius),
        arrows: this.places(packed.arrows), tools: this.places(this.text(frame, "tools")),
      });
      // The browser keeps a few; the others are unpacked again.
      if (this.ready.size > 12) this.ready.delete(this.ready.keys().next().value);
    }
    return this.ready.get(frame);
  }
}

/** 256 colours between the stops, as red, green, blue. */
function colourTable(stops) {
  const parts = stops.map((stop) => [1, 3, 5].map((at) => parseInt(stop.slice(at, at + 2), 16)));
  const table = new Uint8Array(256 * 4);
  for (let level = 0; level < 256; ++level) {
    const place = Math.max(level - 1, 0) / 254 * (parts.length - 1), first = Math.min(Math.floor(place), parts.length - 2);
    for (let c = 0; c < 3; ++c)
      table[4 * level + c] = level === 0 ? 150 : parts[first][c] + (place - first) * (parts[first + 1][c] - parts[first][c]);
    table[4 * level + 3] = 255;
  }
  return table;
}

/** A parallel view on a point: turned about the vertical z, then tilted. */
class Camera {
  constructor(view) {
    this.view = view;
    this.reset();
  }

  reset() {
    const [low, high] = this.view.frame;
    this.centre = low.map((value, axis) => 0.5 * (value + high[axis]));
    this.extent = Math.hypot(...low.map((value, axis) => high[axis] - value));
    this.zoom = 1;
    this.pan = [0, 0];
    if (this.view.flat) this.look(0, 90); else this.look(-32, 22);
  }

  look(turn, tilt) {
    this.turn = turn * Math.PI / 180;
    this.tilt = tilt * Math.PI / 180;
  }

  /** Rows: to the right, up, towards the viewer. */
  rows() {
    const c = Math.cos(this.turn), s = Math.sin(this.turn), ct = Math.cos(this.tilt), st = Math.sin(this.tilt);
    return [[c, s, 0], [-s * st, c * st, ct], [s * ct, -c * ct, st]];
  }

  /** Pixels for a unit of length. */
  scale(width, height) {
    const [low, high] = this.view.frame, rows = this.rows();
    const reach = [0, 1].map((row) => low.reduce((sum, value, axis) => sum + Math.abs(rows[row][axis]) * (high[axis] - value), 0));
    return this.zoom * 0.84 * Math.min((width - 60) / (reach[0] || this.extent), height / (reach[1] || this.extent));
  }

  /** Right, up, towards the viewer, in pixels from the middle. */
  project(point, scale) {
    const p = point.map((value, axis) => value - this.centre[axis]);
    const [right, up, near] = this.rows().map((row) => scale * (row[0] * p[0] + row[1] * p[1] + row[2] * p[2]));
    return [right + this.pan[0], up + this.pan[1], near];
  }
}

function roundTicks(low, high, count) {
  const rough = (high - low) / Math.max(count, 1), power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((factor) => factor * power).find((value) => value >= rough * 0.999);
  const result = [];
  for (let index = Math.ceil(low / step - 1e-9); index * step <= high + 1e-9 * step; ++index)
    result.push(Number((index * step).toPrecision(6)));
  return result;
}

/** Edges of the box on the outline of the view, with numbers, on a canvas above the scene. */
class Axes {
  constructor(canvas, camera, view) {
    Object.assign(this, { canvas, camera, view });
  }

  edge(axis, rows) {
    const [low, high] = this.view.frame, others = [0, 1, 2].filter((other) => other !== axis);
    let best = null;
    for (const sides of [[0, 0], [0, 1], [1, 0], [1, 1]]) {
      // From straight above, faces that are seen edge-on belong to the back.
      const isFront = others.map((other, k) => rows[2][other] * (sides[k] ? 1 : -1) > 1e-6);
      const ends = [low.slice(), high.slice()];
      others.forEach((other, k) => ends.forEach((end) => { end[other] = (sides[k] ? high : low)[other]; }));
      const middle = ends[0].map((value, k) => 0.5 * (value + ends[1][k]) - this.camera.centre[k]);
      const place = middle.reduce((sum, value, k) => sum + value * (rows[1][k] + 0.35 * rows[0][k]), 0);
      if (isFront[0] !== isFront[1] && (best === null || place < best.place)) best = { place, ends };
    }
    return best;
  }

  draw(width, height, ratio, isShown) {
    const context = this.canvas.getContext("2d"), style = getComputedStyle(document.documentElement);
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    if (!isShown) return;
    context.scale(ratio, ratio);
    context.translate(width / 2, height / 2);
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.strokeStyle = context.fillStyle = style.getPropertyValue("--faint").trim();
    const scale = this.camera.scale(width, height), rows = this.camera.rows(), [low, high] = this.view.frame;
    const middle = this.camera.project(this.camera.centre, scale);
    for (let axis = 0; axis < 3; ++axis) {
      const edge = this.edge(axis, rows);
      if (edge === null || !(high[axis] > low[axis])) continue;
      const [from, to] = edge.ends.map((end) => this.camera.project(end, scale));
      const along = [to[0] - from[0], to[1] - from[1]], length = Math.hypot(...along);
      if (length < 18) continue;
      let out = [along[1] / length, -along[0] / length];
      if (out[0] * (0.5 * (from[0] + to[0]) - middle[0]) + out[1] * (0.5 * (from[1] + to[1]) - middle[1]) < 0)
        out = out.map((value) => -value);
      const line = (x0, y0, x1, y1) => { context.beginPath(); context.moveTo(x0, -y0); context.lineTo(x1, -y1); context.stroke(); };
      line(from[0], from[1], to[0], to[1]);
      for (const value of roundTicks(low[axis], high[axis], Math.max(2, Math.min(8, length / 55)))) {
        const share = (value - low[axis]) / (high[axis] - low[axis]);
        const x = from[0] + share * along[0], y = from[1] + share * along[1];
        line(x, y, x + 5 * out[0], y + 5 * out[1]);
        context.fillText(String(value).replace("-", "−"), x + 17 * out[0], -(y + 15 * out[1]));
      }
      const unit = this.view.unit ? ` [${this.view.unit}]` : "";
      const text = "xyz"[axis] + unit, reach = 0.5 * (width - context.measureText(text).width) - 2;
      const place = 0.5 * (from[0] + to[0]) + 54 * out[0];
      context.fillText(text, Math.max(-reach, Math.min(reach, place)), -(0.5 * (from[1] + to[1]) + 36 * out[1]));
    }
  }
}

class Viewer {
  constructor(root, view) {
    this.root = root;
    this.view = view;
    this.frames = new Frames(view);
    this.camera = new Camera(view);
    this.area = root.querySelector(".view");
    this.canvas = root.querySelector(".scene");
    this.axes = new Axes(root.querySelector(".overlay"), this.camera, view);
    this.painter = makePainter(this.canvas);
    this.tables = view.fields.map((field) => colourTable(field.stops));
    this.field = 0;
    this.frame = view.frames.length - 1;
    this.isDue = false;
    this.prepareControls();
    this.preparePointer();
    new ResizeObserver(() => this.redraw()).observe(this.area);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redraw());
    this.selectField(0);
    this.draw();
  }

  prepareControls() {
    const select = this.root.querySelector("select"), time = this.root.querySelector(".controls output");
    select.addEventListener("change", () => this.selectField(select.selectedIndex));
    this.player = new Player(this.root, this.view.frames.length, (frame) => {
      this.frame = frame;
      time.textContent = this.view.frames[frame].time;
      this.redraw();
    }, 220);
    this.switches = {};
    for (const box of this.root.querySelectorAll("input[type=checkbox]")) {
      this.switches[box.name] = box.checked;
      box.addEventListener("change", () => { this.switches[box.name] = box.checked; this.redraw(); });
    }
    for (const button of this.root.querySelectorAll("button[data-look]"))
      button.addEventListener("click", () => {
        this.camera.reset();
        if (button.dataset.look) this.camera.look(...button.dataset.look.split(",").map(Number));
        this.redraw();
      });
  }

  selectField(index) {
    const field = this.view.fields[index], bar = this.root.querySelector(".bar");
    this.field = index;
    bar.querySelector("b").textContent = field.unit ? `${field.title} [${field.unit}]` : field.title;
    bar.querySelector(".low").textContent = numberText(Number(field.low.toPrecision(3)));
    bar.querySelector(".high").textContent = numberText(Number(field.high.toPrecision(3)));
    bar.querySelector(".colours").style.background = `linear-gradient(to right, ${field.stops.join(",")})`;
    bar.querySelector(".about").textContent = field.range;
    this.redraw();
  }

  turn(dx, dy) {
    this.camera.turn -= dx * 0.008;
    this.camera.tilt = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.camera.tilt + dy * 0.008));
    this.redraw();
  }

  move(dx, dy) {
    this.camera.pan[0] += dx;
    this.camera.pan[1] -= dy;
    this.redraw();
  }

  zoomBy(factor) {
    const zoom = Math.max(0.2, Math.min(60, this.camera.zoom * factor));
    this.camera.pan = this.camera.pan.map((value) => value * zoom / this.camera.zoom);
    this.camera.zoom = zoom;
    this.redraw();
  }

  preparePointer() {
    const pointers = new Map(), canvas = this.canvas;
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      canvas.focus({ preventScroll: true });
    });
    for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, (event) => pointers.delete(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const now = [event.clientX, event.clientY], dx = now[0] - before[0], dy = now[1] - before[1];
      if (pointers.size === 1) {
        if (event.shiftKey || (event.buttons & 6)) this.move(dx, dy); else this.turn(dx, dy);
      } else {
        const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
        const distance = (p) => Math.max(10, Math.hypot(p[0] - other[0], p[1] - other[1]));
        this.zoomBy(distance(now) / distance(before));
        this.move(dx / 2, dy / 2);
      }
      pointers.set(event.pointerId, now);
    });
    // The wheel scrolls the page until the view has been clicked.
    canvas.addEventListener("wheel", (event) => {
      if (document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      this.zoomBy(Math.exp(-event.deltaY * 0.0015));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-12, 0], ArrowRight: [12, 0], ArrowUp: [0, -12], ArrowDown: [0, 12] }[event.key];
      if (step) this.turn(...step);
      else if (event.key === "+" || event.key === "=") this.zoomBy(1.15);
      else if (event.key === "-") this.zoomBy(1 / 1.15);
      else return;
      event.preventDefault();
    });
  }

  redraw() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => { this.isDue = false; this.draw(); });
  }

  draw() {
    const width = this.area.clientWidth, height = this.area.clientHeight, ratio = Math.min(window.devicePixelRatio || 1, 2);
    if (!width || !height) return;
    const content = this.frames.get(this.frame);
    this.painter.draw({ width, height, ratio, content, key: `${this.frame}`, field: this.field, table: this.tables[this.field],
      camera: this.camera, switches: this.switches, reach: this.camera.extent });
    this.axes.draw(width, height, ratio, this.switches.axes);
  }
}

(() => {
  const view = dataOf("view-data"), root = document.getElementById("viewer");
  if (!view || !root) return;
  const viewer = new Viewer(root, view);
  document.documentElement.dataset.viewer = viewer.painter.name;
})();
