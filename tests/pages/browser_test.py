#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Opens the site in a headless Chromium without a network and uses it: search by keys, light and dark, the navigation of a
phone. Ends with 77 where there is no browser or no python3-markdown."""

import sys
import tempfile
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(PROJECT / "scripts"), str(PROJECT / "tests/report")]

import browser  # noqa: E402

SKIPPED = 77

# Searches, and follows what is found.
SEARCHER = """(async () => {
  const found = {}, field = document.querySelector(".search input"), results = document.querySelector("#site-results");
  const until = async (what) => { while (!what()) await new Promise((done) => setTimeout(done, 10)); };
  const type = async (words) => {
    field.value = words;
    field.dispatchEvent(new Event("input"));
    await until(() => !results.hidden);
    await new Promise((done) => setTimeout(done, 50));
    return [...results.querySelectorAll("a")];
  };
  const press = (target, key) => target.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
  press(document.body, "/");
  found.isFocused = document.activeElement === field;
  found.filter = (await type("lattice filter")).map((link) => link.textContent);
  found.marked = results.querySelectorAll("mark").length;
  found.html = (await type("<img onerror=x>")).length + " " + results.querySelectorAll("img").length;
  found.nothing = (await type("zyzzyva"), results.textContent);
  const links = await type("bond failure");
  press(field, "ArrowDown"); press(field, "ArrowDown"); press(field, "ArrowUp");
  found.chosen = [...results.querySelectorAll("a")].findIndex((link) => link.classList.contains("now"));
  found.address = links[0].getAttribute("href");
  press(field, "Escape");
  found.isHidden = results.hidden;
  return found;
})()"""

LOOK = """({
  back: getComputedStyle(document.body).backgroundColor, ink: getComputedStyle(document.body).color,
  tooWide: document.documentElement.scrollWidth - document.documentElement.clientWidth,
  pages: getComputedStyle(document.querySelector("#site-pages")).display,
  broken: [...document.images].filter((image) => image.complete && !image.naturalWidth).length,
  fetched: performance.getEntriesByType("resource").map((entry) => entry.name).filter((name) => !name.startsWith("file:") && !name.startsWith("data:")),
})"""


def brightness(colour):
    return sum(int(part) for part in colour[colour.index("(") + 1:-1].split(",")[:3])


class BrowserTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.directory = Path(cls.temporary.name) / "site"
        site.make(PROJECT, cls.directory, has_classes=False)
        cls.opened = browser.Browser()

    @classmethod
    def tearDownClass(cls):
        cls.opened.__exit__()
        cls.temporary.cleanup()

    def test_words_are_found_and_followed(self):
        self.opened.open(self.directory / "index.html")
        found = self.opened.run(SEARCHER)
        self.assertTrue(found["isFocused"])
        self.assertIn("filter", " ".join(found["filter"][:3]).lower())
        self.assertGreater(found["marked"], 3)
        self.assertTrue(found["html"].endswith(" 0"), found["html"])
        self.assertEqual(found["nothing"], "Nothing has all these words.")
        self.assertEqual(found["chosen"], 0)
        self.assertTrue(found["isHidden"])
        file, _, anchor = found["address"].partition("#")
        self.opened.open(self.directory / file)
        self.assertTrue(self.opened.run(f"document.getElementById({anchor!r}) !== null"))

    def test_pages_are_readable_in_light_and_dark(self):
        for is_dark in (False, True):
            for name in ("index.html", "method.html", "parameters.html", "table_reflection.html"):
                self.opened.open(self.directory / name, is_dark=is_dark)
                found = self.opened.run(LOOK)
                self.assertEqual(brightness(found["back"]) < brightness(found["ink"]), is_dark, name)
                self.assertEqual((found["tooWide"], found["broken"], found["fetched"]), (0, 0, []), name)
        self.opened.open(self.directory / "index.html")
        self.opened.run("document.querySelector('.theme').click()")
        dark = self.opened.run(LOOK)
        self.assertLess(brightness(dark["back"]), brightness(dark["ink"]))

    def test_a_phone_has_the_pages_behind_a_button(self):
        for name in ("index.html", "choosing.html", "method.html", "parameters.html", "robustness.html"):
            self.opened.open(self.directory / name, 360, 780, is_phone=True)
            found = self.opened.run(LOOK)
            self.assertEqual((found["tooWide"], found["pages"]), (0, "none"), name)
        self.opened.run("document.querySelector('.menu').click()")
        self.assertEqual(self.opened.run(LOOK)["pages"], "block")


if __name__ == "__main__":
    if browser.find_browser() is None:
        print("There is no Chromium (`scripts/setup chromium` installs it): the site was not opened.")
        sys.exit(SKIPPED)
    try:
        from pages import site
    except ModuleNotFoundError as error:
        print(f"{error} (`scripts/setup python3-markdown` installs it): no site was made.")
        sys.exit(SKIPPED)
    unittest.main()
