# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the checks of this directory have in common: the files of a project, lists of exceptions, the command."""

import sys
from pathlib import Path


def files_of(root, directories):
    """The files of C++ in these directories, relative to the project."""
    return [path.relative_to(root) for directory in directories
            for path in sorted((root / directory).rglob("*")) if path.suffix in (".h", ".cc")]


def rows_of_list(root, name):
    """The words of each line of a list of exceptions, and the line; none where there is no list."""
    path = root / name
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else []:
        if line.strip() and not line.startswith("#"):
            yield line.split(), line


def main(usage, check, option, print_list):
    """Prints what `check(root)` finds and fails where that is anything; with the option, prints a list."""
    arguments = [argument for argument in sys.argv[1:] if argument != option]
    if len(arguments) != 1:
        sys.exit(usage)
    root = Path(arguments[0])
    if option in sys.argv[1:]:
        print_list(root)
        return
    violations, n_files = check(root)
    print("\n".join(violations + [f"{n_files} files, {len(violations)} violations"]))
    # An empty project would satisfy every rule.
    sys.exit(1 if violations or n_files == 0 else 0)
