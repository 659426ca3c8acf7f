# SPDX-License-Identifier: LGPL-2.1-or-later
"""Converts a deck; scripts/import says how it is called."""

import argparse
import errno
import os
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


def write(files, deck):
    """All of the files, or none."""
    for path in files:
        if path.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if path.resolve() == deck.resolve():
            raise DeckError("the result would take the place of the deck. Name another FILE.prm.")
    parts = {path.with_name(path.name + ".part"): (path, content) for path, content in files.items()}
    try:
        for part, (_, content) in parts.items():
            part.write_text(content, encoding="utf-8")
        for part, (path, _) in parts.items():
            part.replace(path)
    except OSError as error:
        for part in parts:
            part.unlink(missing_ok=True)
        path, _ = parts.get(Path(error.filename or ""), (error.filename, ""))
        raise OSError(error.errno, error.strerror, str(path)) from None


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
        write(files, options.deck)
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
