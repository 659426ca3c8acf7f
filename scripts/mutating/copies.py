# SPDX-License-Identifier: LGPL-2.1-or-later
"""The copy of the project that has the mutants. Only files that changed are written again, so that
the next build is short."""

import shutil
import subprocess
from pathlib import Path

from mutating import mutants as listed

BUILD = "build"


def files_of(root):
    """What belongs to the project, as paths in it."""
    for path in sorted(Path(root).iterdir()):
        if path.name.startswith((".", BUILD)) or path.name in ("output", "regression"):
            continue
        if path.is_file():
            yield path.relative_to(root)
        else:
            yield from (file.relative_to(root) for file in sorted(path.rglob("*"))
                        if file.is_file() and "__pycache__" not in file.parts)


def renew(root, copy, mutants):
    """Brings the copy to the state of the project, with the mutants."""
    mutated = {path: text.encode("utf-8")
               for path, text in listed.sources_with_mutants(root, mutants).items()}
    wanted = set(mutated)
    for path in files_of(root):
        wanted.add(path)
        content = mutated.get(path)
        write_if_changed(copy / path, content if content is not None else (root / path).read_bytes())
        shutil.copymode(root / path, copy / path)
    write_if_changed(copy / listed.HEADER, mutated[listed.HEADER])
    for path in list(files_of(copy)):
        if path not in wanted:
            (copy / path).unlink()


def write_if_changed(path, content):
    if path.is_file() and path.read_bytes() == content:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


# The program, how tests start it, and plug-ins that their scenes name.
PROGRAM = ["tombolo_program", "start_loaded", "program_server", "preloaded_waiting_rank", "lattice_filter",
           "interpolated_remap"]


def targets_of(tests):
    """What must be built for these tests."""
    result = set()
    for test in tests:
        kind, name = test.split(".", 1)
        result.update(["test_" + name.split("/")[0]] if kind == "unit" else PROGRAM)
    return sorted(result)


def build(copy, tests):
    subprocess.run([copy / "scripts" / "build", *targets_of(tests)], check=True)
