# SPDX-License-Identifier: LGPL-2.1-or-later
"""The input of a run: entries of the parameter file that differ from their defaults."""

import re
from dataclasses import dataclass
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "doc/parameters.md"
HEADING = re.compile(r"#+ `(.+)`")
ROW = re.compile(r"\| `([^`]+)` \| (.*?) \|(?= )")


@dataclass
class Entry:
    section: str
    name: str
    value: str
    default: str  # "mandatory" for an entry without one, None where the page does not have the entry
    differs: bool


def read_defaults(page=PAGE):
    """{section: {entry: default}} of doc/parameters.md; {} where there is no page."""
    defaults, section = {}, ""
    if not page.exists():
        return defaults
    for line in page.read_text("utf-8").splitlines():
        if line.startswith("#"):
            match = HEADING.fullmatch(line)
            section = match.group(1) if match else ""
        elif match := ROW.match(line):
            text = match.group(2).strip()
            value = "" if text == "" else text.strip("`").replace("\\|", "|")
            defaults.setdefault(section, {})[match.group(1)] = value
    return defaults


def is_same(value, default):
    """Whether two texts are the same entry: numbers by value, lists item by item."""
    one, other = ([item.strip() for item in re.split(r"[,;]", text)] for text in (value, default))
    if len(one) != len(other):
        return False
    for left, right in zip(one, other):
        try:
            if float(left) != float(right):
                return False
        except ValueError:
            if left != right:
                return False
    return True


def entries(parameters, defaults, path=()):
    """All entries of the nested sections, in their order."""
    result = []
    for name, value in parameters.items():
        if isinstance(value, dict):
            continue
        section = "/".join(path)
        known = defaults.get(section)
        if known is None and path:
            # Sections of a kind share their entries: "Part: foot" has those of "Part: NAME".
            kind = re.sub(r":.*", ": NAME", path[0])
            known = defaults.get("/".join((kind,) + path[1:]))
        default = (known or {}).get(name)
        text = str(value).lower() if isinstance(value, bool) else str(value)
        differs = text != "" if default in (None, "mandatory") else not is_same(text, default)
        result.append(Entry(section, name, text, default, differs))
    for name, value in parameters.items():
        if isinstance(value, dict):
            result += entries(value, defaults, path + (name,))
    return result
