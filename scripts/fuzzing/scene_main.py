# SPDX-License-Identifier: LGPL-2.1-or-later
"""scripts/fuzz --scenes N: runs random scenes and reports what failed."""

import collections
import json
import os
import queue
import shutil
import tempfile
import threading
import time

import loaded  # tests/loaded

from . import scene_files, scene_runs, scenes

NAMES = ("run", "stopped", "refused", "failed")


def keep(options, result, directory):
    """Leaves the files of a failing scene, its features and what was printed."""
    target = os.path.join(options.keep, "scene_%d" % result.scene["seed"])
    shutil.rmtree(target, True)
    os.makedirs(target)
    for name, content in scene_files.files_of(result.scene).items():
        with open(os.path.join(target, name), "wb") as file:
            file.write(content)
    with open(os.path.join(target, "scene.json"), "w", encoding="utf-8") as file:
        json.dump(dict(result.scene, problem=result.problem.text), file, indent=1)
    for name in ("one.txt", "all.txt"):
        if os.path.exists(os.path.join(directory, name)):
            shutil.copy(os.path.join(directory, name), target)


def work(options, numbers, results):
    """Judges scenes until there is no number left."""
    directory = tempfile.mkdtemp(prefix="tombolo_scenes_")
    judge = scene_runs.Judge(options.program, directory, options.mpiexec, scene_runs.PATIENCE * options.limits)
    try:
        while True:
            try:
                number = numbers.get_nowait()
            except queue.Empty:
                return
            result = judge.judged(scenes.drawn(number))
            if result.problem is not None:
                keep(options, result, directory)
                if options.shrink:
                    print("scene %d: %s" % (number, result.problem.text), flush=True)
                    scene, problem = scene_runs.shrunk(judge, result.scene, result.problem,
                                                       print_line=lambda text: print(text, flush=True))
                    result = result._replace(scene=scene, problem=problem)
                    keep(options, result, directory)
            results.append(result)
            report(result)
    finally:
        shutil.rmtree(directory, True)


def report(result):
    if result.problem is not None:
        print("FAILED  scene %d: %s: %s" % (result.scene["seed"], result.problem.kind, result.problem.text), flush=True)


def table(results, seconds, in_markdown):
    counts = collections.Counter(result.kind for result in results)
    rows = [("scenes",) + NAMES + ("seconds",),
            tuple(map(str, [len(results)] + [counts[name] for name in NAMES] + ["%.0f" % seconds]))]
    if in_markdown:
        return "| %s |\n|%s\n| %s |" % (" | ".join(rows[0]), "---|" * len(rows[0]), " | ".join(rows[1]))
    return "\n".join("".join("%10s" % cell for cell in row) for row in rows)


def main(options):
    chosen = range(options.first, options.first + options.scenes)
    if options.print:
        for number in chosen:
            for name, content in scene_files.files_of(scenes.drawn(number)).items():
                print("# %s of scene %d\n%s" % (name, number, content.decode()))
        return 0
    begin = time.monotonic()
    loaded.start_of(options.program)
    numbers, results = queue.Queue(), []
    for number in chosen:
        numbers.put(number)
    threads = [threading.Thread(target=work, args=(options, numbers, results)) for _ in range(options.jobs)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for kind in ("stopped", "refused"):
        for reason, n in collections.Counter(r.reason for r in results if r.kind == kind).most_common():
            print("%4d %s: %s" % (n, kind, reason))
    for name in ("energy", "momentum", "heat", "ranks", "growth"):
        figures = [(result.figures[name], result.scene["seed"]) for result in results if name in result.figures]
        if figures:
            print("%-8s of %d scenes, at most %.2g (scene %d)" % (name, len(figures), *max(figures)))
    print("%-8s %d scenes" % ("resumed", sum("resumed" in result.figures for result in results)))
    print(table(results, time.monotonic() - begin, options.report))
    n_failed = sum(result.problem is not None for result in results)
    n_refused = sum(result.kind == "refused" for result in results)
    if len(results) != options.scenes:
        print("only %d of %d scenes were tried" % (len(results), options.scenes))
    if n_refused > options.refused * options.scenes:
        print("%d of %d scenes are refused" % (n_refused, options.scenes))
    if n_failed > 0:
        print("failing scenes are in " + options.keep)
    is_whole = len(results) == options.scenes and n_refused <= options.refused * options.scenes
    return 0 if n_failed == 0 and is_whole else 1
