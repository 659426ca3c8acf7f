#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checks the layout of the library: includes point to lower layers only.

usage: check_layers.py PROJECT_DIRECTORY

Prints one line `file:line: what is wrong` for every violation of these rules, and fails where there
is one:

- A file of a layer includes headers of its own layer and of the layers in ALLOWED only.
- The applications include headers of any layer.
- Headers live in include/tombolo/<layer>/, sources in source/<layer>/. A source includes its own
  header (same name) or, where it has none, a header of its layer.
- No file is longer than MAXIMUM_LINES.
- No file names a path of one machine.
"""

import re
import sys
from pathlib import Path

BELOW_FORMULATIONS = {"base", "mesh", "state", "approximation", "materials"}
BELOW_COUPLING = BELOW_FORMULATIONS | {"formulations", "boundary", "contact"}
BELOW_MODEL = BELOW_COUPLING | {"coupling", "output"}
BELOW_SIMULATION = BELOW_MODEL | {"model", "physics"}

# Rooms of equal rank do not include each other; approximation and materials know no triangulation.
ALLOWED = {
    "base": set(),
    "mesh": {"base"},
    "state": {"base", "mesh"},
    "approximation": {"base", "state"},
    "materials": {"base", "state"},
    "formulations": BELOW_FORMULATIONS,
    "boundary": BELOW_FORMULATIONS,
    "contact": BELOW_FORMULATIONS,
    "coupling": BELOW_COUPLING,
    "output": BELOW_COUPLING | {"coupling"},
    "model": BELOW_MODEL,
    "physics": BELOW_MODEL | {"model"},
    "simulation": BELOW_SIMULATION,
    # Runs the program as a child process: knows none of its physics.
    "study": {"base", "output"},
    # Dispersion and reflection: a library of its own, in which the operators are studied.
    "study/waves": BELOW_SIMULATION | {"simulation"},
}

MAXIMUM_LINES = 600

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]tombolo/([^>"]+)[>"]')
MACHINE_PATH = re.compile(r'(?<![\w.~/-])/(?:home|root|tmp|work|usr/local|mnt|Users)/[A-Za-z0-9_.]')


def includes_of(lines):
    """Line number and path below include/tombolo/ of every include of the project."""
    for number, line in enumerate(lines, start=1):
        match = INCLUDE.match(line)
        if match:
            yield number, match.group(1)


def layer_of(parts):
    """The layer of a file at `parts` below include/tombolo or source."""
    return "/".join(parts[:2]) if "/".join(parts[:2]) in ALLOWED else parts[0]


def check_include(layer, target):
    """What is wrong with including `target` from `layer`, or None."""
    parts = target.split("/")
    if len(parts) == 1:  # tombolo/version.h belongs to no layer
        return None
    other = layer_of(parts)
    if other not in ALLOWED:
        return f"tombolo/{target} is in no layer"
    if layer is None or other == layer or other in ALLOWED[layer]:
        return None
    return f"{layer} must not include {other} (tombolo/{target})"


def check_own_header(root, relative, lines):
    """What is wrong with the header that a source implements, or None."""
    own = "/".join(relative.with_suffix(".h").parts[1:])
    included = [target for _, target in includes_of(lines)]
    if (root / "include/tombolo" / own).exists():
        if own not in included:
            return f"does not include its own header tombolo/{own}"
    elif layer_of(relative.parts[1:]) not in [layer_of(target.split("/")) for target in included]:
        return "has no header of its own and includes none of its layer"
    return None


def check_file(root, relative):
    text = (root / relative).read_text(encoding="utf-8")
    lines = text.splitlines()
    parts = relative.parts
    is_header = parts[0] == "include"
    is_application = parts[0] == "applications"
    layer = None
    if not is_application:
        layer = layer_of(parts[2:] if is_header and len(parts) > 3 else parts[1:])
        if layer not in ALLOWED or (is_header and parts[1] != "tombolo"):
            yield 1, "is in the directory of no layer"
            layer = None
        elif relative.suffix != (".h" if is_header else ".cc"):
            yield 1, "headers belong into include/tombolo/, sources into source/"
        elif not is_header:
            problem = check_own_header(root, relative, lines)
            if problem:
                yield 1, problem
    for number, target in includes_of(lines):
        problem = check_include(layer, target)
        if problem:
            yield number, problem
    if len(lines) > MAXIMUM_LINES:
        yield MAXIMUM_LINES + 1, f"has {len(lines)} lines, more than {MAXIMUM_LINES}"
    for number, line in enumerate(lines, start=1):
        if MACHINE_PATH.search(line):
            yield number, "names a path of one machine"


def check(root):
    """All violations below `root`, as lines to print, and the number of files."""
    violations = []
    n_files = 0
    for directory in ("include", "source", "applications"):
        for path in sorted((root / directory).rglob("*")):
            if path.suffix in (".h", ".cc"):
                n_files += 1
                relative = path.relative_to(root)
                violations += [f"{relative}:{number}: {problem}"
                               for number, problem in check_file(root, relative)]
    return violations, n_files


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    violations, n_files = check(Path(sys.argv[1]))
    print("\n".join(violations + [f"{n_files} files, {len(violations)} violations"]))
    # An empty project would satisfy every rule.
    sys.exit(1 if violations or n_files == 0 else 0)


if __name__ == "__main__":
    main()
