# SPDX-License-Identifier: LGPL-2.1-or-later
"""Whole runs of shipped scenes: where their time goes, what they allocate, what two ranks gain."""

import json
import re
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from .runs import BenchmarkError, available_cores, median
from .tables import number, print_table

SETTINGS = Path("benchmarks/whole_runs.json")
FOLDER = Path("parameter_files")
SHOWN_FROM = 0.02  # of the time of a run, for a phase to have a number


@dataclass
class Scene:
    """A parameter file that is run to a time of its own, or to its end."""
    name: str
    file: str
    end: float = None
    settings: list = field(default_factory=list)

    def run_to(self, share):
        """Settings of a run to this share of its time."""
        return ["Output/Write solution = false", *self.settings, *([f"End time = {share * self.end:g}"] if self.end else [])]


def read_scenes(root, pattern):
    scenes = [Scene(**entry) for entry in json.loads((root / SETTINGS).read_text("utf-8"))]
    missing = [scene.file for scene in scenes if not (root / FOLDER / scene.file).exists()]
    if missing:
        raise BenchmarkError(f"{SETTINGS} names {', '.join(missing)}, which {FOLDER} does not have.")
    chosen = [scene for scene in scenes if re.search(pattern or "", scene.name)]
    if not chosen:
        raise BenchmarkError(f"no scene of {SETTINGS} has \"{pattern}\" in its name; there are "
                             + ", ".join(scene.name for scene in scenes) + ".")
    return chosen


def allocations_per_step(program, scene, counter):
    """Of one rank, by runs to half of the time and to all of it; none of a scene without a time."""
    if scene.end is None or not counter.exists():
        return None
    counts = []
    for share in (0.5, 1):
        with tempfile.TemporaryDirectory() as directory:
            prefix = ["env", f"LD_PRELOAD={counter}", f"TOMBOLO_ALLOCATIONS={directory}/count"]
            process = program.start(FOLDER / scene.file, scene.run_to(share), directory, prefix=prefix)
            run = program.finish(process, directory)
            text = (Path(directory) / f"count.{process.pid}").read_text("utf-8")
            counts.append((int(text), run.steps()))
    (half, steps_of_half), (whole, steps) = counts
    return (whole - half) / (steps - steps_of_half) if steps > steps_of_half else None


def measure_scene(program, other, scene, counter, rounds):
    """With @p other in turn, if it is given."""
    file, settings = FOLDER / scene.file, scene.run_to(1)
    mine, others, together, copies = [], [], [], []
    for _ in range(rounds):
        mine.append(program.run(file, settings).summary)
        if other:
            others.append(other.run(file, settings).summary)
        if available_cores() > 1:
            together.append(program.run(file, settings, ranks=2).summary["step_seconds"])
            copies.append(median([run.summary["step_seconds"]
                                  for run in program.run_copies(file, settings, 2)]))
    seconds = median([one["step_seconds"] for one in mine])
    phases = {name: median([one["seconds_per_phase"].get(name, 0) for one in mine]) / seconds
              for name in mine[-1]["seconds_per_phase"]}
    return {
        "nodes": mine[-1]["nodes"], "steps": mine[-1]["steps"], "seconds": seconds,
        "ns_per_node_step": median([one["ns_per_node_step"] for one in mine]),
        "over_other": median([one["step_seconds"] / its["step_seconds"]
                              for one, its in zip(mine, others)]) if other else None,
        "allocations_per_step": allocations_per_step(program, scene, counter),
        "efficiency": median([alone / (2 * both) for alone, both in zip(copies, together)])
                      if together else None,
        "share_of_phases": phases,
    }


def measure_whole(program, other, root, rounds, pattern=None):
    """Of the scenes whose name has the pattern; of all without one."""
    counter = root / "build/lib/libcount_allocations.so"
    rows = {}
    for scene in read_scenes(root, pattern):
        row = rows[scene.name] = measure_scene(program, other, scene, counter, rounds)
        print(f"{scene.name}: {number(row['ns_per_node_step'])} ns a node and step", flush=True)
    return rows


def percent(share):
    return "" if share is None else f"{100 * share:.0f} %"


def print_whole(rows):
    compares = any(row["over_other"] is not None for row in rows.values())
    print_table("Whole runs, one core; efficiency of two ranks against two runs side by side",
                ["scene", "nodes", "steps", "seconds", "ns/node-step",
                 *(["over the other program"] if compares else []), "allocations/step", "two ranks"],
                [[name, f"{row['nodes']:,}", f"{row['steps']:,}", number(row["seconds"]),
                  number(row["ns_per_node_step"]),
                  *([f"{row['over_other']:.3f}"] if compares else []),
                  number(row["allocations_per_step"]), percent(row["efficiency"])]
                 for name, row in rows.items()])
    phases = []
    for row in rows.values():
        phases += [phase for phase, share in row["share_of_phases"].items()
                   if share >= SHOWN_FROM and phase not in phases]
    print_table(f"Share of phases, from {percent(SHOWN_FROM)} on", ["scene", *phases],
                [[name, *(percent(share) if share >= SHOWN_FROM else ""
                          for share in (row["share_of_phases"].get(phase, 0) for phase in phases))]
                 for name, row in rows.items()])
