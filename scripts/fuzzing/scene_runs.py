# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs scenes (scenes.py) on one and on several ranks, again from a checkpoint, and judges the runs.

A scene fails by a run that hangs, crashes, is refused or stops without a word, leaves what cannot be
read or is not finite, makes energy or momentum; by ranks that differ; by a resumed run that is not the
first one bit by bit.

Ranks sum in another order, and a motion that is not stable makes anything of it. So where ranks differ
by more than `SAME_ON_RANKS`, both are run with one given step, and the motion is run twice more with
velocities and temperatures changed by `PERTURBATION` of the scene's: ranks may differ `GROWTH` times as much as those,
and where these differ by more than `CHAOS`, chance decides and nothing is compared.
"""

import collections
import glob
import json
import math
import os
import re
import shutil
import subprocess
import time

import loaded  # tests/loaded
import run_case  # tests/regression
from tombolo.table import Table

from . import judge, scene_files, scenes, server

# What is wrong: a word for the class of the failure, and a sentence.
Problem = collections.namedtuple("Problem", "kind text")
# kind: "run", "stopped", "refused" or "failed"; figures: what was measured, by name.
Result = collections.namedtuple("Result", "scene kind reason problem figures seconds")

LARGEST_ENERGY_ERROR = 0.05
LARGEST_MOMENTUM_DRIFT = 1e-9
LARGEST_HEAT_ERROR = 1e-6
LARGEST_TEMPERATURE = 1e6  # scenes are between 100 and 1000, and plastic heat makes tens of thousands
SAME_ON_RANKS = 1e-10
SAME_WITH_ROUNDED_ROWS = 1e-7  # a coefficient between two floats is rounded either way
# The least pressure beside which others count, over that of a strain of one: round-off of positions, or of rows.
LEAST_PRESSURE = 1e-10
LEAST_WITH_ROUNDED_ROWS = 1e-2
SAME_STEP = 0.05
PERTURBATION = 1e-13
GROWTH = 100.
CHAOS = 1e-4
PATIENCE = 60.  # seconds until a run hangs
START_CODES = range(121, 128)  # codes of tests/loaded/start_loaded.c

# Entries of a summary on the machine and the time.
PROCESS_ENTRIES = re.compile("statics|wall_seconds|step_(processor_)?seconds|seconds_per_phase|ns_per_.*|peak_memory_bytes|rank_balance|"
                             "resumed_from_step|earlier_wall_seconds")
# Columns that are errors, or shares of what may be next to nothing.
SHARES = ("energy error", "momentum drift", "angular momentum drift", "heat balance error", "lattice mode share",
          "kinetic over internal energy")


class Run:
    """How a run ended, and what it left in a directory."""

    def __init__(self, directory, code, printed):
        self.directory = directory
        self.code = code  # None where it hangs
        self.printed = printed

    def output(self, *names):
        return os.path.join(self.directory, "output", *names)

    def reason(self):
        """Why it stopped or was refused, without numbers."""
        found = re.findall(r"(?:The run stopped|Error): ([^\n]*)", self.printed)
        text = re.sub(r"case\.prm:\d+: ", "", found[0]) if found else ""
        text = re.sub(r"(Part|Condition|Contact): [^/\"]*", r"\1", re.sub(r" = \"[^\"]*\"", "", text))
        return re.sub(r"[-+]?\b\d[\d.e+-]*", "#", text)[:110]

    def table(self, name="statistics.csv"):
        """The columns of a table by name, each its unit and its values."""
        table = Table(self.output(name), arrays=False)
        return {column: (table.units[column] or "1", table[column]) for column in table}

    def impulses(self):
        """The impulses of each condition and contact, whose sum may be next to nothing."""
        tables = [self.table(name) for name in ("conditions.csv", "contact.csv") if os.path.exists(self.output(name))]
        return [value for table in tables for name, (_, values) in table.items() if re.search(" impulse [xyz]$", name)
                for value in values]

    def results(self):
        """What a resumed run must have bit by bit, by name."""
        results = {}
        for name in [*glob.glob(self.output("*.csv")), *glob.glob(self.output("*.pvd")),
                     *glob.glob(self.output("solution", "*"))]:
            with open(name, "rb") as file:
                results[os.path.relpath(name, self.output())] = file.read()
        with open(self.output("summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        results["summary.json"] = {key: value for key, value in summary.items() if not PROCESS_ENTRIES.fullmatch(key)}
        return results


class Judge:
    """Runs scenes of a program below a directory."""

    def __init__(self, program, directory, mpiexec="mpirun", patience=PATIENCE):
        self.program = program
        self.mpiexec = mpiexec
        self.directory = directory
        self.patience = patience
        self.mpi_directory = os.path.join(directory, "mpi")  # what it leaves lying about while it runs
        os.makedirs(self.mpi_directory, exist_ok=True)

    def run(self, name, scene, ranks=1, options=(), **changes):
        """Runs a scene in a directory of this name; where options are given, on what is there."""
        return self.run_files(name, scene_files.files_of(scene, **changes), ranks, options)

    def run_files(self, name, files, ranks=1, options=()):
        directory = os.path.join(self.directory, name)
        if not options:
            shutil.rmtree(directory, True)
            os.makedirs(directory)
        for file_name, content in files.items():
            with open(os.path.join(directory, file_name), "wb") as file:
                file.write(content)
        launcher = [self.mpiexec, "-n", str(ranks)] if ranks > 1 else []
        environment = dict(loaded.environment(ranks), OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                           OMPI_MCA_rmaps_base_oversubscribe="1", PRTE_MCA_rmaps_default_mapping_policy=":oversubscribe", OMPI_MCA_hwloc_base_binding_policy="none",
                           OMPI_MCA_mpi_yield_when_idle="1", OMP_NUM_THREADS="1", DEAL_II_NUM_THREADS="1",
                           TMPDIR=self.mpi_directory)
        printed_name = os.path.join(self.directory, name + ".txt")
        with open(printed_name, "wb") as printed:
            process = subprocess.Popen(launcher + loaded.start_of(self.program) + list(options) + ["case.prm"],
                                       cwd=directory, stdin=subprocess.DEVNULL, stdout=printed,
                                       stderr=subprocess.STDOUT, env=environment)
            code = ended(process, self.patience)
        if code in START_CODES:
            raise RuntimeError("the process that has %s loaded has ended" % self.program)
        with open(printed_name, "rb") as printed:
            return Run(directory, code, printed.read().decode(errors="replace"))

    def judged(self, scene):
        """The result of a scene."""
        begin = time.monotonic()
        figures = {}
        first = self.run("one", scene)
        problem, kind = problem_of_run(first, scene, figures)
        last, ranks = first, 1
        if problem is None and scene["ranks"] > 1:
            ranks = scene["ranks"]
            several = self.run("all", scene, ranks)
            problem, _ = problem_of_run(several, scene, {})
            if problem is not None:
                problem = Problem(problem.kind, "on %d ranks %s" % (ranks, problem.text))
            else:
                problem = self.problem_of_ranks(scene, first, several, figures)
            if scene["resumed on"] == "all":
                last = several
        if problem is None and last.code != 1:
            problem = self.problem_of_resumption(scene_files.files_of(scene), last, ranks if last is not first else 1,
                                                 figures)
        return Result(scene, "failed" if problem else kind, first.reason(), problem, figures, time.monotonic() - begin)

    def problem_of_ranks(self, scene, first, several, figures):
        if 1 in (first.code, several.code):
            return None if first.code == several.code else Problem("ranks", "one rank ends with %d, %d with %d" % (
                first.code, scene["ranks"], several.code))
        steps = [run.table()["time step"][1][0] for run in (first, several)]
        if abs(steps[1] - steps[0]) > SAME_STEP * steps[0]:
            return Problem("ranks", "the first step is %g on one rank and %g on %d" % (*steps, scene["ranks"]))
        difference, column = difference_of(scene, first, several)
        figures["ranks"] = difference
        same = SAME_WITH_ROUNDED_ROWS if scene["rounded rows"] else SAME_ON_RANKS
        if difference <= same:
            return None
        fixed = 0.9 * min(min(run.table()["time step"][1]) for run in (first, several))
        runs = [self.run("one fixed", scene, fixed_step=fixed),
                self.run("all fixed", scene, scene["ranks"], fixed_step=fixed)]
        if None in (runs[0].code, runs[1].code):
            return Problem("hang", "with a given step it hangs")
        difference, column = difference_of(scene, *runs)
        figures["ranks"] = difference
        if difference <= same:
            return None
        growth = 0.
        for phase in (0.4, 1.9):
            twin = self.run("twin", scene, fixed_step=fixed, perturbation=(PERTURBATION, phase))
            growth = max(growth, difference_of(scene, runs[0], twin)[0])
        figures["growth"] = growth
        if growth > CHAOS or difference <= GROWTH * growth:
            return None
        return Problem("ranks", "%d ranks differ from one by %.2g in \"%s\", where a change of the start by %g makes "
                       "%.2g" % (scene["ranks"], difference, column, PERTURBATION, growth))

    def problem_of_resumption(self, files, run, ranks, figures):
        """Continues from a checkpoint in the middle of a run of these files."""
        checkpoints = sorted(glob.glob(run.output("checkpoint", "step_*.h5")))[:-1]
        if not checkpoints:
            return None
        expected = run.results()
        chosen = os.path.relpath(checkpoints[len(checkpoints) // 2], run.directory)
        figures["resumed"] = 1
        resumed = self.run_files(os.path.basename(run.directory), files, ranks, ["--resume=" + chosen])
        if resumed.code != run.code:
            return Problem("resume" if resumed.code is not None else "hang",
                           "resumed from %s it ends with %s instead of %s" % (chosen, resumed.code, run.code))
        found = resumed.results()
        for name in sorted(set(expected) | set(found)):
            if expected.get(name) != found.get(name):
                return Problem("resume", "resumed from %s it has another %s%s" % (chosen, name, first_difference(
                    expected.get(name), found.get(name))))
        return None


def ended(process, patience):
    """The exit code of a process, or None where it hangs; that one is ended."""
    try:
        return process.wait(patience)
    except subprocess.TimeoutExpired:
        process.terminate()  # mpirun ends its ranks
        try:
            process.wait(20.)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        return None


def first_difference(expected, found):
    if isinstance(expected, dict) and isinstance(found, dict):
        keys = [key for key in {**expected, **found} if expected.get(key) != found.get(key)]
        return ": %s is %s, not %s" % (keys[0], found.get(keys[0]), expected.get(keys[0]))
    if isinstance(expected, bytes) and isinstance(found, bytes) and b"," in expected:
        for i, pair in enumerate(zip(expected.split(b"\n"), found.split(b"\n"))):
            for name, *values in zip(expected.split(b"\n")[0].split(b","), *(line.split(b",") for line in pair)):
                if values[0] != values[1]:
                    return ": row %d, %s is %s, not %s" % (i, name.decode(), values[1].decode(), values[0].decode())
    return ""


def problem_of_run(run, scene, figures):
    """What is wrong with a run by itself, or None, and what it did."""
    files = scene_files.files_of(scene)
    ending = server.Ending(run.code if run.code is not None else 0, "hang" if run.code is None else None, 0.)
    text, kind = judge.problem_of(ending, run.printed, run.directory, files)
    if text is not None:
        return Problem(class_of(run, text), text), kind
    if run.code == 1:
        return None, "refused"
    kind = "run" if run.code == 0 else "stopped"
    problem = problem_of_pictures(run) or problem_of_balances(run, scene, figures)
    return problem, kind


def class_of(run, text):
    if run.code is None:
        return "hang"
    if run.code < 0 or run.code > 2 or "it prints '" in text:
        return "crash"
    return "refusal" if run.code == 1 else "output"


def problem_of_pictures(run):
    """A field is not a number at the points of those parts that do not have it."""
    for path in sorted(glob.glob(run.output("solution", "*.vtu"))):
        fields = {field.get("Name"): run_case.compressed_array(field)
                  for field in judge.ElementTree.parse(path).getroot().iter("DataArray")
                  if field.get("format") == "binary" and (field.text or "").strip()}
        parts = fields.get("part", [])
        for name, values in fields.items():
            is_finite = [all(map(math.isfinite, value)) for value in values]
            if len(values) != len(parts):
                is_whole = all(is_finite)
            else:
                is_whole = all(len(kinds) == 1 for kinds in kinds_by_part(parts, is_finite).values())
            if not is_whole:
                return Problem("output", "\"%s\" in %s is not finite" % (name, os.path.basename(path)))
    return None


def kinds_by_part(parts, kinds):
    result = collections.defaultdict(set)
    for part, kind in zip(parts, kinds):
        result[part].add(kind)
    return result


def largest(values):
    return max((abs(value) for value in values if not math.isnan(value)), default=0.)


def problem_of_balances(run, scene, figures):
    """Energy, momentum and heat of a run that ended by itself. A run that stops has printed why."""
    table = run.table()
    _, energy_scale, momentum_scale, _ = scales_of(scene, table)
    if run.code == 0:
        figures["energy"] = 0.
        for error, total in zip(table["energy error"][1], table["total energy"][1]):
            # Round-off of a body at rest is no error.
            if abs(total) > 1e-20 * energy_scale:
                figures["energy"] = max(figures["energy"], abs(error))
        if figures["energy"] > LARGEST_ENERGY_ERROR:
            return Problem("energy", "the energy error is %.3g, and the run goes on" % figures["energy"])
        if largest(table["largest speed"][1]) * scale_of_mass(scene) > 1e-10 * momentum_scale:
            figures["momentum"] = largest(table["momentum drift"][1])
            if figures["momentum"] > LARGEST_MOMENTUM_DRIFT:
                return Problem("momentum", "the momentum drift is %.3g" % figures["momentum"])
        if "heat balance error" in table:
            figures["heat"] = largest(table["heat balance error"][1])
            if figures["heat"] > LARGEST_HEAT_ERROR:
                return Problem("heat", "the error of the heat balance is %.3g" % figures["heat"])
            hottest = max(largest(table[name + " nodal temperature"][1]) for name in ("smallest", "largest"))
            if hottest > LARGEST_TEMPERATURE:
                return Problem("heat", "a temperature is %.3g, and the run goes on" % hottest)
    return None


def scale_of_mass(scene):
    writer = scene_files.Writer(scene)
    return float(writer.number(math.prod(writer.extents()), writer.dim - 3, 1))


def scales_of(scene, table):
    """Of lengths, and the least energy, momentum and pressure beside which others count: those of waves
    with a strain of one."""
    writer = scene_files.Writer(scene)
    volume = math.prod(writer.extents())
    reach = max(map(abs, writer.lower + writer.upper))
    return (float(writer.length(reach)), float(writer.number(volume, writer.dim - 1, 1, -2)),
            float(writer.number(volume, writer.dim - 2, 1, -1)), float(writer.pressure(1.)))


def difference_of(scene, first, second):
    """The largest difference of two runs in statistics.csv, each column over its scale, and its column."""
    if first.code != second.code:
        return math.inf, "exit code"
    one, other = first.table(), second.table()
    if list(one) != list(other):
        return math.inf, "columns"
    reach, energy, momentum, pressure = scales_of(scene, one)
    both = {name: one[name][1] + other[name][1] for name in one}
    energies = max([largest(both[name]) for name in one if one[name][0] == "M L^2/T^2"] + [1e-16 * energy])
    speed = largest(both["largest speed"])
    momenta = max(largest(both["kinetic energy"]) / speed if speed > 0. else 0., 1e-10 * momentum,
                  largest(first.impulses() + second.impulses()),
                  *(largest(both[name]) for name in one if one[name][0] == "M L/T"))
    result = 0., "none"
    for name, (unit, values) in one.items():
        if name in SHARES or name.startswith("relative error"):
            continue
        if len(values) != len(other[name][1]):
            return math.inf, "rows"
        own = largest(both[name])
        scale = {"M L^2/T^2": energies, "M L/T": momenta, "M L^2/T": reach * momenta,
                 "M/(L T^2)": max(own, (LEAST_WITH_ROUNDED_ROWS if scene["rounded rows"] else LEAST_PRESSURE) * pressure),
                 "L/T": max(own, 1e-10 * momentum / scale_of_mass(scene))}.get(unit, own)
        for a, b in zip(values, other[name][1]):
            if abs(a - b) > result[0] * scale:
                result = abs(a - b) / scale, name
    return result


def inputs_of(scene):
    """All that runs depend on."""
    return scene_files.files_of(scene), scene["ranks"], scene["ranks"] > 1 and scene["resumed on"]


def shrunk(judge_of_scenes, scene, problem, tries=200, print_line=None):
    """The simplest scene found that fails in the same way, and how."""
    patience, judge_of_scenes.patience = judge_of_scenes.patience, min(judge_of_scenes.patience, 15.)
    position = n_in_vain = 0
    while tries > 0:
        candidates = list(scenes.simpler(scene))
        if n_in_vain >= len(candidates):
            break
        position %= len(candidates)
        if inputs_of(candidates[position]) == inputs_of(scene):
            scene = candidates[position]
            continue
        result = judge_of_scenes.judged(candidates[position])
        tries -= 1
        n_in_vain += 1
        if result.problem is not None and result.problem.kind == problem.kind:
            scene, problem, n_in_vain = candidates[position], result.problem, 0
            if print_line is not None:
                print_line("  simpler: %s" % problem.text)
        else:
            position += 1
    judge_of_scenes.patience = patience
    return scene, problem
