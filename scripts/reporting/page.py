# SPDX-License-Identifier: LGPL-2.1-or-later
"""The page: sections of HTML with styles, programs and data in one file."""

import json
from html import escape
from pathlib import Path

WEB = Path(__file__).parent / "web"
GENERATOR = "Tombolo report"
# Nothing is fetched, whatever a title contains.
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
LEVELS = {"error": "Error", "warning": "Warning", "note": "Note"}


class Page:
    """Collects sections, then writes them into one text."""

    def __init__(self, title):
        self.title = title
        self.head = ""
        self.sections = []
        self.foot = ""
        self.charts = []
        self.view = None

    def add(self, anchor, title, html):
        if html:
            self.sections.append((anchor, title, html))

    def drawn(self, pairs):
        """Charts side by side; pairs of HTML and numbers, from charts.draw()."""
        figures, silent = [], []
        for pair in pairs:
            if pair is None:
                continue
            html, numbers = pair
            if numbers is None:
                silent.append(html[:1].lower() + html[1:])
            else:
                figures.append(html)
                self.charts.append(numbers)
        grid = f'<div class="charts">{"".join(figures)}</div>' if figures else ""
        return grid + (f'<p class="silent">Zero throughout: {escape("; ".join(silent))}.</p>' if silent else "")

    def text(self):
        links = "".join(f'<a href="#{anchor}">{escape(title)}</a>' for anchor, title, _ in self.sections)
        body = "".join(f'<section id="{anchor}"><h2>{escape(title)}</h2>{html}</section>'
                       for anchor, title, html in self.sections)
        data = embedded("chart-numbers", self.charts) + (embedded("view-data", self.view) if self.view else "")
        programs = "".join(f"<script>\n{(WEB / name).read_text('utf-8')}</script>\n"
                           for name in ("charts.js", "drawing.js", "viewer.js"))
        nav = f'<nav aria-label="Sections"><div>{links}</div></nav>\n' if len(self.sections) > 1 else ""
        return (f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
                f'<meta name="generator" content="{GENERATOR}">\n'
                f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">\n'
                f'<meta name="viewport" content="width=device-width, initial-scale=1">\n'
                f"<title>{escape(self.title)}</title>\n<style>\n{(WEB / 'report.css').read_text('utf-8')}</style>\n"
                f"</head>\n<body>\n{self.head}{nav}"
                f"<main>{body}</main>\n{self.foot}{data}{programs}</body>\n</html>\n")


def embedded(name, content):
    """Data for the programs of the page; no text in it can end the element."""
    text = json.dumps(content, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    return f'<script type="application/json" id="{name}">{text}</script>\n'


def is_report(path):
    """Whether a file was written by this script."""
    with open(path, "rb") as file:
        return f'content="{GENERATOR}"'.encode() in file.read(1000)


def notices_html(notices):
    if not notices:
        return ""
    order = list(LEVELS)
    items = "".join(f'<li class="{notice.level}"><b>{LEVELS[notice.level]}:</b>{escape(notice.text)}</li>'
                    for notice in sorted(notices, key=lambda notice: order.index(notice.level)))
    return f'<ul class="notices">{items}</ul>'


def tiles_html(tiles):
    """Pairs of a name and a value, or of a value and a remark."""
    parts = []
    for name, value, remark in tiles:
        small = f"<small>{escape(remark)}</small>" if remark else ""
        parts.append(f"<div><dt>{escape(name)}</dt><dd>{escape(value)}{small}</dd></div>")
    return f'<dl class="tiles">{"".join(parts)}</dl>' if parts else ""


def player_html(times, label):
    last = len(times) - 1
    return (f'<button type="button" class="play">Play</button><label>{label} '
            f'<input type="range" min="0" max="{last}" value="{last}" step="1" aria-label="{label}"></label>'
            f"<output>{escape(times[last])}</output>")


def view_html(view, arrow_text):
    options = "".join(f"<option>{escape(one['title'])}</option>" for one in view["fields"])
    has = {"elements": any(frame["faceValues"] for frame in view["frames"]),
           "particles": any(frame["particleValues"] for frame in view["frames"]),
           "forces": any(frame["arrows"] for frame in view["frames"]),
           "tools": any(frame["tools"] for frame in view["frames"])}
    switches = "".join(f'<label><input type="checkbox" name="{name}"{" checked" if is_there else " disabled"}>{text}</label>'
                       for name, text, is_there in (
                           ("elements", "elements", has["elements"]), ("particles", "particles", has["particles"]),
                           ("edges", "edges of cells", has["elements"]), ("forces", "contact forces", has["forces"]),
                           ("tools", "tools", has["tools"]), ("axes", "axes", True)))
    view_buttons = "".join(f'<button type="button" data-look="{angles}">{text}</button>'
                           for text, angles in (("Reset", ""), ("along x", "90,0"), ("along y", "0,0"), ("along z", "0,90")))
    frames = [frame["time"] for frame in view["frames"]]
    arrows = f'<p class="hint">{escape(arrow_text)}</p>' if arrow_text and has["forces"] else ""
    return (f'<div class="card" id="viewer"><div class="controls"><label>Field <select aria-label="Field">{options}</select>'
            f"</label>{player_html(frames, 'Time')}</div>"
            f'<div class="view"><canvas class="scene" tabindex="0" role="img" aria-label="Turnable view of the bodies. '
            f'Arrow keys turn it, plus and minus zoom."></canvas><canvas class="overlay" aria-hidden="true"></canvas></div>'
            f'<div class="bar"><b></b><span class="low"></span><div class="colours"></div><span class="high"></span>'
            f'<span></span><span class="about"></span></div>'
            f'<div class="controls" style="margin:12px 0 4px">{switches}{view_buttons}</div>'
            f'<p class="hint">Drag to turn, drag with shift or two fingers to move. After a click into the view, the wheel '
            f"zooms. Positions have 16 bits, colours 8; {len(frames)} outputs are shown. Grey has no value.</p>{arrows}</div>")


def pictures_html(pictures, stops, arrow_text):
    """The pictures of each field, with one slider for all."""
    times = [time for time, _ in pictures[0][1]]
    figures = []
    for one, images in pictures:
        last = len(images) - 1
        shown = "".join(f'<img src="{image}" alt="{escape(one.title)} at t = {escape(time)}" data-time="{escape(time)}"'
                        f'{" class=shown" if index == last else ""}>' for index, (time, image) in enumerate(images))
        low, high = (number_text(value * one.scale.factor) for value in (one.low, one.high))
        colours = ",".join(stops(one.colours))
        figures.append(f'<figure class="card">{shown}<figcaption class="bar"><b>{escape(one.scale.heading(one.title))}</b>'
                       f'<span>{low}</span><div class="colours" style="background:linear-gradient(to right,{colours})"></div>'
                       f'<span>{high}</span><span></span><span class="about">{escape(one.range_text())}</span></figcaption>'
                       f"</figure>")
    arrows = f'<p class="hint">{escape(arrow_text)}</p>' if arrow_text else ""
    return (f'<div class="picture-set"><div class="controls">{player_html(times, "Time")}</div>'
            f'<div class="pictures">{"".join(figures)}</div>{arrows}</div>')


def number_text(value):
    from .units import number
    return number(value, 3)


def table_html(headings, rows):
    head = "".join(f"<th scope=col>{escape(heading)}</th>" for heading in headings)
    body = "".join(row if isinstance(row, str) else
                   "<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def entries_html(entries):
    """Entries of a parameter file, section by section."""
    rows, section = [], None
    for entry in entries:
        if entry.section != section:
            section = entry.section
            rows.append(f'<tr class="section"><td colspan="3">{escape(section.replace("/", " / ") or "Outside of sections")}'
                        "</td></tr>")
        default = "not in the list of entries" if entry.default is None else entry.default or "empty"
        mark = "" if entry.differs else ' class="default"'
        rows.append(f"<tr{mark}><td>{escape(entry.name)}</td><td>{escape(entry.value) or 'empty'}</td>"
                    f'<td class="default">{escape(default)}</td></tr>')
    return table_html(("Entry", "Value", "Default"), rows)
