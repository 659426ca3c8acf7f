# SPDX-License-Identifier: LGPL-2.1-or-later
"""Reads pages of markdown as text: headings and their anchors, links, sentences. Needs no package."""

import re
from pathlib import Path

# What ends with a full stop and does not end a sentence.
ABBREVIATIONS = ("Sec.", "Secs.", "Fig.", "Figs.", "Eq.", "Eqs.", "eq.", "eqs.", "No.", "vol.", "pp.", "al.", "e.g.", "i.e.",
                 "etc.", "Vol.", "cf.", "vs.", "approx.")

FENCE = re.compile(r"^\s*(```|~~~)")
HEADING = re.compile(r"^(#{1,6})\s+(.*?)\s*#*$")
ITEM = re.compile(r"^(\s*)([-*+]|\d+[.)])\s+")
# On lines of its own, and not shown.
COMMENT = re.compile(r"^<!--.*?-->[ \t]*$", re.DOTALL | re.MULTILINE)
CODE = re.compile(r"(`+)(.+?)\1", re.DOTALL)
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")


def pages_of(project):
    """The pages that people write and read, relative to the project."""
    project = Path(project)
    return [path.relative_to(project) for path in
            [project / "README.md", project / "CONTRIBUTING.md", project / "CHANGELOG.md", *sorted(project.glob("doc/*.md"))]]


def tables_of(project):
    """Tables of studies that pages link, relative to the project."""
    project = Path(project)
    return [path.relative_to(project) for path in sorted(project.glob("doc/tables/*.md"))]


class Block:
    """Lines of a page that belong together: kind is heading, text, table or code."""

    def __init__(self, kind, line, text):
        self.kind, self.line, self.text = kind, line, text


def blocks_of(text):
    """The blocks of a page in their order, without its comments."""
    text = COMMENT.sub(lambda found: "\n" * found.group().count("\n"), text)
    blocks, lines, start = [], [], 0
    fence, in_list = None, False

    def end():
        nonlocal lines
        if lines:
            is_table = all(line.lstrip().startswith("|") for line in lines)
            blocks.append(Block("table" if is_table else "text", start, "\n".join(lines)))
        lines = []

    for number, line in enumerate(text.split("\n"), 1):
        if fence:
            blocks[-1].text += line + "\n"
            if line.strip().startswith(fence):
                fence = None
            continue
        if found := FENCE.match(line):
            end()
            fence = found.group(1)
            blocks.append(Block("code", number, ""))
            continue
        if not line.strip():
            end()
            continue
        is_indented = line.startswith("    ")
        if not lines and is_indented and not in_list:
            blocks.append(Block("code", number, line))
            continue
        if found := HEADING.match(line):
            end()
            blocks.append(Block("heading", number, line))
            in_list = False
            continue
        if not is_indented and not lines and not ITEM.match(line) and not line.startswith(" "):
            in_list = False
        is_table = line.lstrip().startswith("|")
        if lines and (ITEM.match(line) or is_table != lines[0].lstrip().startswith("|")):
            end()
        if ITEM.match(line):
            in_list = True
            line = ITEM.sub("", line)
        if not lines:
            start = number
        lines.append(line)
    end()
    return blocks


def without_code(text):
    """The text with the code in its lines made blank."""
    return CODE.sub(lambda found: re.sub(r"[^\n]", " ", found.group()), text)


def anchor_of(heading, taken):
    """The anchor that a heading has on the pages of the forge; counts those that are used."""
    text = LINK.sub(lambda found: found.group(2), heading)
    text = re.sub(r"[`*]", "", text).strip().lower()
    anchor = "".join(letter for letter in text if letter.isalnum() or letter in "-_ ").replace(" ", "-")
    number = taken.get(anchor, 0)
    taken[anchor] = number + 1
    return f"{anchor}-{number}" if number else anchor


def headings_of(text):
    """(level, heading, anchor) of each heading."""
    taken, headings = {}, []
    for block in blocks_of(text):
        if block.kind == "heading":
            marks, heading = HEADING.match(block.text).groups()
            headings.append((len(marks), heading, anchor_of(heading, taken)))
    return headings


def links_of(text):
    """(line, target) of each link and picture outside of code."""
    links = []
    for block in blocks_of(text):
        if block.kind != "code":
            plain = without_code(block.text)
            for found in LINK.finditer(plain):
                inner = [found.group(3)]
                # A picture that is itself a link.
                inner += [picture.group(3) for picture in LINK.finditer(found.group(2))]
                line = block.line + plain[:found.start()].count("\n")
                links += [(line, target) for target in inner]
    return links


def wrong_links(project, pages):
    """What is wrong with the links of pages: files and anchors that are not there."""
    project = Path(project).resolve()
    anchors, wrong = {}, []

    def anchors_in(path):
        if path not in anchors:
            anchors[path] = {anchor for _, _, anchor in headings_of(path.read_text("utf-8"))}
        return anchors[path]

    for page in pages:
        own = project / page
        for line, target in links_of(own.read_text("utf-8")):
            if re.match(r"[a-z][a-z0-9+.-]*:", target):
                continue
            name, _, anchor = target.partition("#")
            path = (own.parent / name).resolve() if name else own
            if not path.exists():
                wrong.append(f"{page}:{line}: there is no {target}")
            elif not path.is_relative_to(project):
                wrong.append(f"{page}:{line}: {target} is not in the project")
            elif anchor and (path.suffix != ".md" or anchor not in anchors_in(path)):
                wrong.append(f"{page}:{line}: {target}: the page has no such heading")
    return wrong


def ends_with_abbreviation(words):
    """Whether the full stop after these words does not end a sentence: abbreviations, initials, dots for what is left out."""
    last = words[-1].lstrip("([")
    if last in ABBREVIATIONS or last.endswith("..."):
        return True
    # "X. Pan, C. T. Wu" against "the vector area that belongs to J."
    is_initial = re.fullmatch(r"[A-Z]\.", last)
    return bool(is_initial and (len(words) == 1 or words[-2].endswith((",", "."))))


def sentences_of(text):
    """(line, sentence) of the text of a page, without tables, code blocks and headings. Code within a line is one word."""
    sentences = []
    for block in blocks_of(text):
        if block.kind != "text":
            continue
        plain = CODE.sub(lambda found: "code" + "\n" * found.group().count("\n"), block.text)
        while (shorter := LINK.sub(lambda found: "" if found.group(1) else found.group(2), plain)) != plain:
            plain = shorter
        plain = plain.replace("**", "")
        start = 0
        for found in re.finditer(r"[.!?][)\"']?(?=\s)", plain):
            before = plain[start:found.end()]
            if ends_with_abbreviation(before.split()):
                continue
            sentences.append((block.line + plain[:start].count("\n"), before))
            start = found.end()
        if plain[start:].strip():
            sentences.append((block.line + plain[:start].count("\n"), plain[start:]))
    return [(line + len(sentence) - len(sentence.lstrip("\n")), " ".join(sentence.split())) for line, sentence in sentences]


def n_words(sentence):
    return sum(any(letter.isalnum() for letter in word) for word in sentence.split())


def long_sentences(project, pages, largest):
    """The sentences with more words than that: where they are, how many words, how they begin."""
    found = []
    for page in pages:
        for line, sentence in sentences_of((Path(project) / page).read_text("utf-8")):
            words = n_words(sentence)
            if words > largest:
                found.append(f"{page}:{line}: {words} words: {sentence}")
    return found


def groups_of(project):
    """[(group, [(page, title, what it is about), ...]), ...] as doc/README.md lists the pages, relative to the project."""
    project = Path(project)
    groups = []
    for block in blocks_of((project / "doc/README.md").read_text("utf-8")):
        if block.kind == "heading" and block.text.startswith("## "):
            groups.append((block.text[3:].strip(), []))
        elif block.kind == "text" and groups:
            found = re.match(r"\[([^\]]+)\]\(([^)#]+\.md)\):\s+(.*)", block.text, re.DOTALL)
            if found:
                page = (project / "doc" / found.group(2)).resolve().relative_to(project.resolve())
                groups[-1][1].append((str(page), found.group(1), " ".join(found.group(3).split())))
    return [(group, entries) for group, entries in groups if entries]
