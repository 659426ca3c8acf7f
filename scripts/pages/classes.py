# SPDX-License-Identifier: LGPL-2.1-or-later
"""Doxygen's pages of the classes, and where each class is among them."""

import subprocess
import tempfile
import xml.etree.ElementTree
from pathlib import Path

# Doxygen 1.9.4 has no dark pages of its own.
DARK = """@media (prefers-color-scheme: dark) {
  html { filter: invert(0.9) hue-rotate(180deg); background: #fff; }
  img { filter: invert(1) hue-rotate(180deg); }
}
"""


class DoxygenError(Exception):
    pass


def make(project, directory):
    """Writes the pages into the directory; [(name, file), ...] of its classes."""
    with tempfile.TemporaryDirectory() as temporary:
        temporary = Path(temporary)
        (temporary / "dark.css").write_text(DARK, "utf-8")
        run(["doxygen", "-l", temporary / "layout.xml"])
        layout = (temporary / "layout.xml").read_text("utf-8")
        tab = '<tab type="user" visible="yes" title="Pages" url="../index.html"/>'
        layout = layout.replace("<navindex>", f"<navindex>\n    {tab}", 1)
        layout = layout.replace('type="mainpage" visible="yes"', 'type="mainpage" visible="no"', 1)
        (temporary / "layout.xml").write_text(layout, "utf-8")
        settings = {
            "PROJECT_NAME": "Tombolo", "PROJECT_BRIEF": '"Classes"', "INPUT": f'"{project}/include"', "RECURSIVE": "YES",
            "EXTRACT_ALL": "YES", "STRIP_FROM_PATH": f'"{project}/include"', "STRIP_FROM_INC_PATH": f'"{project}/include"',
            "FULL_PATH_NAMES": "YES", "JAVADOC_AUTOBRIEF": "YES", "BUILTIN_STL_SUPPORT": "YES", "MARKDOWN_SUPPORT": "YES",
            "OUTPUT_DIRECTORY": f'"{directory.parent}"', "HTML_OUTPUT": directory.name, "GENERATE_LATEX": "NO",
            "HAVE_DOT": "NO", "SEARCHENGINE": "YES", "QUIET": "YES", "WARNINGS": "NO", "HTML_TIMESTAMP": "NO",
            "HTML_EXTRA_STYLESHEET": f'"{temporary}/dark.css"', "LAYOUT_FILE": f'"{temporary}/layout.xml"',
            "GENERATE_TAGFILE": f'"{temporary}/tags.xml"', "SHOW_USED_FILES": "NO"}
        (temporary / "Doxyfile").write_text("".join(f"{name} = {value}\n" for name, value in settings.items()), "utf-8")
        run(["doxygen", temporary / "Doxyfile"])
        return classes_of(temporary / "tags.xml")


def run(command):
    try:
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise DoxygenError("there is no doxygen; `scripts/setup doxygen` installs it, --no-classes does without") from None
    if done.returncode:
        raise DoxygenError(f"doxygen failed: {done.stderr.strip()[-500:]}")


def classes_of(tags):
    """[(name without namespaces, file), ...] of the classes and structures in a file of tags."""
    found = []
    for compound in xml.etree.ElementTree.parse(tags).getroot().iter("compound"):
        if compound.get("kind") in ("class", "struct"):
            name = compound.findtext("name", "").removeprefix("tombolo::")
            found.append((name, compound.findtext("filename", "")))
    return found
