#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs a case: the program on parameter files, then checks of what the runs left behind.

usage: run_case.py CASE.json --program PATH [--output DIRECTORY] [--mpiexec PATH] [--jobs N] [--report]

A case is a JSON object:

  "what"    one sentence: what the case proves
  "let"     names and texts; "{name}" anywhere below means the text
  "runs"    list of {"name", "file", "ranks", "set": {"Section/Entry": value}, "options": [...]};
            the file is looked for beside the case, then in the project;
            the mesh it names may be one that body_meshes.py writes
  "checks"  list of {"what", "value", "at_most", "at_least", "equals"}; the value is a Python
            expression of the functions below (see class Results); at least one bound is needed,
            and a value that is not a finite number fails

  "sets"    names and settings; a run with "with": [names] has these as well

A run or a check with "for": {"name": [texts]} means one of each combination, and one with
"for": {"name other": [[text, text]]} for one of each of these pairs. --jobs makes so many runs of one
rank at a time; no run may need another one. --report prints the checks as rows of a table in
Markdown. Exit code 0 only if every run ended as it should and every check holds.
"""

import argparse
import ast
import base64
import csv
import heapq
import itertools
import json
import math
import os
import queue
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
import zlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "loaded"))
import body_meshes
import loaded

PROJECT = Path(__file__).resolve().parents[2]
AXIAL_ERROR = "relative error of stress xx"


class CaseError(Exception):
    """The case cannot be judged: it is malformed, or a run did not do what it should."""


def filled(value, names):
    """The value with every {name} in its texts replaced."""
    if isinstance(value, str):
        for _ in range(4):  # texts may contain names themselves
            value = re.sub(r"\{(\w+)\}", lambda m: str(names.get(m.group(1), m.group(0))), value)
        return value
    if isinstance(value, list):
        return [filled(item, names) for item in value]
    if isinstance(value, dict):
        return {filled(key, names): filled(item, names) for key, item in value.items()}
    return value


def expanded(entries, case, known):
    """Entries of a case with "for" and "with" written out."""
    for entry in entries:
        unknown = set(entry) - known
        if unknown:
            raise CaseError(f"unknown key {sorted(unknown)} in {entry}")
        loop = entry.get("for", {})
        for values in itertools.product(*loop.values()):
            names = dict(case.get("let", {}))
            for key, value in zip(loop, values):
                names.update(zip(key.split(), value) if isinstance(value, list) else [(key, value)])
            body = {key: value for key, value in entry.items() if key not in ("for", "with")}
            for common in reversed(filled(entry.get("with", []), names)):
                body["set"] = {**case["sets"][common], **body.get("set", {})}
            yield filled(body, names)


def runs_of(case):
    return list(expanded(case["runs"], case, {"name", "file", "ranks", "set", "options", "exit", "for",
                                              "with"}))


def checks_of(case):
    return list(expanded(case["checks"], case, {"what", "value", "at_most", "at_least", "equals",
                                                "for"}))


def compressed_array(element):
    """A binary DataArray of VTK: a header of 64-bit numbers, then blocks of zlib."""
    code = {"Float64": "d", "Float32": "f", "UInt64": "Q", "Int64": "q", "UInt32": "I",
            "Int32": "i", "UInt8": "B", "Int8": "b"}[element.get("type")]
    text = element.text.strip()
    n_blocks = struct.unpack("<Q", base64.b64decode(text[:12])[:8])[0]
    header_bytes = 8 * (3 + n_blocks)
    header_text = 4 * ((header_bytes + 2) // 3)
    sizes = struct.unpack(f"<{3 + n_blocks}Q", base64.b64decode(text[:header_text])[:header_bytes])
    body = base64.b64decode(text[header_text:])
    data, offset = b"", 0
    for size in sizes[3:]:
        data += zlib.decompress(body[offset:offset + size])
        offset += size
    numbers = struct.unpack(f"<{len(data) // struct.calcsize(code)}{code}", data)
    width = int(element.get("NumberOfComponents", 1))
    return [numbers[i:i + width] for i in range(0, len(numbers), width)]


class Results:
    """The functions of expressions of checks, by name."""

    def __init__(self, output):
        self.output = Path(output)

    def directory(self, run):
        path = self.output / run
        if not path.is_dir():
            raise CaseError(f"there is no run \"{run}\"")
        return path

    def names(self):
        """The functions of expressions."""
        functions = ("stat", "column", "largest", "summary", "error", "order", "difference",
                     "differing_files", "audit", "field", "spread", "interior_error",
                     "probe", "roughness", "pieces", "area_of_cells")
        names = {function: getattr(self, function) for function in functions}
        names.update(abs=abs, max=max, min=min, sum=sum, len=len, set=set, sqrt=math.sqrt,
                     log=math.log, log2=math.log2, pi=math.pi, zip=zip, range=range)
        return names

    def table(self, run, file_name):
        with open(self.directory(run) / file_name, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        if len(rows) < 2:
            raise CaseError(f"{file_name} of run \"{run}\" has no row")
        heads = [re.sub(r" \[[^]]*\]$", "", head) for head in rows[0]]
        return {head: [float(row[i]) if row[i] else math.nan for row in rows[1:]]
                for i, head in enumerate(heads)}

    def column(self, run, name, file_name="statistics.csv"):
        """All values of a column of statistics.csv."""
        table = self.table(run, file_name)
        if name not in table:
            raise CaseError(f"{file_name} has no column \"{name}\", but {sorted(table)}")
        return table[name]

    def stat(self, run, name, time=None):
        """A value of statistics.csv, of the last row or of the row of a time."""
        values = self.column(run, name)
        if time is None:
            return values[-1]
        for row_time, value in zip(self.column(run, "time"), values):
            if abs(row_time - time) < 1e-9 * max(1., abs(time)):
                return value
        raise CaseError(f"run \"{run}\" has no output at time {time}")

    def largest(self, run, name):
        """The largest magnitude in a column of statistics.csv."""
        values = [abs(value) for value in self.column(run, name)]
        return math.nan if any(map(math.isnan, values)) else max(values)

    def error(self, run, time=None, name=AXIAL_ERROR):
        """Relative L2 error against the exact solution."""
        return self.stat(run, name, time)

    def order(self, coarse, fine, time=None, name=AXIAL_ERROR):
        """Observed order of convergence when the spacing is halved."""
        return math.log2(self.error(coarse, time, name) / self.error(fine, time, name))

    def summary(self, run, *keys):
        """A value of summary.json."""
        with open(self.directory(run) / "summary.json", encoding="utf-8") as file:
            value = json.load(file)
        for key in keys:
            value = value[key]
        return value

    def probe(self, run, name):
        """A column of probes.csv."""
        return self.column(run, name, "probes.csv")

    def difference(self, run, other, columns=None):
        """The largest difference of two runs in statistics.csv, each column relative to its largest
        magnitude. Columns that measure round-off (drifts, errors of conservation) and columns below
        1e-10 of the largest of their unit have no scale of their own and are compared to that."""
        tables = [self.table(name, "statistics.csv") for name in (run, other)]
        with open(self.directory(run) / "statistics.csv", newline="", encoding="utf-8") as file:
            heads = next(csv.reader(file))
        units = {re.sub(r" \[[^]]*\]$", "", head): (re.findall(r"\[([^]]*)\]$", head) or ["1"])[0]
                 for head in heads}
        if set(tables[0]) != set(tables[1]):
            raise CaseError("the tables have different columns")
        scale_of_unit = {}
        for name, values in tables[0].items():
            finite = [abs(v) for v in values if math.isfinite(v)]
            unit = units[name]
            scale_of_unit[unit] = max([scale_of_unit.get(unit, 0.)] + finite)
        worst = 0.
        for name in columns or tables[0]:
            a, b = tables[0][name], tables[1][name]
            if len(a) != len(b):
                return math.inf
            own = max([abs(v) for v in a if math.isfinite(v)] + [0.])
            scale = own
            if units[name] == "1" and name != "step":
                scale = max(own, 1.)
            elif own < 1e-10 * scale_of_unit[units[name]]:
                scale = scale_of_unit[units[name]]
            for x, y in zip(a, b):
                if math.isnan(x) and math.isnan(y):
                    continue
                worst = max(worst, abs(x - y) / scale if scale > 0 else abs(x - y))
                if not math.isfinite(abs(x - y)):
                    return math.inf
        return worst

    def differing_files(self, run, other):
        """How many of the files with results (tables and solution) are not the same, bit by bit."""
        files = [[path.relative_to(root) for path in sorted(root.rglob("*"))
                  if path.name in ("statistics.csv", "probes.csv") or path.suffix == ".vtu"]
                 for root in (self.directory(run), self.directory(other))]
        if not files[0]:
            raise CaseError("there is nothing to compare")
        different = set(files[0]) ^ set(files[1])
        roots = self.directory(run), self.directory(other)
        return len(different) + sum(
            (roots[0] / name).read_bytes() != (roots[1] / name).read_bytes()
            for name in set(files[0]) & set(files[1]))

    def audit(self, run, pattern):
        """The number that a pattern finds in what the program printed."""
        text = (self.directory(run) / "printed.txt").read_text(encoding="utf-8")
        found = re.search(pattern, text)
        if not found:
            raise CaseError(f"the program did not print anything like \"{pattern}\"")
        return float(found.group(1))

    def field(self, run, kind, name, index=-1):
        """Tuples of a field at an output: kind is "cells" or "particles". Together with it the
        positions (of particles) are found as field "Points"."""
        numbers = sorted({path.name.split(".")[0] for path in
                          (self.directory(run) / "solution").glob(f"{kind}_*.vtu")})
        if not numbers:
            raise CaseError(f"run \"{run}\" wrote no {kind}")
        values = []
        for path in sorted((self.directory(run) / "solution").glob(numbers[index] + ".*.vtu")):
            arrays = {array.get("Name"): array for array in ElementTree.parse(path).iter("DataArray")}
            if name not in arrays:
                raise CaseError(f"{kind} have no field \"{name}\", but {sorted(arrays)}")
            if arrays[name].text and arrays[name].text.strip():
                values += compressed_array(arrays[name])
        if not values:
            raise CaseError(f"field \"{name}\" of run \"{run}\" is empty")
        return values

    def area_of_cells(self, run, index=-1, bulk_modulus=math.inf):
        """The area of all cells of a body in the plane at an output; with a bulk modulus, that which
        it would have without the pressure."""
        numbers = sorted({path.name.split(".")[0] for path in
                          (self.directory(run) / "solution").glob("cells_*.vtu")})
        area = 0.
        for path in (self.directory(run) / "solution").glob(numbers[index] + ".*.vtu"):
            arrays = {array.get("Name"): array for array in ElementTree.parse(path).iter("DataArray")}
            points = compressed_array(arrays["Points"])
            nodes = [int(number[0]) for number in compressed_array(arrays["connectivity"])]
            for first, stress in zip(range(0, len(nodes), 4), compressed_array(arrays["stress"])):
                corners = [points[node] for node in nodes[first:first + 4]]
                area += (0.5 * sum(a[0] * b[1] - b[0] * a[1]
                                   for a, b in zip(corners, corners[1:] + corners[:1]))
                         * math.exp(-sum(stress[:3]) / 3 / bulk_modulus))
        return area

    def interior_error(self, run, margin, axis=0, component=0):
        """Relative L2 error of a stress component (of xx, yy, zz, xy, yz, xz) against the exact one, over
        the particles farther than margin from both ends of the axis."""
        positions = self.field(run, "particles", "initial position")
        lower, upper = (bound(position[axis] for position in positions) for bound in (min, max))
        rows = zip(positions, self.field(run, "particles", "volume"),
                   self.field(run, "particles", "stress"), self.field(run, "particles", "exact stress"))
        error = scale = 0.
        for position, volume, stress, exact in rows:
            if lower + margin < position[axis] < upper - margin:
                error += volume[0] * (stress[component] - exact[component]) ** 2
                scale += volume[0] * exact[component] ** 2
        return math.sqrt(error / scale)

    def spread(self, run, kind, name, component=0, where=None, about=None):
        """The largest deviation of a component from a value (its mean), relative to it. `where`
        receives a tuple of initial coordinates."""
        values = [value[component] for value in self.field(run, kind, name)]
        if where is not None:
            points = self.field(run, kind, "initial position")
            values = [value for value, point in zip(values, points) if where(*point)]
        if not values:
            raise CaseError("the predicate selects nothing")
        centre = sum(values) / len(values) if about is None else about
        return max(abs(value - centre) for value in values) / abs(centre)

    def pieces(self, run, kind, distance, index=-1):
        """The number of points of each body, the largest first: points that chains of steps up to
        this distance join."""
        points = self.field(run, kind, "Points", index)
        boxes = {}
        for number, point in enumerate(points):
            boxes.setdefault(tuple(math.floor(x / distance) for x in point), []).append(number)
        sizes, seen = [], set()
        for first in range(len(points)):
            if first in seen:
                continue
            seen.add(first)
            front, size = [first], 0
            while front:
                number = front.pop()
                size += 1
                box = tuple(math.floor(x / distance) for x in points[number])
                for step in itertools.product((-1, 0, 1), repeat=3):
                    for other in boxes.get(tuple(b + s for b, s in zip(box, step)), ()):
                        if other not in seen and math.dist(points[number], points[other]) <= distance:
                            seen.add(other)
                            front.append(other)
            sizes.append(size)
        return sorted(sizes, reverse=True)

    def roughness(self, run, kind, name, component=0, n_neighbours=6):
        """How a field differs from point to point: the root mean square of the difference to the mean
        of the nearest points, nearest initially, over that of the field."""
        values = [value[component] for value in self.field(run, kind, name)]
        points = self.field(run, kind, "initial position")
        differences = 0.
        for point, value in zip(points, values):
            nearest = heapq.nsmallest(n_neighbours + 1, zip((math.dist(point, other)
                                                             for other in points), values))
            differences += (value - sum(other_value for _, other_value in nearest[1:]) / n_neighbours) ** 2
        return math.sqrt(differences / sum(value ** 2 for value in values))


def run_all(runs, case, output, arguments):
    """Runs of one rank side by side, then the others one after the other."""
    output.mkdir(parents=True, exist_ok=True)
    write_meshes(runs, case, output)
    loaded.start_of(arguments.program)
    # A program removes its session of MPI while another one makes its own.
    sessions = queue.Queue()
    for _ in range(arguments.jobs):
        sessions.put(tempfile.mkdtemp(prefix="r"))

    def run_with_a_session(run):
        session = sessions.get()
        try:
            run_program(run, case, output, arguments, session)
        finally:
            sessions.put(session)

    try:
        with ThreadPoolExecutor(arguments.jobs) as pool:
            list(pool.map(run_with_a_session, [run for run in runs if int(run.get("ranks", 1)) == 1]))
        for run in runs:
            if int(run.get("ranks", 1)) > 1:
                run_with_a_session(run)
    finally:
        while not sessions.empty():
            shutil.rmtree(sessions.get(), ignore_errors=True)


def scene_of(run, case):
    """The parameter file of a run."""
    for path in (case.parent / run["file"], PROJECT / run["file"]):
        if path.is_file():
            return path
    raise CaseError(f"there is no file {run['file']}")


def text_of(path):
    """The text of a parameter file and of those that it includes."""
    text = path.read_text(encoding="utf-8")
    included = re.findall(r"^\s*include\s+(\S+)", text, re.MULTILINE)
    return "\n".join([text] + [text_of(path.parent / name) for name in included])


def write_meshes(runs, case, output):
    """Writes the meshes that scenes or their settings name into the working directory of the runs."""
    scenes = {scene_of(run, case) for run in runs}
    text = json.dumps(runs) + "".join(map(text_of, scenes))
    for name in body_meshes.TEST_MESHES:
        if name in text:
            mesh = body_meshes.write(name, output)
            for beside in {scene.parent / name for scene in scenes}:
                if beside.exists() and beside.read_bytes() != mesh.read_bytes():
                    raise CaseError(f"{beside} would be taken, but is not what body_meshes.py writes")


def run_program(run, case, output, arguments, session):
    """Runs the program once into output/name, with MPI's session in a directory."""
    directory = output / run["name"]
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    settings = {"Output/Write solution": "false", **run.get("set", {}),
                "Output directory": str(directory)}
    command = [*loaded.start_of(arguments.program), *run.get("options", []), str(scene_of(run, case))]
    for entry, value in settings.items():
        command += ["--set", f"{entry} = {value}"]
    ranks = int(run.get("ranks", 1))
    if ranks > 1:
        command = [arguments.mpiexec, "-n", str(ranks)] + command
    environment = dict(loaded.environment(ranks), OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_rmaps_base_oversubscribe="1", PRTE_MCA_rmaps_default_mapping_policy=":oversubscribe", OMP_NUM_THREADS="1",
                       OMPI_MCA_hwloc_base_binding_policy="none",
                       OMPI_MCA_mpi_yield_when_idle="1", DEAL_II_NUM_THREADS="1", TMPDIR=session)
    result = subprocess.run(command, cwd=output, env=environment, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, text=True, check=False)
    directory.mkdir(exist_ok=True)
    (directory / "printed.txt").write_text(result.stdout, encoding="utf-8")
    if result.returncode != int(run.get("exit", 0)):
        raise CaseError(f"run \"{run['name']}\" ended with {result.returncode}:\n"
                        + " ".join(command) + "\n" + result.stdout[-3000:])


def verdict(check, value):
    """None if the bounds hold, or what is wrong."""
    bounds = [key for key in ("at_most", "at_least", "equals") if key in check]
    if not bounds:
        raise CaseError(f"the check of {check['value']} has no bound: it could not fail")
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        return f"is {value}, not a finite number"
    if "at_most" in check and value > float(check["at_most"]):
        return f"is {value:.4g}, more than {check['at_most']}"
    if "at_least" in check and value < float(check["at_least"]):
        return f"is {value:.4g}, less than {check['at_least']}"
    if "equals" in check and value != float(check["equals"]):
        return f"is {value!r}, not {check['equals']}"
    return None


def bounds_of(check):
    words = {"at_least": "≥", "at_most": "≤", "equals": "="}
    return ", ".join(f"{word} {check[key]}" for key, word in words.items() if key in check)


def found_program(name):
    """The path of a program, which holds in any directory."""
    return os.path.abspath(shutil.which(name) or name)


def main():
    parser = argparse.ArgumentParser(description="Runs a case and checks its results.")
    parser.add_argument("case", type=Path)
    parser.add_argument("--program", type=found_program, required=True, help="path of tombolo")
    parser.add_argument("--mpiexec", type=found_program, default="mpirun")
    parser.add_argument("--output", type=Path, help="where the runs leave their results")
    parser.add_argument("--jobs", type=int, default=1, help="runs of one rank at a time")
    parser.add_argument("--report", action="store_true", help="print rows of a table in Markdown")
    parser.add_argument("--only-check", action="store_true", help="check runs made earlier")
    arguments = parser.parse_args()
    output = (arguments.output or Path("regression") / arguments.case.stem).resolve()
    failures = 0
    try:
        case = json.loads(arguments.case.read_text(encoding="utf-8"))
        runs, checks = runs_of(case), checks_of(case)
        if not checks:
            raise CaseError("a case without checks proves nothing")
        if len({run["name"] for run in runs}) != len(runs):
            raise CaseError("two runs have the same name")
        for check in checks:
            ast.parse(check["value"], mode="eval")
            verdict(check, 0.)
        if not arguments.only_check:
            run_all(runs, arguments.case.resolve(), output, arguments)
        results = Results(output)
        for check in checks:
            try:
                value = eval(check["value"], {"__builtins__": {}, **results.names()})
                wrong = verdict(check, value)
            except (CaseError, NameError, TypeError, LookupError, ArithmeticError,
                    ValueError) as error:
                value, wrong = math.nan, f"cannot be taken: {error!r}"
            what = check.get("what", check["value"])
            if arguments.report:
                print(f"| {what} | {bounds_of(check)} | {value:.3g} |" + (" **missed**" if wrong else ""))
            else:
                print(("FAILED  " if wrong else "holds   ") + f"{what}: "
                      + (wrong if wrong else f"{value:.6g} ({bounds_of(check)})"))
            failures += wrong is not None
    except (CaseError, SyntaxError, json.JSONDecodeError, KeyError, OSError) as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
