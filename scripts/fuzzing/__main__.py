# SPDX-License-Identifier: LGPL-2.1-or-later
"""usage: scripts/fuzz [options]

Changes valid parameter files and mesh files at random and gives them to the program. Each must be
refused with an understandable message or run with whole results, in time and memory.

  --inputs N       so many inputs (1000)
  --seed N         other inputs (1)
  --only K         only input K of the seed; it is kept even if all is well
  --jobs N         at a time (the number of cores)
  --program FILE   another tombolo
  --seeds N        change so many of the valid files only
  --limits FACTOR  of the limits on time, for a slow program (1)
  --memory BYTES   that an input may take, beyond what the program takes by itself (4e8)
  --keep DIR       where failing inputs are kept, each with the command that repeats it
                   (fuzz_failures)
  --report         the table in Markdown

With --scenes: random scenes instead, each a function of its number, run on one and on several ranks and
again from a checkpoint.

  --scenes N       so many scenes
  --first SEED     from this number on (1)
  --print          print the parameter files instead of running them
  --shrink         look for the simplest scene that fails in the same way
  --refused SHARE  fail if more than this share of the scenes is refused (0.1)
  --mpiexec FILE   what starts several ranks (mpirun)

as above --program, --jobs (1), --limits, --keep, --report.

With --relations: random scenes and related ones, whose numbers must agree.

  --relations N    of so many scenes, one after the other
  --first SEED     from this number on (1)
  --each N         so many relations of each scene, drawn at random (4)
  --kinds KINDS    instead all relations of these kinds, separated by commas: axes, units, decimal units,
                   moved, flight, numbering, whole, source, ranks, resume
  --print, --shrink, --mpiexec, --program, --limits, --keep as above
"""

import argparse
import collections
import json
import multiprocessing
import os
import random
import re
import shutil
import sys
import tempfile
import time

PROJECT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [os.path.join(PROJECT, "tests", name) for name in ("loaded", "regression", "program")]

from . import judge, mutations, relation_main, scene_main, seeds, server  # noqa: E402

Result = collections.namedtuple("Result", "number seed kind stopped problem seconds")


def write_files(directory, files):
    """Makes the directory anew, with these files by name."""
    shutil.rmtree(directory, True)
    for name, text in files.items():
        path = os.path.join(directory, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "wb") as file:
            file.write(text)


class Worker:
    """Runs inputs one after the other, each in a directory of its own."""

    def __init__(self, options):
        self.options = options
        self.limits = server.Limits(options.limits, int(options.memory))
        self.directory = tempfile.mkdtemp(prefix="tombolo_fuzz_")
        self.server = server.ForkServer(options.program, options.library, self.directory)

    def close(self):
        self.server.close()
        shutil.rmtree(self.directory, True)

    def write(self, files):
        # Files that an input includes from two directories above stay below that of the worker.
        case = os.path.join(self.directory, "tests", "inputs", "case")
        write_files(case, files)
        return case

    def run(self, seed, files, options):
        """How a run of the files ended, what it printed and where it ran."""
        case = self.write(files)
        printed = os.path.join(self.directory, "printed.txt")

        def steps_on():
            return any(os.path.basename(path) == "log.txt" for path in judge.walk(case))
        ending = self.server.run(case, printed, options + [seed.main], self.limits, steps_on)
        with open(printed, "rb") as file:
            return ending, file.read().decode(errors="replace"), case

    def reduce(self, seed):
        """Makes a seed small. Returns what is wrong with it then, or None."""
        if seed.mesh is None:
            def n_steps(files):
                printed = self.run(seed, files, ["--dry-run"])[1]
                found = re.findall(r"(?:about|at least) ([\d.e+]+) steps", printed)
                return float(found[0]) if found else None
            seed.files = seeds.reduced(seed.files, n_steps)
        ending, problem, _, printed = self.check(seed, seed.files)
        if problem is None and ending.code == 0:
            return None
        return "reduced, it does not run: %s\n%s" % (problem or ending, printed)

    def vocabulary(self, seed):
        printed = self.run(seed, seed.files, ["--print-parameters=json"])[1]
        entries = []

        def collect(path, section):
            for name, value in section.items():
                if isinstance(value, dict):
                    collect(path + [name], value)
                else:
                    text = str(value).lower() if isinstance(value, bool) else str(value)
                    entries.append(("/".join(path).encode(), name.encode(), text.encode()))
        collect([], json.loads(printed))
        return entries

    def check(self, seed, files):
        ending, printed, case = self.run(seed, files, [])
        problem, kind = judge.problem_of(ending, printed, case, list(files))
        return ending, problem, kind, printed

    def check_validation(self, seed, files, kind):
        """--validate must not refuse what runs, nor leave anything."""
        ending, printed, case = self.run(seed, files, ["--validate"])
        if ending.stopped or ending.code not in (0, 1):
            return "--validate ends with %s" % (ending,), printed
        if kind == "run" and ending.code == 1:
            return "--validate refuses what runs", printed
        if set(os.listdir(case)) != {name.split("/")[0] for name in files if not name.startswith("..")}:
            return "--validate leaves files", printed
        return None, printed


def is_harmless(text):
    """Whether what is written goes below the directory of the input."""
    outputs = re.findall(rb"Output\s+directory\s*=\s*([^\n]*)", text)
    return not any(output.startswith(b"/") or b".." in output or output.endswith(b"\\") for output in outputs)


def changed_files(generator, seed, parameter_changes, mesh_changes):
    """The files of a seed with one of them changed."""
    while True:
        files = dict(seed.files)
        if seed.mesh is not None and generator.random() < 0.9:
            name, changes = seed.mesh, mesh_changes
        else:
            names = sorted(seed.parameter_files())
            sizes = [len(files[name]) + 20 for name in names]
            name, changes = generator.choices(names, sizes)[0], parameter_changes
        for _ in range(generator.choice([1, 1, 1, 2, 3, 5])):
            files[name] = changes.change(generator, files[name])
        if is_harmless(files[name]):
            return files


def keep(options, number, seed, files, problem, printed):
    directory = os.path.join(options.keep, "%d_%d" % (options.seed, number))
    write_files(directory, files)
    with open(os.path.join(directory, "command.txt"), "w", encoding="utf-8") as file:
        file.write("# %s\n# from %s; the whole: scripts/fuzz --seed %d --only %d%s\ncd %s && %s %s\n" % (
            problem, seed.name, options.seed, number, "" if options.seeds is None else " --seeds %d" % options.seeds,
            directory, options.program, seed.main))
    with open(os.path.join(directory, "printed.txt"), "w", encoding="utf-8") as file:
        file.write(printed)


def work(options, all_seeds, vocabulary, numbers, results):
    """A process: takes numbers of inputs until there is none."""
    worker = Worker(options)
    values = sorted({match.group(4) for seed in all_seeds for name in seed.parameter_files()
                     for match in mutations.ENTRY.finditer(seed.files[name])})
    parameter_changes = mutations.ParameterFiles(vocabulary, values)
    mesh_changes = mutations.MeshFiles()
    with_meshes = [seed for seed in all_seeds if seed.mesh is not None]
    others = [seed for seed in all_seeds if seed.mesh is None]
    kinds = [(others, 65), (with_meshes, 27)]
    kinds = [kind for kind in kinds if kind[0]]
    try:
        for number in iter(numbers.get, None):
            generator = random.Random("%d/%d" % (options.seed, number))
            group = generator.choices([kind[0] for kind in kinds], [kind[1] for kind in kinds])[0]
            seed = generator.choice(group)
            files = changed_files(generator, seed, parameter_changes, mesh_changes)
            begin = time.monotonic()
            ending, problem, kind, printed = worker.check(seed, files)
            if problem is None and generator.random() < 0.2:
                problem, validation_text = worker.check_validation(seed, files, kind)
                printed += "" if problem is None else "\n--validate:\n" + validation_text
            if problem is not None or options.only is not None:
                keep(options, number, seed, files, problem, printed)
            results.put(Result(number, seed.name, "failed" if problem else kind, ending.stopped, problem,
                               time.monotonic() - begin))
    finally:
        worker.close()
        results.put(None)


def group_of(name):
    return name.split(" ")[0] if name.startswith("mesh ") else name.split("/")[0]


def table(results, seconds, report):
    rows = [("inputs", "refused", "run", "failed", "seconds"),
            tuple(str(value) for value in (len(results), sum(r.kind == "refused" for r in results),
                                           sum(r.kind == "run" for r in results),
                                           sum(r.kind == "failed" for r in results), "%.0f" % seconds))]
    if report:
        return "| %s |\n|%s\n| %s |" % (" | ".join(rows[0]), "---|" * 5, " | ".join(rows[1]))
    return "\n".join("".join("%10s" % cell for cell in row) for row in rows)


def parse(arguments):
    parser = argparse.ArgumentParser(usage=__doc__, add_help=False)
    parser.add_argument("-h", "--help", action="store_true")
    parser.add_argument("--program", default=os.path.join(PROJECT, "build", "bin", "tombolo"))
    parser.add_argument("--library")
    parser.add_argument("--inputs", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int)
    parser.add_argument("--jobs", type=int)
    parser.add_argument("--seeds", type=int)
    parser.add_argument("--limits", type=float, default=1.)
    parser.add_argument("--memory", type=float, default=4e8)
    parser.add_argument("--keep", default="fuzz_failures")
    parser.add_argument("--report", action="store_true")
    parser.add_argument("--scenes", type=int)
    parser.add_argument("--relations", type=int)
    parser.add_argument("--each", type=int, default=4)
    parser.add_argument("--kinds")
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--print", action="store_true")
    parser.add_argument("--shrink", action="store_true")
    parser.add_argument("--refused", type=float, default=0.1)
    parser.add_argument("--mpiexec", default="mpirun")
    options = parser.parse_args(arguments)
    if options.jobs is None:
        options.jobs = os.cpu_count() if options.scenes is None else 1
    options.program = os.path.abspath(options.program)
    options.keep = os.path.abspath(options.keep)
    if options.library is None:
        options.library = os.path.join(os.path.dirname(os.path.dirname(options.program)), "lib", "libfork_server.so")
    return options


def main(arguments):
    options = parse(arguments)
    if options.help:
        print(__doc__.strip())
        return 0
    if options.relations is not None:
        return relation_main.main(options)
    if options.scenes is not None:
        return scene_main.main(options)
    begin = time.monotonic()
    all_seeds = seeds.collect(PROJECT)
    if options.seeds is not None:
        all_seeds = random.Random(options.seed).sample(all_seeds, min(options.seeds, len(all_seeds)))
    worker = Worker(options)
    vocabulary = set()
    n_wrong = 0
    try:
        for seed in all_seeds:
            problem = worker.reduce(seed)
            if problem is not None:
                n_wrong += 1
                print("The valid file %s: %s" % (seed.name, problem), flush=True)
            else:
                vocabulary.update(worker.vocabulary(seed))
    finally:
        worker.close()
    print("%d valid files, %d entries, %.0f s" % (len(all_seeds) - n_wrong, len(vocabulary),
                                                  time.monotonic() - begin), flush=True)
    if n_wrong > 0:
        return 1

    numbers, results = multiprocessing.Queue(), multiprocessing.Queue()
    for number in range(options.inputs) if options.only is None else [options.only]:
        numbers.put(number)
    processes = [multiprocessing.Process(target=work, args=(options, all_seeds, sorted(vocabulary), numbers, results))
                 for _ in range(options.jobs)]
    for process in processes:
        numbers.put(None)
        process.start()
    collected = []
    n_open = len(processes)
    while n_open > 0:
        result = results.get()
        if result is None:
            n_open -= 1
            continue
        collected.append(result)
        if result.problem is not None:
            print("FAILED  input %d, from %s: %s" % (result.number, result.seed, result.problem), flush=True)
        if len(collected) % 1000 == 0:
            print("%d inputs, %.0f s" % (len(collected), time.monotonic() - begin), flush=True)
    for process in processes:
        process.join()
    print(table(collected, time.monotonic() - begin, options.report))
    wanted = options.inputs if options.only is None else 1
    if len(collected) != wanted:
        print("only %d of %d inputs were tried" % (len(collected), wanted))
    failed = [result for result in collected if result.kind == "failed"]
    if failed:
        print("failing inputs are in " + options.keep)
    return 0 if not failed and len(collected) == wanted else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
