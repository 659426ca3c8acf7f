# SPDX-License-Identifier: LGPL-2.1-or-later
"""scripts/fuzz --relations N: runs random scenes and related ones, and reports where they differ."""

import collections
import json
import os
import random
import shutil
import tempfile
import time

import loaded  # tests/loaded

from . import related_scenes, relations, scene_runs


def chosen(options, number):
    """The relations of a scene that are looked at."""
    scene = related_scenes.drawn(number)
    kinds = list(relations.KINDS) if options.kinds is None else [kind.strip() for kind in options.kinds.split(",")]
    found = [relations.relation_of(scene, kind, number) for kind in kinds]
    found = [relation for relation in found if relation is not None]
    if options.kinds is None:
        random.Random("relations %d" % number).shuffle(found)
        found = found[:options.each]
    return scene, found


def keep(options, judge, number, result):
    """Leaves the files of both scenes, and the command that repeats them."""
    target = os.path.join(options.keep, "relation_%d_%s" % (number, result.relation.kind.replace(" ", "_")))
    shutil.rmtree(target, True)
    for name, relation in (("first", None), ("other", result.relation)):
        os.makedirs(os.path.join(target, name))
        for file_name, content in judge.files_of(result.scene, relation).items():
            with open(os.path.join(target, name, file_name), "wb") as file:
                file.write(content)
    with open(os.path.join(target, "scene.json"), "w", encoding="utf-8") as file:
        json.dump(dict(result.scene, problem=result.problem.text), file, indent=1)
    with open(os.path.join(target, "command.txt"), "w", encoding="utf-8") as file:
        file.write("# %s\nscripts/fuzz --relations 1 --first %d --kinds \"%s\"\n" % (
            result.problem.text, number, result.relation.kind))
    return target


def judged(options, judge, number, print_line):
    """The results of the relations of a scene."""
    results = []
    scene, found = chosen(options, number)
    for relation in found:
        result = judge.related(scene, relation)
        results.append(result)
        if result.problem is None:
            continue
        print_line("FAILED  scene %d, %s" % (number, result.problem.text))
        if options.shrink and result.problem.kind == relation.kind:
            smaller, other, problem = relations.shrunk(judge, scene, relation, result.problem, number,
                                                       print_line=print_line)
            result = result._replace(scene=smaller, relation=other, problem=problem)
        print_line("  kept in " + keep(options, judge, number, result))
    return results


def main(options):
    if options.print:
        for number in range(options.first, options.first + options.relations):
            scene, found = chosen(options, number)
            for name, content in [file for relation in [None] + found for file in relations.Judge.files_of(
                    scene, relation).items() if file[0] == "case.prm"]:
                print("# scene %d\n%s" % (number, content.decode()))
        return 0
    begin = time.monotonic()
    loaded.start_of(options.program)
    directory = tempfile.mkdtemp(prefix="tombolo_relations_")
    judge = relations.Judge(options.program, directory, options.mpiexec, scene_runs.PATIENCE * options.limits)
    results = []
    try:
        for number in range(options.first, options.first + options.relations):
            results += judged(options, judge, number, lambda text: print(text, flush=True))
    finally:
        shutil.rmtree(directory, True)
    print(table(results))
    for reason, n in collections.Counter(r.reason for r in results if r.kind in ("stopped", "refused")).most_common():
        print("%4d %s" % (n, reason))
    print("%d relations of %d scenes, %.0f s" % (len(results), options.relations, time.monotonic() - begin))
    return 1 if any(result.problem is not None for result in results) else 0


def table(results):
    """Of each kind of relation how many hold, and by how much they are off at most where chance does not decide."""
    rows = [("relation", "run", "stopped", "refused", "failed", "largest difference", "amplified")]
    for kind in relations.KINDS:
        own = [result for result in results if result.relation.kind == kind]
        counts = collections.Counter(result.kind for result in own)
        amplified = [r for r in own if r.problem is None and "growth" in r.figures]
        plain = [r.figures[kind] for r in own if r.problem is None and kind in r.figures and "growth" not in r.figures]
        rows.append((kind, *(str(counts[name]) for name in ("run", "stopped", "refused", "failed")),
                     "%.1g" % max(plain, default=0.), str(len(amplified))))
    widths = (-15, 10, 10, 10, 10, 20, 10)
    return "\n".join("".join("%*s" % pair for pair in zip(widths, row)) for row in rows)
