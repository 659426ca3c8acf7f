#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes the site and reads it: every link and picture leads to what is there, every page is in the navigation and in the
index of the search, directories that are no site are left alone. Ends with 77 where python3-markdown is missing."""

import html.parser
import json
import re
import shutil
import sys
import tempfile
import unittest
from pathlib import Path
from urllib.parse import unquote

PROJECT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(PROJECT / "scripts"))
SKIPPED = 77


class Reader(html.parser.HTMLParser):
    """Anchors, links and text of a page; elements must be closed in their order."""

    VOID = {"meta", "input", "img", "br", "link", "hr"}

    def __init__(self, text):
        super().__init__()
        self.open, self.mistakes, self.anchors, self.links, self.words, self.current = [], [], set(), [], [], []
        self.feed(text)
        self.close()
        self.mistakes += self.open

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag not in self.VOID:
            self.open.append(tag)
        if "id" in attributes:
            if attributes["id"] in self.anchors:
                self.mistakes.append("twice " + attributes["id"])
            self.anchors.add(attributes["id"])
        self.links += [attributes[name] for name in ("href", "src") if name in attributes]
        if attributes.get("aria-current"):
            self.current.append(attributes["href"])

    def handle_endtag(self, tag):
        if tag not in self.VOID and (not self.open or self.open.pop() != tag):
            self.mistakes.append("closes " + tag)

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("script", "code", "style"):
            self.words.append(data)


class SiteTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.directory = Path(cls.temporary.name) / "site"
        cls.n_pages, _ = site.make(PROJECT, cls.directory, has_classes=False)
        cls.pages = {path.name: Reader(path.read_text("utf-8")) for path in sorted(cls.directory.glob("*.html"))}

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_every_page_is_there_and_well_formed(self):
        self.assertEqual(len(self.pages), self.n_pages)
        for name, page in self.pages.items():
            self.assertEqual(page.mistakes, [], name)

    def test_every_link_leads_to_what_is_there(self):
        wrong = []
        for name, page in self.pages.items():
            for link in page.links:
                if re.match(r"(https?|mailto|data):", link):
                    continue
                file, _, anchor = unquote(link).partition("#")
                path = (self.directory / file).resolve() if file else self.directory / name
                if not path.is_file() or not path.is_relative_to(self.directory.resolve()):
                    wrong.append(f"{name}: {link}")
                elif anchor and anchor not in self.pages[path.name].anchors:
                    wrong.append(f"{name}: {link}")
        self.assertEqual(wrong, [])

    def test_every_page_leads_to_every_other(self):
        listed = {name for name in self.pages if not name.startswith("table_")} - {"pages.html"}
        for name, page in self.pages.items():
            self.assertEqual(listed - set(page.links), set(), name)
            self.assertEqual(page.current, [name] if name in listed else [])

    def test_the_search_has_every_section(self):
        index = json.loads((self.directory / "search-index.js").read_text("utf-8").removeprefix("window.searchIndex = ")
                           .rstrip().removesuffix(";"))["sections"]
        self.assertEqual({section["u"].split("#")[0] for section in index}, set(self.pages))
        for section in index:
            file, anchor = section["u"].split("#")
            self.assertIn(anchor, self.pages[file].anchors)
        text = " ".join(section["t"] for section in index if section["u"].startswith("parameters.html"))
        for words in ("Bond failure", "Rebuild deformation"):
            self.assertIn(words, text)

    def test_no_marks_of_markdown_are_left(self):
        for name, page in self.pages.items():
            words = " ".join(page.words)
            for mark in ("**", "](", "```", "|---", "\n- "):
                self.assertNotIn(mark, words, name)

    def test_a_site_is_replaced_and_nothing_else(self):
        other = Path(self.temporary.name) / "other"
        other.mkdir()
        (other / "mine.txt").write_text("mine")
        with self.assertRaisesRegex(site.SiteError, "is not empty and is no site"):
            site.make(PROJECT, other, has_classes=False)
        self.assertEqual([path.name for path in other.iterdir()], ["mine.txt"])
        for directory in (PROJECT, PROJECT.parent):
            with self.assertRaises(site.SiteError):
                site.make_room(PROJECT, directory)
        again = Path(self.temporary.name) / "again"
        site.make(PROJECT, again, has_classes=False)
        (again / "old.html").write_text("old")
        site.make(PROJECT, again, has_classes=False)
        self.assertFalse((again / "old.html").exists())


    @unittest.skipIf(shutil.which("doxygen") is None, "there is no doxygen")
    def test_classes_are_beside_the_pages(self):
        directory = Path(self.temporary.name) / "with_classes"
        _, n_classes = site.make(PROJECT, directory)
        self.assertGreater(n_classes, 100)
        links = {link for path in directory.glob("*.html") for link in Reader(path.read_text("utf-8")).links
                 if link.startswith("classes/")}
        self.assertGreater(len(links), 20)
        index = (directory / "search-index.js").read_text("utf-8")
        links |= set(re.findall(r'"u":"(classes/[^"]*)"', index))
        self.assertEqual([link for link in links if not (directory / link).is_file()], [])
        self.assertIn("../index.html", (directory / "classes/menudata.js").read_text("utf-8"))


class TagsTest(unittest.TestCase):
    def test_classes_are_read_from_doxygens_tags(self):
        with tempfile.TemporaryDirectory() as temporary:
            tags = Path(temporary) / "tags.xml"
            tags.write_text("<tagfile><compound kind='class'><name>tombolo::CellFormulation</name><filename>a.html</filename>"
                            "</compound><compound kind='file'><name>b.h</name><filename>b.html</filename></compound>"
                            "<compound kind='class'><name>tombolo::Part</name><filename>c.html</filename></compound></tagfile>")
            found = classes.classes_of(tags)
        self.assertEqual(found, [("CellFormulation", "a.html"), ("Part", "c.html")])
        # A word that means other things, too, is no link.
        self.assertEqual(site.Site.plain_classes(found), {"CellFormulation": "a.html"})


if __name__ == "__main__":
    try:
        from pages import classes, site
    except ModuleNotFoundError as error:
        print(f"{error} (`scripts/setup python3-markdown` installs it): no site was made.")
        sys.exit(SKIPPED)
    unittest.main()
