#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The pages of this project: links lead to what is there, sentences are short, doc/README.md lists every page. And the
checks detect what they are for."""

import re
import sys
import tempfile
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(PROJECT / "scripts"))

from pages import text  # noqa: E402

LARGEST_SENTENCE = 48


class PagesTest(unittest.TestCase):
    def test_links_and_anchors_lead_to_what_is_there(self):
        self.assertEqual(text.wrong_links(PROJECT, text.pages_of(PROJECT) + text.tables_of(PROJECT)), [])

    def test_no_sentence_is_longer_than_48_words(self):
        pages = [page for page in text.pages_of(PROJECT) if page.name != "CHANGELOG.md"] + text.tables_of(PROJECT)
        self.assertEqual(text.long_sentences(PROJECT, pages, LARGEST_SENTENCE), [])

    def test_every_page_is_listed_once_and_in_a_group(self):
        listed = [name for _, entries in text.groups_of(PROJECT) for name, _, _ in entries]
        self.assertEqual(sorted(listed), sorted(set(listed)))
        written = {str(page) for page in text.pages_of(PROJECT)} - {"doc/README.md"}
        self.assertEqual(written - set(listed), set())
        self.assertEqual([group for group, _ in text.groups_of(PROJECT)],
                         ["Start", "Model", "Choose", "Run", "Verify", "Extend"])


    def test_every_file_of_tables_is_linked_from_a_page(self):
        linked = {(page.parent / target.partition("#")[0]).as_posix() for page in text.pages_of(PROJECT)
                  for _, target in text.links_of((PROJECT / page).read_text("utf-8"))}
        self.assertEqual([str(page) for page in text.tables_of(PROJECT) if page.as_posix() not in linked], [])

    def test_keywords_with_a_dot_are_read_by_the_importer(self):
        page = (PROJECT / "doc/keywords.md").read_text("utf-8")
        for part, program in zip(page.split("\n## ")[1:], ("dyna", "abaqus")):
            source = "".join(path.read_text("utf-8") for path in (PROJECT / "scripts/importing" / program).glob("*.py"))
            rows = [row.split("|") for row in part.split("\n") if row.startswith("| ")]
            names = {name.strip() for row in rows if "•" in row[2] for name in re.findall(r"`\*([A-Z][A-Z _0-9-]+)", row[1])}
            self.assertGreater(len(names), 30)
            # Those of *CONTACT_ are read by parts of their names.
            self.assertEqual({name for name in names if name not in source and not name.startswith("CONTACT_")}, set())


class CheckTest(unittest.TestCase):
    """What the checks report of pages made here."""

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.project = Path(self.temporary.name)

    def wrong(self, **pages):
        for name, page in pages.items():
            (self.project / f"{name}.md").write_text(page, "utf-8")
        return text.wrong_links(self.project, [Path("one.md")])

    def test_a_link_needs_its_file_and_its_heading(self):
        other = "# Some `code`, and more\n\n## Twice\n\n## Twice\n"
        good = "[a](other.md) [b](other.md#some-code-and-more) [c](other.md#twice-1) [d](https://example.org/x#y)\n\n# Own\n\n[e](#own)\n"
        self.assertEqual(self.wrong(one=good, other=other), [])
        for link in ("[a](missing.md)", "[a](other.md#twice-2)", "[a](#other)", "![picture](pictures/none.png)",
                     "[![picture](none.png)](other.md)", "| cell | [a](none.md) |", "- item\n  [a](none.md)"):
            self.assertEqual(len(self.wrong(one=link + "\n", other=other)), 1, link)

    def test_code_has_no_links(self):
        self.assertEqual(self.wrong(one="`[a](none.md)`\n\n    [a](none.md)\n\n```\n[a](none.md)\n```\n"), [])

    def test_comments_are_no_text(self):
        page = "# One\n\n<!-- numbers of:\n[a](none.md)\n\n-->\n\n[a](none.md) and two.\n"
        self.assertEqual(self.wrong(one=page), ["one.md:8: there is no none.md"])
        self.assertEqual(text.sentences_of(page), [(8, "a and two.")])

    def test_a_link_does_not_leave_the_project(self):
        self.assertEqual(len(self.wrong(one="[a](../../../../../../../../etc)\n")), 1)

    def test_sentences_end_where_they_end(self):
        page = ("# A heading. Of two\n\nOne of Sec. 4.1 and Fig. 3. `Two` is of Wu, C. T. Pan et al. 2019, and\n0.5 mm. See [a page](c.md). "
                "What belongs to J. The next\n\n- an item\n- another. Third\n\n| a. B | c |\n|---|---|\n\n```\nCode. Code.\n```\n")
        self.assertEqual([sentence for _, sentence in text.sentences_of(page)],
                         ["One of Sec. 4.1 and Fig. 3.", "code is of Wu, C. T. Pan et al. 2019, and 0.5 mm.", "See a page.",
                          "What belongs to J.", "The next", "an item", "another.", "Third"])

    def test_a_sentence_of_49_words_is_found_with_its_line(self):
        (self.project / "one.md").write_text("# One\n\nFirst.\n" + " ".join(["word"] * 49) + ".\nLast.\n", "utf-8")
        found, = text.long_sentences(self.project, [Path("one.md")], 48)
        self.assertTrue(found.startswith("one.md:4: 49 words: word"), found)
        self.assertEqual(text.long_sentences(self.project, [Path("one.md")], 49), [])


if __name__ == "__main__":
    unittest.main()
