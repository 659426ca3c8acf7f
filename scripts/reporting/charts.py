# SPDX-License-Identifier: LGPL-2.1-or-later
"""Lines over time as SVG, with a legend in HTML and the numbers for the reading at the pointer."""

import math
from dataclasses import dataclass, field
from html import escape

import numpy

from . import units

WIDTH, HEIGHT = 460, 250
LEFT, RIGHT, TOP, BOTTOM = 54, 12, 20, 38
MAXIMUM_POINTS = 240  # of a line; the extremes of what is left out are kept
N_COLOURS = 8
TINY = 1e-250  # what is smaller is zero: the inverse of it must be a number
SILENT = 1e-9  # lines below this share of the largest are zero but for round-off


@dataclass
class Chart:
    title: str
    table: object
    names: list
    quantity: str = ""  # the label of the vertical axis; the title where it is empty
    short: dict = field(default_factory=dict)  # {column: text of the legend}
    dashed: tuple = ()  # columns that often lie on others


def ticks(low, high, count=5):
    """Round numbers from low to high, and their digits behind the point."""
    rough = (high - low) / count
    power = 10.0**math.floor(math.log10(rough))
    step = next((power * factor for factor in (1, 2, 2.5, 5, 10) if power * factor >= rough * 0.999), power)
    first = math.ceil(low / step - 1e-9)
    values = [index * step for index in range(first, int(math.floor(high / step + 1e-9)) + 1)]
    digits = max(0, -math.floor(math.log10(step) + 1e-9))
    if abs(round(step, digits) - step) > 1e-6 * step:
        digits += 1
    return values, digits


def tick_text(value, digits):
    text = f"{value:.{digits}f}"
    # No minus before a zero.
    return (text if float(text) else f"{0:.{digits}f}").replace("-", "−")


def limits(values):
    """The range of an axis: what the values span, with a margin, zero where it is near."""
    finite = values[numpy.isfinite(values)]
    low, high = float(finite.min()), float(finite.max())
    if high - low <= 1e-13 * max(abs(low), abs(high), TINY):
        reach = abs(low) * 0.5 if abs(low) > TINY else 1.0
        return low - reach, high + reach
    margin = 0.05 * (high - low)
    low_end = 0.0 if 0 <= low < 0.5 * high else low - margin
    high_end = 0.0 if 0 >= high > 0.5 * low else high + margin
    return low_end, high_end


def thinned(lines):
    """Indices of rows that keep each line's extremes between those left out."""
    n_rows = len(lines[0])
    if n_rows <= MAXIMUM_POINTS:
        return numpy.arange(n_rows)
    chosen = {0, n_rows - 1}
    edges = numpy.linspace(0, n_rows, MAXIMUM_POINTS // 2 + 1).astype(int)
    for values in lines:
        for start, end in zip(edges[:-1], edges[1:]):
            part = values[start:end]
            if numpy.isfinite(part).any():
                chosen.update((start + int(numpy.nanargmin(part)), start + int(numpy.nanargmax(part))))
    return numpy.array(sorted(chosen))


def rounded(values):
    return [None if not math.isfinite(value) else float(f"{value:.5g}") for value in values]


class Drawing:
    """One chart of the page: the marks of the axes and the lines."""

    def __init__(self, time, lines):
        first, last = float(time.min()), float(time.max())
        self.x_range = (first, last) if last - first > 1e-12 * max(abs(first), abs(last), TINY) else (first - 0.5, first + 0.5)
        self.y_range = limits(numpy.concatenate(lines))
        largest = max(abs(self.y_range[0]), abs(self.y_range[1]))
        exponent = math.floor(math.log10(largest) + 1e-12)
        self.exponent = 3 * math.floor(exponent / 3) if exponent >= 4 or exponent < -2 else 0

    def x(self, value):
        low, high = self.x_range
        return LEFT + (value - low) / (high - low) * (WIDTH - LEFT - RIGHT)

    def y(self, value):
        low, high = self.y_range
        return HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - BOTTOM - TOP)

    def axes(self, time_heading, heading):
        parts = []
        values, digits = ticks(*self.x_range)
        for value in values:
            x = self.x(value)
            parts.append(f'<path class="grid" d="M{x:.1f} {TOP}V{HEIGHT - BOTTOM}"/>'
                         f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 15}" text-anchor="middle">'
                         f'{tick_text(value, digits)}</text>')
        scale = 10.0**self.exponent
        values, digits = ticks(self.y_range[0] / scale, self.y_range[1] / scale)
        for value in values:
            y = self.y(value * scale)
            kind = "zero" if abs(value) < 1e-12 else "grid"
            parts.append(f'<path class="{kind}" d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}"/>'
                         f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{tick_text(value, digits)}</text>')
        power = f" × 10{str(self.exponent).translate(units.SUPERSCRIPTS)}" if self.exponent else ""
        parts.append(f'<text class="heading" x="4" y="11">{escape(heading)}{power}</text>')
        parts.append(f'<text class="heading" x="{WIDTH - RIGHT}" y="{HEIGHT - 6}" text-anchor="end">'
                     f'{escape(time_heading)}</text>')
        return "".join(parts)

    def line(self, number, time, values, is_dashed=False):
        colour = number % N_COLOURS
        style = ("", ' stroke-dasharray="6 4"', ' stroke-dasharray="2 3"')[kind_of(number, is_dashed)]
        path, is_down = [], False
        for at, value in zip(time, values):
            if math.isfinite(value):
                path.append(f"{'L' if is_down else 'M'}{self.x(at):.1f} {self.y(value):.1f}")
            is_down = math.isfinite(value)
        marks = ""
        if len(time) <= 60:
            marks = "".join(f'<circle cx="{self.x(at):.1f}" cy="{self.y(value):.1f}" r="1.8"/>'
                            for at, value in zip(time, values) if math.isfinite(value))
        return f'<g class="line s{colour}" data-line="{number}"><path d="{"".join(path)}"{style}/>{marks}</g>'


def kind_of(number, is_dashed):
    """Solid, dashed, dotted: the lines beyond the number of colours differ by it."""
    return max(int(is_dashed), min(number // N_COLOURS, 2))


def spoken(title, lines, names, unit, time_text):
    """The chart in words."""
    parts = [f"{title} over time, {time_text}."]
    for name, values in zip(names, lines):
        finite = values[numpy.isfinite(values)]
        parts.append(f"{name}: from {units.number(finite.min())} to {units.number(finite.max())}"
                     f"{' ' + unit if unit else ''}, last {units.number(finite[-1])}.")
    return " ".join(parts)


def legend(names, lines, unit, silent, dashed):
    rows = []
    for number, (name, values) in enumerate(zip(names, lines)):
        finite = values[numpy.isfinite(values)]
        dash = ("solid", "dashed", "dotted")[kind_of(number, name in dashed)]
        rows.append(f'<button type="button" class="key s{number % N_COLOURS}" data-line="{number}" aria-pressed="true" '
                    f'title="Least {units.number(finite.min())}, largest {units.number(finite.max())}, last '
                    f'{units.number(finite[-1])} {escape(unit)}"><i style="border-top-style:{dash}"></i>'
                    f'{escape(name)}<output></output></button>')
    note = f'<p class="silent">Zero throughout: {escape(", ".join(silent))}.</p>' if silent else ""
    return f'<div class="legend">{"".join(rows)}</div>{note}'


def draw(chart):
    """The figure in HTML and its numbers for the page; the name of the chart and None where all is zero;
    None where no line has a number."""
    table = chart.table
    present = [name for name in chart.names if numpy.isfinite(table[name]).any()]
    if not present:
        return None
    largest = {name: float(numpy.nanmax(numpy.abs(numpy.where(numpy.isfinite(table[name]), table[name], numpy.nan))))
               for name in present}
    top = max(largest.values())
    shown = [name for name in present if largest[name] > max(SILENT * top, TINY)]
    shown.sort(key=lambda name: name in chart.dashed)  # these above the others
    text = {name: chart.short.get(name, name) for name in present}
    silent = [text[name] for name in present if name not in shown]
    if not shown:
        return chart.title if len(silent) == 1 else f'{chart.title} ({", ".join(silent)})', None
    scale = units.scale_for(top, table.units[shown[0]], shown[0])
    time_scale = units.scale_for(float(numpy.nanmax(numpy.abs(table["time"]))), table.units["time"])
    time = table["time"] * time_scale.factor
    lines = [numpy.where(numpy.isfinite(table[name]), table[name], numpy.nan) * scale.factor for name in shown]
    rows = thinned(lines)
    drawing = Drawing(time, lines)
    names = [text[name] for name in shown]
    heading = scale.heading(chart.quantity or chart.title[:1].lower() + chart.title[1:])
    time_text = f"from {units.number(time[0])} to {units.number(time[-1])} {time_scale.label}"
    label = spoken(chart.title, lines, names, scale.label, time_text)
    picture = "".join(drawing.line(number, time[rows], values[rows], shown[number] in chart.dashed)
                      for number, values in enumerate(lines))
    html = (f'<figure class="chart"><figcaption>{escape(chart.title)}</figcaption>'
            f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(label)}">'
            f'{drawing.axes(time_scale.heading("time"), heading)}{picture}'
            f'<path class="cursor" d=""/></svg>'
            f'<p class="reading" aria-hidden="true"></p>{legend(names, lines, scale.label, silent, {text[name] for name in chart.dashed if name in text})}</figure>')
    numbers = {"t": rounded(time[rows]), "y": [rounded(values[rows]) for values in lines], "unit": scale.label,
               "time": time_scale.label, "x": [drawing.x_range[0], drawing.x_range[1], LEFT, WIDTH - RIGHT],
               "v": [TOP, HEIGHT - BOTTOM]}
    return html, numbers
