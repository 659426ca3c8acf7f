# SPDX-License-Identifier: LGPL-2.1-or-later
"""The shipped parameter files, cut short, against the elements of the same scene."""

import json
import re
from dataclasses import dataclass, field
from pathlib import Path

from .runs import BenchmarkError, median
from .tables import number, print_table

SETTINGS = Path("benchmarks/whole_runs.json")
REFERENCE = Path("benchmarks/whole_runs_reference.json")
FOLDER = Path("parameter_files")
MARK_FROM = 1.25  # times the committed ratio


@dataclass
class Scene:
    """Models of one scene, that of elements first."""
    name: str
    files: list
    settings: list = field(default_factory=list)     # for all of its files
    settings_of: dict = field(default_factory=dict)  # for one of them
    steps: int = 0  # none: to the end of the file
    published: dict = field(default_factory=dict)    # ratios of wall times elsewhere, by file


def is_run(file):
    """Whether a parameter file is a whole run: no study, and nothing for others to include."""
    text = file.read_text("utf-8")
    return "set Output directory" in text and not any(
        f"set {entry}" in text for entry in ("Base file", "Groups"))


def read_scenes(root):
    scenes = [Scene(**entry) for entry in json.loads((root / SETTINGS).read_text("utf-8"))]
    named = {file for scene in scenes for file in scene.files}
    shipped = {str(file.relative_to(root / FOLDER))
               for file in (root / FOLDER).glob("*/*.prm") if is_run(file)}
    if named != shipped:
        raise BenchmarkError(f"{SETTINGS} and {FOLDER} differ in "
                             f"{', '.join(sorted(named ^ shipped))}.")
    return scenes


def measure_scene(program, scene, rounds):
    """{file: row}, with ratios to the elements of the same round."""
    settings = {}
    for file in scene.files:
        settings[file] = scene.settings + scene.settings_of.get(file, [])
        if scene.steps:
            step, _ = program.first_step(FOLDER / file, settings[file])
            settings[file] = settings[file] + [f"End time = {step * scene.steps}"]
    summaries = {file: [] for file in scene.files}
    for _ in range(rounds):
        for file in scene.files:
            summaries[file].append(program.run(FOLDER / file, settings[file]).summary)
    rows = {}
    elements = summaries[scene.files[0]]
    for file, of_rounds in summaries.items():
        def ratio(name):
            return median([mine[name] / other[name] for mine, other in zip(of_rounds, elements)])
        last = of_rounds[-1]
        rows[file] = {
            "scene": scene.name, "nodes": last["nodes"], "steps": last["steps"],
            "seconds": median([one["step_seconds"] for one in of_rounds]),
            "ns_per_node_step": median([one["ns_per_node_step"] for one in of_rounds]),
            "ratio": ratio("ns_per_node_step"), "ratio_of_seconds": ratio("step_seconds"),
            "seconds_per_phase": {
                phase: median([one["seconds_per_phase"][phase] for one in of_rounds])
                for phase in last["seconds_per_phase"]},
        }
        if file in scene.published:
            rows[file]["published_ratio_of_seconds"] = scene.published[file]
    return rows


def measure_files(program, root, rounds, pattern=None):
    """Of the scenes whose name has the pattern; of all without one."""
    scenes = [scene for scene in read_scenes(root) if re.search(pattern or "", scene.name)]
    if not scenes:
        raise BenchmarkError(f"no scene of {SETTINGS} has \"{pattern}\" in its name.")
    committed = (json.loads((root / REFERENCE).read_text("utf-8"))
                 if (root / REFERENCE).exists() else {})
    rows = {}
    for scene in scenes:
        rows.update(measure_scene(program, scene, rounds))
    for file, row in rows.items():
        row["committed_ratio"] = committed.get(file)
        row["is_slower"] = (row["committed_ratio"] is not None
                            and row["ratio"] >= MARK_FROM * row["committed_ratio"])
    return rows


def write_reference(rows, root):
    reference = root / REFERENCE
    earlier = json.loads(reference.read_text("utf-8")) if reference.exists() else {}
    measured = {file: round(row["ratio"], 3) for file, row in rows.items()}
    ratios = {file: measured.get(file, earlier.get(file))
              for scene in read_scenes(root) for file in scene.files
              if file in measured or file in earlier}
    reference.write_text(json.dumps(ratios, indent=2) + "\n", encoding="utf-8")


def print_files(rows):
    table = [[file, f"{row['nodes']:,}", row["steps"], number(row["seconds"]),
              number(row["ns_per_node_step"]), f"{row['ratio']:.2f}",
              "" if row["committed_ratio"] is None else f"{row['committed_ratio']:.2f}",
              "SLOWER" if row["is_slower"] else "", f"{row['ratio_of_seconds']:.2f}",
              row.get("published_ratio_of_seconds", "")]
             for file, row in rows.items()]
    print_table(f"Parameter files, one core; ratios to the elements of the same scene, marked from "
                f"{MARK_FROM} times the committed one",
                ["file", "nodes", "steps", "seconds", "ns/node-step", "ratio", "committed", "mark",
                 "ratio of seconds", "published"], table)
    phases = []
    for row in rows.values():
        phases += [phase for phase in row["seconds_per_phase"] if phase not in phases]
    print_table("Phases, nanoseconds a node-step", ["file", *phases],
                [[file, *(number(1e9 * row["seconds_per_phase"].get(phase, 0)
                                 / (row["steps"] * row["nodes"])) for phase in phases)]
                 for file, row in rows.items()])
