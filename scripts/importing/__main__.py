# SPDX-License-Identifier: LGPL-2.1-or-later
"""Converts a deck; scripts/import says how it is called."""

import argparse
import subprocess
import sys
from pathlib import Path

from .convert import convert
from .text import DeckError


def parse(arguments):
    parser = argparse.ArgumentParser(prog="import", add_help=False)
    parser.add_argument("deck", type=Path)
    parser.add_argument("target", type=Path, nargs="?")
    parser.add_argument("--mesh", action="store_true")
    parser.add_argument("--dimension", type=int, choices=(2, 3))
    parser.add_argument("--program")
    return parser.parse_args(arguments)


def complaint(program, path):
    """What the program says against a parameter file; nothing where it is valid."""
    result = subprocess.run([program, "--validate", path.name], cwd=path.parent, capture_output=True, text=True,
                            check=False)
    return "" if result.returncode == 0 else (result.stdout + result.stderr).strip()


def main(arguments):
    options = parse(arguments)
    target = options.target or options.deck.with_suffix(".prm")
    try:
        result = convert(options.deck, target, options.dimension, options.mesh)
        files = result.files()
        for path, content in files.items():
            path.write_text(content, encoding="utf-8")
    except DeckError as error:
        print(f"import: {options.deck}: {error}", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"import: {error.filename}: {error.strerror}", file=sys.stderr)
        return 1
    for path in files:
        print(f"import: wrote {path}")
    for line in result.report.summary():
        print(f"import: {line}")
    if target not in files:
        return 0
    if not options.program:
        print("import: there is no program tombolo to check the parameter file with: tombolo --validate does it.")
        return 0
    said = complaint(options.program, target)
    if said:
        print(f"import: {target} is not complete, tombolo --validate says:\n{said}", file=sys.stderr)
    return 1 if said else 0


sys.exit(main(sys.argv[1:]))
