# SPDX-License-Identifier: LGPL-2.1-or-later
"""The report of a scene with stages: a page a stage, and one that leads to them."""

import os
import re
from html import escape
from urllib.parse import quote

from . import page
from .report import make_report, tiles
from .run_files import TRACES, RunFiles


def stages_of(directory):
    """The output directories of the stages that left something below the directory, in their order; [] of a single run."""
    if any((directory / name).exists() for name in TRACES):
        return []
    for file in sorted(directory.glob("*/original.prm")):
        try:
            found = re.search(r"^\s*set\s+Stages\s*=([^#\n]*)", file.read_text("utf-8"), re.M)
        except (ValueError, OSError):
            continue
        stages = [directory / name.strip() for name in (found.group(1) if found else "").split(",")]
        if file.parent in stages:
            return [stage for stage in stages if stage.is_dir() and any((stage / name).exists() for name in TRACES)]
    return []


def address(page_there, page_here):
    return escape(quote(os.path.relpath(page_there, page_here.parent)))


def make_stage_reports(stages, target, cut, fields):
    """[(path of the page, its text, its notices), ...] of the stages, the page that leads to them, the target, last."""
    pages, rows = [], []
    for number, stage in enumerate(stages, 1):
        path, name = stage / "report.html", escape(stage.name)
        stage_line = (f'<p class="facts"><span>Stage {number} of {len(stages)}: {name}</span>'
                      f'<a href="{address(target, path)}">all stages</a></p>')
        text, notices = make_report(stage, cut, fields, stage_line)
        pages.append((path, text, notices))
        run = RunFiles(stage)
        state = escape(run.state)
        rows.append(f'<h3>{number}. <a href="{address(path, target)}">{name}</a>, {state}</h3>'
                    f"{page.notices_html(notices)}{page.tiles_html(tiles(run))}")
    front = page.Page(run.title())
    front.head = f'<header><div><h1>{escape(run.title())}</h1><p class="facts">{len(stages)} stages</p></div></header>\n'
    front.add("stages", "Stages", "".join(rows))
    front.foot = "<footer>Written by scripts/report. Each stage has a page of its own in its directory.</footer>\n"
    return pages + [(target, front.text(), [])]
