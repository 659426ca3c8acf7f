#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checks the layout of the library: includes point to lower layers only.

usage: check_layers.py [--offenders] PROJECT_DIRECTORY

Prints one line `file:line: what is wrong` for every violation of these rules, and fails where there
is one:

- A file of a layer includes headers of its own layer and of the layers in ALLOWED only.
- The applications include headers of any layer.
- Headers live in include/tombolo/<layer>/, sources in source/<layer>/. A source includes its own
  header (same name) or, where it has none, a header of its layer.
- No file is longer than MAXIMUM_LINES.
- No file names a path of one machine.
- Headers name exceptions of deal.II with `dealii::`: what an Assert names is compiled in Debug builds only.
- No class is longer than MAXIMUM_LINES over all its files, has more than MAXIMUM_MEMBERS data members
  of its own, and no function is longer than MAXIMUM_FUNCTION_LINES. The lines of a class are those of
  its header and of all files that define members of it, without the lines of other classes there.

Classes and functions that are larger are listed in tests/layers/known_offenders.txt with their number
of today ("kind name number"). None may grow, and the entry of one that is small enough, or gone, has to
be removed. --offenders prints this list as it is now, the largest first.
"""

import collections
import re

import checking
import outline

BELOW_FORMULATIONS = {"base", "mesh", "state", "approximation", "materials"}
BELOW_COUPLING = BELOW_FORMULATIONS | {"formulations", "boundary", "contact"}
BELOW_MODEL = BELOW_COUPLING | {"coupling", "output"}
BELOW_SIMULATION = BELOW_MODEL | {"remesh", "model", "physics"}

# Rooms of equal rank do not include each other; approximation and materials have no triangulation.
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
    "remesh": BELOW_FORMULATIONS | {"formulations"},
    "model": BELOW_MODEL,
    "physics": BELOW_MODEL | {"remesh", "model"},
    "simulation": BELOW_SIMULATION,
}

MAXIMUM_LINES = 600
MAXIMUM_MEMBERS = 25
MAXIMUM_FUNCTION_LINES = 80

KNOWN_OFFENDERS = "tests/layers/known_offenders.txt"
# What the kinds in that list count, and how much is allowed.
CAPS = {
    "class": ("lines over all its files", MAXIMUM_LINES),
    "members": ("data members", MAXIMUM_MEMBERS),
    "function": ("lines", MAXIMUM_FUNCTION_LINES),
}

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]tombolo/([^>"]+)[>"]')
MACHINE_PATH = re.compile(r'(?<![\w.~/-])/(?:home|root|tmp|work|usr/local|mnt|Users)/[A-Za-z0-9_.]')
UNQUALIFIED_EXCEPTION = re.compile(r"(?<![\w:])Exc[A-Z]\w*\(")


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
    elif any("TOMBOLO_REGISTER" in line for line in lines):  # a plug-in in one file
        return None
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
        if is_header and UNQUALIFIED_EXCEPTION.search(line):
            yield number, "names an exception of deal.II without dealii::"


class Sizes:
    """How large classes and functions are: {(kind, name): number}, and where each begins.

    A class of a header has its own name; one of a source, and a free function, that of the file in
    front. Classes in classes are parts of the outermost one, but their data members are their own."""

    def __init__(self, outlines):
        self.number = {}
        self.location = {}
        headers = {found.scope[0]: path for path, text in outlines.items() if path.suffix == ".h"
                   for found in text.classes}
        lines = collections.Counter()
        for path, text in outlines.items():
            def name_of(scope):
                return scope[0] if scope[0] in headers else f"{path.name}:{scope[0]}"

            taken = collections.Counter()  # lines in the file, by class
            for found in text.classes:
                name = name_of(found.scope)
                if len(found.scope) == 1:
                    taken[name] += found.last - found.first + 1
                    self.location.setdefault(("class", name), (path, found.first))
                self.add("members", "::".join((name,) + found.scope[1:]), found.members, path, found.first)
            inside = [(found.first, found.last) for found in text.classes]
            for found in text.functions:
                size = found.last - found.first + 1
                if not found.scope:
                    self.add("function", f"{path.name}:{found.name}", size, path, found.first)
                    continue
                name = name_of(found.scope)
                self.add("function", "::".join((name,) + found.scope[1:] + (found.name,)), size, path,
                         found.first)
                if not any(first <= found.first <= last for first, last in inside):
                    taken[name] += size
            for name in taken:
                lines[name] += text.n_lines - sum(taken.values()) + taken[name]
        for name, size in lines.items():
            self.number["class", name] = size

    def add(self, kind, name, number, path, line):
        """Of several with one name, as the versions of a function, the largest counts."""
        if number > self.number.get((kind, name), -1):
            self.number[kind, name] = number
            self.location[kind, name] = (path, line)

    def offenders(self):
        return {key: number for key, number in self.number.items() if number > CAPS[key[0]][1]}


def read_known_offenders(root):
    """{(kind, name): number} of the list; empty where there is none."""
    known = {}
    for (kind, name, number), line in checking.rows_of_list(root, KNOWN_OFFENDERS):
        if kind not in CAPS or (kind, name) in known:
            raise ValueError(f"{KNOWN_OFFENDERS}: {line}")
        known[kind, name] = int(number)
    return known


def check_sizes(sizes, known):
    for (kind, name), number in sorted(sizes.offenders().items()):
        what, cap = CAPS[kind]
        allowed = known.get((kind, name), cap)
        if number > allowed:
            path, line = sizes.location.get((kind, name), (KNOWN_OFFENDERS, 1))
            yield f"{path}:{line}: {name} has {number} {what}, more than {allowed}"
    for kind, name in sorted(set(known) - set(sizes.offenders())):
        yield f"{KNOWN_OFFENDERS}:1: {kind} {name} is no offender any more: remove it"


def files_of(root):
    """The files to check, relative to the project."""
    return checking.files_of(root, ("include", "source", "applications"))


def read_outlines(root, violations):
    outlines = {}
    for relative in files_of(root):
        try:
            outlines[relative] = outline.Outline((root / relative).read_text(encoding="utf-8"))
        except ValueError as error:
            violations.append(f"{relative}:1: cannot be read: {error}")
    return outlines


def check(root):
    """All violations below `root`, as lines to print, and the number of files."""
    violations = [f"{relative}:{number}: {problem}" for relative in files_of(root)
                  for number, problem in check_file(root, relative)]
    sizes = Sizes(read_outlines(root, violations))
    violations += check_sizes(sizes, read_known_offenders(root))
    return violations, len(files_of(root))


def print_offenders(root):
    offenders = Sizes(read_outlines(root, [])).offenders()
    for kind in CAPS:
        for key in sorted((key for key in offenders if key[0] == kind), key=lambda key: (-offenders[key], key)):
            print(*key, offenders[key])


if __name__ == "__main__":
    checking.main(__doc__, check, "--offenders", print_offenders)
