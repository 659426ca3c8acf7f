# SPDX-License-Identifier: LGPL-2.1-or-later
"""Time to a solution: the error of whole runs on meshes of several sizes over their processor time."""

import json
import math
import re
from dataclasses import dataclass, field
from pathlib import Path

from .runs import BenchmarkError, available_cores, median, user_seconds
from .tables import number, print_table

SETTINGS = Path("benchmarks/solutions.json")
FOLDER = Path("parameter_files")


@dataclass
class Model:
    """A parameter file, and the meshes that it is run on."""
    name: str
    file: str
    sizes: list
    settings: list = field(default_factory=list)
    two_ranks: str = None  # the size that is run on two ranks, too


class Problem:
    """Of a file: models of one scene whose results are known. Errors below the last of the levels are not distinguished
    apart, since the reference is not known better."""

    def __init__(self, root, pattern=None, file=SETTINGS):
        read = json.loads((root / file).read_text("utf-8"))
        self.title, self.reference = read["title"], read["reference"]
        self.settings, self.sizes, self.levels = read["settings"], read["sizes"], read["levels"]
        models = [Model(**entry) for entry in read["models"]]
        for model in models:
            if not (root / FOLDER / model.file).exists():
                raise BenchmarkError(f"{file} names {model.file}, which {FOLDER} does not have.")
            unknown = [size for size in model.sizes if size not in self.sizes]
            if unknown:
                raise BenchmarkError(f"{file} has no size {unknown[0]}, which \"{model.name}\" names.")
        self.models = [model for model in models if re.search(pattern or "", model.name)]
        if not self.models:
            raise BenchmarkError(f"no model of {file} has \"{pattern}\" in its name; there are "
                                 + ", ".join(model.name for model in models) + ".")

    def error(self, results):
        """The root mean square of the relative errors of what the reference names."""
        missing = [name for name in self.reference if name not in results]
        if missing:
            raise BenchmarkError(f"a run has no result {missing[0]}.")
        return math.sqrt(sum((results[name] / value - 1) ** 2 for name, value in self.reference.items())
                         / len(self.reference))

    def settings_of(self, model, size):
        return [*self.sizes[size], *model.settings, *self.settings]

    def runs(self, ranks):
        """(model, size, ranks) of a round."""
        for model in self.models:
            for size in model.sizes:
                yield model, size, 1
                if ranks > 1 and size == model.two_ranks:
                    yield model, size, 2


def mark_front(rows, least):
    """Sets `on_front` of the rows of one rank that no faster one equals. Errors up to the least one are the same."""
    best = math.inf
    for row in sorted(rows, key=lambda row: (row["seconds"], row["error"])):
        row["on_front"] = row["ranks"] == 1 and max(row["error"], least) < best
        if row["on_front"]:
            best = max(row["error"], least)


def seconds_to(rows, level):
    """{model: seconds of the fastest mesh whose error is at most so large on one rank, or None}"""
    return {model: min((row["seconds"] for row in rows if row["model"] == model and row["ranks"] == 1
                        and row["error"] <= level), default=None)
            for model in dict.fromkeys(row["model"] for row in rows)}


def measure_solutions(program, root, rounds, pattern=None):
    """All runs in turn, round after round; a row for each."""
    problem = Problem(root, pattern)
    rows = {}
    for one in range(rounds):
        for model, size, ranks in problem.runs(available_cores()):
            settings = problem.settings_of(model, size)
            run, seconds = user_seconds(lambda: program.run(FOLDER / model.file, settings, ranks))
            row = rows.setdefault((model.name, size, ranks), {
                "model": model.name, "size": size, "ranks": ranks, "nodes": run.summary["nodes"],
                "steps": run.steps(), "error": problem.error(run.summary["results"]), "rounds": [],
                "results": {name: run.summary["results"][name] for name in problem.reference}})
            row["rounds"].append(seconds / ranks)
        print(f"round {one + 1} of {rounds}", flush=True)
    for row in rows.values():
        row["seconds"] = median(row["rounds"])
    mark_front(rows.values(), problem.levels[-1])
    return {"title": problem.title, "levels": problem.levels, "rows": list(rows.values())}


def print_solutions(solutions):
    print_table(f"{solutions['title']}: error over user time a rank, medians of rounds; * on the front of one rank",
                ["model", "size", "ranks", "nodes", "steps", "L, D, W [mm]", "error", "seconds", "rounds", ""],
                [[row["model"], row["size"], row["ranks"], f"{row['nodes']:,}", f"{row['steps']:,}",
                  ", ".join(f"{1e3 * value:.2f}" for value in row["results"].values()),
                  f"{100 * row['error']:.2f} %", number(row["seconds"]),
                  f"{number(min(row['rounds']))} to {number(max(row['rounds']))}", "*" if row["on_front"] else ""]
                 for row in solutions["rows"]])
    columns = [seconds_to(solutions["rows"], level) for level in solutions["levels"]]
    print_table("Seconds of the fastest mesh within an error",
                ["model", *(f"{100 * level:g} %" for level in solutions["levels"])],
                [[model, *(number(column[model]) or "-" for column in columns)] for model in columns[0]])
