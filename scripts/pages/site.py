# SPDX-License-Identifier: LGPL-2.1-or-later
"""The site: pages of markdown as HTML with their groups beside them, and the index of the search."""

import html
import html.parser
import json
import re
import shutil
from pathlib import Path

import markdown

from pages import classes, formulas, synonyms, text

WEB = Path(__file__).parent / "web"
# Only a directory with this file is replaced.
MARK = "made_by_scripts_site"
NAMES = {"README.md": "index.html", "doc/README.md": "pages.html", "CONTRIBUTING.md": "contributing.html",
         "CHANGELOG.md": "changelog.html"}
CLASSES = "classes"
TABLES = "tables"
# What a section of the search is of; search.js weighs it.
KINDS = {"CHANGELOG.md": "changes", "doc/parameters.md": "entries"}


class SiteError(Exception):
    pass


def make(project, directory, has_classes=True):
    """Makes the site anew; how many pages and classes it has."""
    project, directory = Path(project).resolve(), Path(directory).resolve()
    pages = text.pages_of(project) + text.tables_of(project)
    if wrong := text.wrong_links(project, pages):
        raise SiteError("links lead nowhere:\n" + "\n".join(wrong))
    make_room(project, directory)
    found = []
    if has_classes:
        try:
            found = classes.make(project, directory / CLASSES)
        except classes.DoxygenError as error:
            raise SiteError(error) from None
    sections = Site(project, directory, pages, found).write()
    sections += [{"k": "class", "p": "Class", "h": name, "u": f"{CLASSES}/{file}", "t": ""} for name, file in found]
    index = json.dumps({"synonyms": synonyms.read(), "sections": sections}, ensure_ascii=False, separators=(",", ":"))
    (directory / "search-index.js").write_text(f"window.searchIndex = {index};\n", "utf-8")
    for name in ("site.css", "site.js", "search.js"):
        shutil.copy(WEB / name, directory / name)
    return len(pages), len(found)


def make_room(project, directory):
    if directory == project or directory in project.parents:
        raise SiteError(f"{directory} has the project in it")
    if directory.exists() and any(directory.iterdir()):
        if not (directory / MARK).is_file():
            raise SiteError(f"{directory} is not empty and is no site; name another directory")
        shutil.rmtree(directory)
    directory.mkdir(parents=True, exist_ok=True)
    (directory / MARK).write_text("This directory is replaced by the next call of scripts/site.\n", "utf-8")


def name_of(page):
    """The file of a page on the site."""
    if Path(page).parent.name == TABLES:
        return f"table_{Path(page).stem}.html"
    return NAMES.get(str(page)) or Path(page).with_suffix(".html").name


def kind_of(page):
    """What the search weighs a section of a page by."""
    return "table" if Path(page).parent.name == TABLES else KINDS.get(str(page), "page")


def for_python_markdown(page):
    """The text as this library reads lists: with an empty line before the first item."""
    lines, is_code = [], False
    for line in page.split("\n"):
        if text.FENCE.match(line):
            is_code = not is_code
        before = lines[-1] if lines else ""
        is_item = text.ITEM.match(line) and not line.startswith("    ")
        if is_item and not is_code and before.strip() and not text.ITEM.match(before) and not before.startswith(" "):
            lines.append("")
        lines.append(line)
    return "\n".join(lines)


def body_of(page):
    """The HTML of a page, its headings with their anchors."""
    converter = markdown.Markdown(extensions=["tables", "fenced_code", "sane_lists"])
    converter.ESCAPED_CHARS.append("<")
    body = converter.convert(for_python_markdown(formulas.with_ticks(page)))
    headings = text.headings_of(page)
    found = re.findall(r"<h([1-6])>", body)
    if [int(level) for level in found] != [level for level, _, _ in headings]:
        raise SiteError(f"headings differ: {headings[:1]}")
    anchors = iter(anchor for _, _, anchor in headings)

    def heading(match):
        anchor = next(anchors)
        link = f'<a class="anchor" href="#{anchor}" aria-label="Link to this heading">#</a>'
        return f'<h{match[1]} id="{anchor}">{match[2]}{link}</h{match[1]}>'

    body = re.sub(r"<h([1-6])>(.*?)</h\1>", heading, body, flags=re.DOTALL)
    body = formulas.in_page(body)
    # An escaped bar within code of a table.
    body = re.sub(r"<code>[^<]*</code>", lambda match: match[0].replace("\\|", "|"), body)
    return re.sub(r"<table>.*?</table>", lambda match: f'<div class="table">{match[0]}</div>', body, flags=re.DOTALL)


class Site:
    def __init__(self, project, directory, pages, found_classes):
        self.project, self.directory = project, directory
        self.texts = {str(page): (project / page).read_text("utf-8") for page in pages}
        self.titles = {page: self.title_of(page) for page in self.texts}
        self.class_files = self.plain_classes(found_classes)

    def title_of(self, page):
        _, heading, _ = text.headings_of(self.texts[page])[0]
        return re.sub(r"[`*]", "", heading)

    @staticmethod
    def plain_classes(found):
        """Names of classes that mean one class, and nothing else in a text: MechanicalStep, not Part."""
        files = {}
        for name, file in found:
            files.setdefault(re.sub(r"<.*", "", name.split("::")[-1]).strip(), []).append(file)
        return {name: names[0] for name, names in files.items()
                if len(names) == 1 and re.fullmatch(r"(?:[A-Z][a-z0-9]+){2,}", name)}

    def write(self):
        """Writes all pages; their sections for the search."""
        sections = []
        for page in self.texts:
            body = self.with_links(page, body_of(self.texts[page]))
            reader = Sections(body)
            for anchor, heading, words in reader.sections:
                sections.append({"k": kind_of(page), "p": self.titles[page], "h": heading, "u": f"{name_of(page)}#{anchor}", "t": words})
            (self.directory / name_of(page)).write_text(self.whole(page, body, reader.sections), "utf-8")
        return sections

    def with_links(self, page, body):
        """Links to pages lead to those of the site; pictures and other files are copied."""
        own = (self.project / page).parent

        def link(match):
            attribute, target = match[1], html.unescape(match[2])
            if re.match(r"[a-z][a-z0-9+.-]*:", target) or target.startswith("#"):
                return match[0]
            name, _, anchor = target.partition("#")
            path = (own / name).resolve()
            relative = path.relative_to(self.project)
            if str(relative) in self.texts:
                there = name_of(relative) + (f"#{anchor}" if anchor else "")
            elif path.is_dir():
                raise SiteError(f"{page}: {target} is a directory")
            else:
                there = self.copy(path, relative)
            return f'{attribute}="{html.escape(there)}"'

        body = re.sub(r'\b(href|src)="([^"]*)"', link, body)
        body = body.replace("<img ", '<img loading="lazy" ')
        return re.sub(r"(<a [^>]*>)?<code>([A-Za-z0-9]+)</code>", self.with_class, body)

    def with_class(self, match):
        file = self.class_files.get(match[2])
        if match[1] or not file:
            return match[0]
        return f'<a class="class" href="{CLASSES}/{html.escape(file)}"><code>{match[2]}</code></a>'

    def copy(self, path, relative):
        there = Path(*relative.parts[1:]) if relative.parts[0] == "doc" else Path("files") / relative
        target = self.directory / there
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists():
            shutil.copy(path, target)
        return there.as_posix()

    def navigation(self, page):
        groups = []
        for group, entries in text.groups_of(self.project):
            items = "".join(
                f'<li><a href="{name_of(entry)}" title="{html.escape(about, quote=True)}"'
                + (' aria-current="page"' if entry == page else "")
                + f">{html.escape(self.titles[entry])}</a></li>" for entry, _, about in entries)
            if group == "Extend" and (self.directory / CLASSES).is_dir():
                items += f'<li><a href="{CLASSES}/classes.html">Classes</a></li>'
            groups.append(f"<h2>{html.escape(group)}</h2><ul>{items}</ul>")
        return "".join(groups)

    def whole(self, page, body, sections):
        contents = "".join(f'<li><a href="#{anchor}">{html.escape(heading)}</a></li>' for anchor, heading, _ in sections[1:])
        contents = f'<nav class="contents" aria-label="On this page"><h2>On this page</h2><ul>{contents}</ul></nav>'
        parts = {"title": html.escape(self.titles[page]) + ("" if page == "README.md" else " – Tombolo"),
                 "navigation": self.navigation(page), "body": body, "source": html.escape(page),
                 "contents": contents if len(sections) > 2 else ""}
        return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], (WEB / "page.html").read_text("utf-8"))


class Sections(html.parser.HTMLParser):
    """[(anchor, heading, words), ...] of the headings of the first three levels."""

    def __init__(self, body):
        super().__init__()
        self.sections, self.heading, self.is_anchor = [], None, False
        self.feed(body)
        self.close()
        self.sections = [(anchor, " ".join(heading.split()), " ".join(words.split()))
                         for anchor, heading, words in self.sections]

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag in ("h1", "h2", "h3"):
            self.heading = tag
            self.sections.append([attributes["id"], "", ""])
        elif tag == "a" and attributes.get("class") == "anchor":
            self.is_anchor = True
        elif tag in ("p", "li", "td", "th", "tr", "div", "pre"):
            self.handle_data(" ")

    def handle_endtag(self, tag):
        if tag == self.heading:
            self.heading = None
        elif tag == "a":
            self.is_anchor = False

    def handle_data(self, data):
        if self.sections and not self.is_anchor:
            self.sections[-1][1 if self.heading else 2] += data
