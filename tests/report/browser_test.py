#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Opens a report in a headless Chromium without a network and uses it: the view is drawn and turned,
sliders, fields and legends work, nothing is wider than a phone. Ends with 77 where there is no browser."""

import sys
import tempfile
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[2] / "scripts"), str(Path(__file__).parent)]

import browser  # noqa: E402

SKIPPED = 77

# Before the programs of the page: records what goes wrong.
LISTENER = """<script>
window.problems = [];
window.addEventListener("error", (event) => problems.push(event.message));
document.addEventListener("securitypolicyviolation", (event) => problems.push(event.blockedURI));
</script>"""

# Uses the page and returns what it found.
USER = """(async () => {
  const found = {}, one = (selector) => document.querySelector(selector);
  const frame = () => new Promise((done) => requestAnimationFrame(done));
  // The page draws in the next frame.
  const drawn = async () => { await frame(); await frame(); };
  const colours = () => {
    const scene = one("#viewer .scene"), copy = document.createElement("canvas");
    copy.width = scene.width; copy.height = scene.height;
    const context = copy.getContext("2d");
    context.drawImage(scene, 0, 0);
    const pixels = new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer), kinds = new Set();
    let painted = 0, sum = 0;
    pixels.forEach((pixel, k) => {
      if (pixel >>> 24) { ++painted; kinds.add(pixel); }
      sum = (sum + pixel % 9973 * (k % 97)) % 1e9;
    });
    return { painted: painted / pixels.length, kinds: kinds.size, sum };
  };
  const slide = (selector, value) => {
    const slider = one(selector);
    slider.value = value;
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  };
  const point = (target, type, x, y) => target.dispatchEvent(
    new PointerEvent(type, { pointerId: 1, clientX: x, clientY: y, bubbles: true, buttons: 1 }));
  await drawn();
  found.viewer = document.documentElement.dataset.viewer;
  found.title = document.title;
  found.start = colours();
  const scene = one("#viewer .scene");
  scene.setPointerCapture = () => {};
  point(scene, "pointerdown", 100, 100); point(scene, "pointermove", 180, 140); point(scene, "pointerup", 180, 140);
  await drawn();
  found.turned = colours();
  slide("#viewer input[type=range]", 0);
  await drawn();
  found.first = colours();
  found.firstTime = one("#viewer .controls output").textContent;
  const select = one("#viewer select");
  select.selectedIndex = 1;
  select.dispatchEvent(new Event("change"));
  await drawn();
  found.otherField = one("#viewer .bar b").textContent;
  for (const box of document.querySelectorAll("#viewer input[type=checkbox]")) if (box.checked) box.click();
  await drawn();
  found.nothing = colours();
  slide(".picture-set input[type=range]", 1);
  found.pictures = [...document.querySelectorAll(".picture-set img.shown")].map((image) => image.dataset.time);
  found.loaded = [...document.querySelectorAll(".picture-set img")].every((image) => image.naturalWidth > 300);
  const chart = one("figure.chart"), svg = chart.querySelector("svg"), key = chart.querySelector(".key");
  const box = svg.getBoundingClientRect();
  point(svg, "pointermove", box.left + 0.7 * box.width, box.top + 50);
  found.reading = chart.querySelector(".reading").textContent;
  found.value = key.querySelector("output").textContent;
  key.click();
  found.hidden = getComputedStyle(chart.querySelector(".line")).display;
  one("#viewer .play").click();
  await new Promise((done) => setTimeout(done, 600));
  found.playing = Number(one("#viewer input[type=range]").value);
  found.fetched = performance.getEntriesByType("resource").map((entry) => entry.name)
    .filter((name) => !name.startsWith("data:"));
  found.problems = problems;
  return found;
})()"""

TOO_WIDE = "document.documentElement.scrollWidth - document.documentElement.clientWidth"


class BrowserTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        run = Path(cls.temporary.name) / "run"
        make_run.make_run(run)
        text, _ = report.make_report(run, fields=["stress", "stress xx"])
        cls.page = run / "used.html"
        cls.page.write_text(text.replace("<head>", "<head>" + LISTENER, 1), "utf-8")

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def use(self, opened):
        opened.open(self.page)
        found = opened.run(USER)
        self.check(found)
        return found["viewer"]

    def check(self, found):
        self.assertEqual(found["problems"], [])
        self.assertEqual(found["fetched"], [])
        self.assertEqual(found["title"], make_run.TITLE)
        for state in ("start", "turned", "first"):
            self.assertGreater(found[state]["painted"], 0.02)
            self.assertGreater(found[state]["kinds"], 100)
        self.assertNotEqual(found["start"]["sum"], found["turned"]["sum"])
        self.assertNotEqual(found["turned"]["sum"], found["first"]["sum"])
        self.assertEqual(found["nothing"]["painted"], 0)
        self.assertEqual(found["firstTime"], "0 s")
        self.assertIn("Stress xx", found["otherField"])
        self.assertEqual(set(found["pictures"]), {"4 ms"})
        self.assertTrue(found["loaded"])
        self.assertRegex(found["reading"], r"^t = [\d.]+ ms$")
        self.assertRegex(found["value"], r"^[−\d.]+ mJ$")
        self.assertEqual(found["hidden"], "none")
        self.assertGreater(found["playing"], 0)

    def test_a_report_is_used(self):
        # Some builds of the browser have no WebGL without a graphics card.
        with browser.Browser(*browser.SOFTWARE_WEBGL) as opened:
            self.assertIn(self.use(opened), ("webgl", "canvas"))

    def test_a_report_is_used_without_webgl_and_on_a_phone(self):
        with browser.Browser("--disable-3d-apis") as opened:
            self.assertEqual(self.use(opened), "canvas")
            for width in (1400, 360):
                opened.open(self.page, width, 780, is_phone=width < 500, is_dark=width < 500)
                self.assertEqual(opened.run(TOO_WIDE), 0, width)
                self.assertEqual(opened.run("problems"), [])


if __name__ == "__main__":
    if browser.find_browser() is None:
        print("There is no Chromium (`scripts/setup chromium` installs it): the report was not opened.")
        sys.exit(SKIPPED)
    import make_run
    from reporting import report
    unittest.main()
