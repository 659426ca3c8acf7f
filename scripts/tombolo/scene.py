# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scenes: parameter files from dictionaries or from other files, and their runs."""

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from .errors import TomboloError
from .parameter_file import ParameterFile
from .run import Run


def text_of(value):
    if isinstance(value, bool):
        return str(value).lower()
    return ", ".join(map(text_of, value)) if isinstance(value, (list, tuple)) else str(value)


def flat(entries, within=""):
    """{"Section/Entry": text} of nested dictionaries; a key may have "/" itself."""
    result = {}
    for name, value in entries.items():
        result.update(flat(value, f"{within}{name}/") if isinstance(value, dict) else {within + name: text_of(value)})
    return result


def lines_of(entries, indent=""):
    """The lines of a parameter file: entries of a section before its subsections."""
    sections = {}
    for path, value in entries.items():
        section, slash, rest = path.partition("/")
        if slash:
            sections.setdefault(section, {})[rest] = value
        else:
            yield f"{indent}set {path} = {value}"
    for section, inner in sections.items():
        yield f"{indent}subsection {section}"
        yield from lines_of(inner, indent + "  ")
        yield f"{indent}end"


def find_program(name="tombolo", variable="TOMBOLO_PROGRAM"):
    """What the variable of the environment names, that of the project, or that which is installed."""
    built = Path(__file__).resolve().parents[2] / "build/bin" / name
    program = os.environ.get(variable) or (built if built.exists() else shutil.which(name))
    if not program:
        raise TomboloError(f"the program {name} is not found: it is not on PATH, and {variable} does not name it")
    return str(program)


class Scene:
    """Entries of a parameter file, from nested dictionaries or from a file, with changes
    {"Section/Entry": value}. Names of files are relative to where they were in the file read."""

    def __init__(self, source, changes=None):
        self.path = None if isinstance(source, dict) else Path(source)
        self.changes = flat(changes or {})
        self.entries = flat(source) if self.path is None else {
            name: value for name, (value, _) in ParameterFile(self.path).entries.items()}
        self.entries.update(self.changes)

    def with_changes(self, changes):
        """Another scene; this one stays as it is."""
        result = Scene({})
        result.path, result.changes = self.path, {**self.changes, **flat(changes)}
        result.entries = {**self.entries, **flat(changes)}
        return result

    def write(self, path):
        Path(path).write_text("\n".join(lines_of(self.entries)) + "\n", "utf-8")

    def run(self, ranks=1):
        """Runs the scene; throws TomboloError with the message of the program where it stops."""
        if "Output directory" not in self.entries:
            raise TomboloError('the scene has no entry "Output directory"')
        # The program is given the file itself, so that what it reads besides is found.
        if self.path is not None:
            sets = [word for name, value in self.changes.items() for word in ("--set", f"{name} = {value}")]
            self.execute([str(self.path), *sets], ranks)
        else:
            with tempfile.TemporaryDirectory() as directory:
                self.write(Path(directory) / "scene.prm")
                self.execute([str(Path(directory) / "scene.prm")], ranks)
        return Run(self.entries["Output directory"])

    @staticmethod
    def execute(arguments, ranks):
        command = [find_program(), *arguments]
        if ranks > 1:
            free = ["--bind-to", "none"] if ranks > (os.cpu_count() or 1) else []
            command = ["mpirun", "-n", str(ranks), *free, *command]
        ended = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               stdin=subprocess.DEVNULL, check=False)
        if ended.returncode:
            found = re.search(r"(?:Error|The run stopped): .*", ended.stdout, re.DOTALL)
            message = found.group() if found else ended.stdout[-2000:]
            raise TomboloError(message.strip() or f"the program ended with {ended.returncode}")

    def sweep(self, entry, values, ranks=1):
        """{value: Run} of an entry over values, each with an output directory in that of the scene."""
        base = Path(self.entries.get("Output directory", "output"))
        runs = {}
        for value in values:
            directory = base / re.sub(r"[^\w.+-]+", "_", f"{entry} {text_of(value)}")
            directory.parent.mkdir(parents=True, exist_ok=True)
            runs[value] = self.with_changes({entry: value, "Output directory": str(directory)}).run(ranks)
        return runs
