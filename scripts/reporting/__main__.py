# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command line of scripts/report."""

import argparse
import os
import signal
import sys
import tempfile
from pathlib import Path

from plotting.__main__ import parse_cut
from plotting.results import PlotError

from .page import is_report
from .report import make_report
from .stages import make_stage_reports, stages_of


def parse_arguments(texts):
    parser = argparse.ArgumentParser(prog="report")
    parser.add_argument("directory", type=Path)
    parser.add_argument("--output", type=Path)
    parser.add_argument("--overwrite", action="store_true")
    parser.add_argument("--cut", type=parse_cut)
    parser.add_argument("--fields", type=lambda text: [field.strip() for field in text.split(",")])
    return parser.parse_args(texts)


def check_target(target, overwrites):
    if target.is_dir():
        raise PlotError(f"{target} is a directory; --output wants the name of a file")
    if target.exists() and not overwrites:
        if not target.is_file() or not is_report(target):
            raise PlotError(f"{target} exists and is no report: --overwrite replaces it, --output names another file")
    if not target.parent.is_dir():
        raise PlotError(f"there is no directory {target.parent}")


def write(target, text):
    """Whole or not at all."""
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=".report")
    try:
        with open(handle, "w", encoding="utf-8") as file:
            file.write(text)
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(name, 0o666 & ~umask)
        os.replace(name, target)
    except BaseException:
        os.unlink(name)
        raise


def main(texts=None):
    arguments = parse_arguments(texts)
    target = arguments.output or arguments.directory / "report.html"
    try:
        if not arguments.directory.is_dir():
            raise PlotError(f"there is no directory {arguments.directory}")
        stages = stages_of(arguments.directory)
        for one in [target, *(stage / "report.html" for stage in stages)]:
            check_target(one, arguments.overwrite)
        if stages:
            pages = make_stage_reports(stages, target, arguments.cut, arguments.fields)
        else:
            pages = [(target, *make_report(arguments.directory, arguments.cut, arguments.fields))]
        for path, text, _ in pages:
            write(path, text)
    except (PlotError, OSError) as error:
        sys.exit(f"report: {error}")
    for path, _, notices in pages:
        for notice in notices:
            print(f"{notice.level}: {notice.text}", file=sys.stderr)
        print(f"{path} ({path.stat().st_size / 1e6:.1f} MB)")


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # as other commands: a reader may have enough
    main()
