# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command of scripts/site."""

import argparse
import sys
from pathlib import Path

from pages import text

PROJECT = Path(__file__).resolve().parents[2]
LARGEST_SENTENCE = 48


def check(project):
    """What is wrong with the pages of a project. The changelog is a list of notes; its sentences are not counted."""
    pages = text.pages_of(project) + text.tables_of(project)
    return text.wrong_links(project, pages) + text.long_sentences(
        project, [page for page in pages if page.name != "CHANGELOG.md"], LARGEST_SENTENCE)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="scripts/site", add_help=False)
    parser.add_argument("directory", nargs="?", type=Path, default=PROJECT / "build/site")
    parser.add_argument("--no-classes", action="store_true")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args(arguments)
    if options.check:
        found = check(PROJECT)
        print("\n".join(found) if found else "All links lead somewhere, no sentence is too long.")
        sys.exit(1 if found else 0)

    from pages import formulas, site
    if not formulas.can_be_converted():
        print(f"site: there is no {formulas.PROGRAM} (scripts/setup {formulas.PROGRAM}), so formulas are shown as TeX", file=sys.stderr)
    try:
        n_pages, n_classes = site.make(PROJECT, options.directory, has_classes=not options.no_classes)
    except (site.SiteError, formulas.FormulaError) as error:
        sys.exit(f"site: {error}")
    print(f"{options.directory / 'index.html'}: {n_pages} pages, {n_classes} classes")


if __name__ == "__main__":
    main()
