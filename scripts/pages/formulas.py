# SPDX-License-Identifier: LGPL-2.1-or-later
"""Formulas of pages as MathML, which browsers show without a script: $`...`$ or $...$ in a line and blocks of code of the
language math, all of which the forge shows as well. What converts TeX is the program blahtexml."""

import functools
import html
import re
import shutil
import subprocess

from pages import text

PROGRAM = "blahtexml"
INLINE = re.compile(r"\$`([^`]+)`\$")
WITHOUT_TICKS = re.compile(r"(?<![\w$`])\$(?=[^\s$`\d])([^$`\n]*[^\s$`])\$(?![\w$`])")
# The number of an equation, which the page shows beside it.
TAG = re.compile(r"\s*\\tag\{([^{}]+)\}\s*")
OPTIONS = ("--mathml", "--spacing", "moderate", "--mathml-nsprefix-none", "--other-encoding", "raw", "--mathml-encoding", "raw")

# What blahtexml writes and what browsers show better: a minus, numbers and signs in one piece, hats that are not as wide as
# their letter, no space around a slash.
IMPROVED = [(r"<mo([^>]*)>-</mo>", r"<mo\1>−</mo>"),
            (r"<mn>(\d+)</mn><mo[^>]*>\.</mo><mn>(\d+)</mn>", r"<mn>\1.\2</mn>"),
            (r"<mo[^>]*>([+−])</mo><mo[^>]*>=</mo>", r"<mo>\1=</mo>"),
            ("<mo accent=\"true\">\u0302</mo>", '<mo stretchy="false">^</mo>'),
            (r"<mo[^>]*>/</mo>", '<mo lspace="0" rspace="0">/</mo>')]


class FormulaError(Exception):
    pass


def can_be_converted():
    return shutil.which(PROGRAM) is not None


def with_ticks(page):
    """The text of a page with $...$ of its lines as $`...`$."""
    lines = page.split("\n")
    for block in text.blocks_of(page):
        if block.kind in ("text", "table"):
            for k in range(block.line - 1, block.line + block.text.count("\n")):
                plain = text.without_code(lines[k])
                for found in reversed(list(WITHOUT_TICKS.finditer(plain))):
                    lines[k] = lines[k][:found.start()] + f"$`{found[1]}`$" + lines[k][found.end():]
    return "\n".join(lines)


def formulas_of(page):
    """(line, TeX, whether it is a block) of each formula of the text of a page."""
    page, found = with_ticks(page), []
    for block in text.blocks_of(page):
        if block.kind == "code":
            lines = block.text.rstrip("\n").split("\n")
            if page.split("\n")[block.line - 1].strip() == "```math":
                found.append((block.line, "\n".join(lines[:-1]), True))
        else:
            found += [(block.line + block.text.count("\n", 0, one.start()), one[1], False)
                      for one in INLINE.finditer(block.text)]
    return found


@functools.lru_cache(maxsize=None)
def mathml(tex, is_block=False):
    """The element math of a formula without its number."""
    options = OPTIONS + (("--displaymath",) if is_block else ())
    ended = subprocess.run([PROGRAM, *options], input=tex, capture_output=True, text=True, check=False)
    found = re.search(r"<markup>\s*(.*?)\s*</markup>", ended.stdout, re.DOTALL)
    if not found:
        message = re.search(r"<message>(.*?)</message>", ended.stdout, re.DOTALL)
        raise FormulaError(f"{tex}: {html.unescape(message[1]) if message else ended.stderr or 'no formula'}")
    written = found[1]
    for pattern, other in IMPROVED:
        written = re.sub(pattern, other, written)
    display = ' display="block"' if is_block else ""
    return f"<math{display}>{written}</math>"


def in_line(code):
    """The HTML of a formula in a line; its TeX where it cannot be converted."""
    return mathml(html.unescape(code)) if can_be_converted() else f"<code>{code}</code>"


def block(code):
    """The HTML of a formula with a line of its own and its number."""
    tex = html.unescape(code)
    tags = TAG.findall(tex)
    tex = TAG.sub("", tex)
    if not can_be_converted():
        return f"<pre><code>{code}</code></pre>"
    number = f'<span class="number">({html.escape(tags[0])})</span>' if tags else ""
    return f'<div class="equation">{mathml(tex, True)}{number}</div>'


def in_page(body):
    """The HTML of a page with its formulas converted."""
    body = re.sub(r'<pre><code class="language-math">(.*?)</code></pre>', lambda found: block(found[1]), body, flags=re.DOTALL)
    return re.sub(r"\$<code>([^<]*)</code>\$", lambda found: in_line(found[1]), body)
