// SPDX-License-Identifier: LGPL-2.1-or-later
// Reads charts at the pointer, switches lines, turns the pages of pictures.
"use strict";

function dataOf(id) {
  const element = document.getElementById(id);
  return element ? JSON.parse(element.textContent) : null;
}

function numberText(value) {
  if (value === null || value === undefined || !isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size !== 0 && (size >= 1e5 || size < 1e-3) ? value.toExponential(3) : String(Number(value.toPrecision(5)));
  return text.replace("-", "−");
}

function nearest(sorted, wanted) {
  let low = 0, high = sorted.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (sorted[middle] < wanted) low = middle; else high = middle;
  }
  return wanted - sorted[low] < sorted[high] - wanted ? low : high;
}

function prepareChart(figure, numbers) {
  const svg = figure.querySelector("svg"), cursor = figure.querySelector(".cursor");
  const reading = figure.querySelector(".reading"), keys = [...figure.querySelectorAll(".key")];
  const [x0, x1, left, right] = numbers.x;
  keys.forEach((key, line) => key.addEventListener("click", () => {
    const isShown = key.getAttribute("aria-pressed") === "false";
    key.setAttribute("aria-pressed", String(isShown));
    svg.querySelector(`.line[data-line="${line}"]`).classList.toggle("hidden", !isShown);
  }));
  svg.addEventListener("pointermove", (event) => {
    const box = svg.getBoundingClientRect(), place = (event.clientX - box.left) / box.width * svg.viewBox.baseVal.width;
    const row = nearest(numbers.t, x0 + (place - left) / (right - left) * (x1 - x0));
    const at = left + (numbers.t[row] - x0) / (x1 - x0) * (right - left);
    cursor.setAttribute("d", `M${at} ${numbers.v[0]}V${numbers.v[1]}`);
    reading.textContent = `t = ${numberText(numbers.t[row])} ${numbers.time}`;
    keys.forEach((key, line) => {
      key.querySelector("output").textContent = `${numberText(numbers.y[line][row])} ${numbers.unit}`;
    });
  });
  svg.addEventListener("pointerleave", () => {
    cursor.setAttribute("d", "");
    reading.textContent = "";
    for (const key of keys) key.querySelector("output").textContent = "";
  });
}

/** A slider with a button that plays; show(frame) is called with each new frame. */
class Player {
  constructor(root, count, show, period) {
    this.slider = root.querySelector("input[type=range]");
    this.button = root.querySelector(".play");
    this.count = count;
    this.show = show;
    this.period = period;
    this.timer = null;
    this.slider.addEventListener("input", () => this.show(Number(this.slider.value)));
    this.button.addEventListener("click", () => (this.timer === null ? this.play() : this.pause()));
  }

  play() {
    if (Number(this.slider.value) >= this.count - 1) this.go(0);
    this.button.textContent = "Pause";
    this.timer = setInterval(() => {
      const next = Number(this.slider.value) + 1;
      if (next >= this.count) this.pause(); else this.go(next);
    }, this.period);
  }

  pause() {
    clearInterval(this.timer);
    this.timer = null;
    this.button.textContent = "Play";
  }

  go(frame) {
    this.slider.value = frame;
    this.show(frame);
  }
}

function preparePictures(section) {
  const sets = [...section.querySelectorAll("figure")].map((figure) => [...figure.querySelectorAll("img")]);
  const time = section.querySelector(".controls output");
  new Player(section, sets[0].length, (frame) => {
    for (const images of sets) images.forEach((image, index) => image.classList.toggle("shown", index === frame));
    time.textContent = sets[0][frame].dataset.time;
  }, 700);
}

(() => {
  const charts = dataOf("chart-numbers") || [];
  document.querySelectorAll("figure.chart").forEach((figure, index) => prepareChart(figure, charts[index]));
  document.querySelectorAll(".picture-set").forEach(preparePictures);
  document.documentElement.dataset.charts = String(charts.length);
})();
