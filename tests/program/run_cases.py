#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the program on parameter files with a mistake each and checks its messages.

    run_cases.py PROGRAM MPIEXEC RANKS CASES.json [NAME]

A case is an object:
  name       a sentence
  file       the parameter file of this directory that is changed; rod.prm unless given
  replace    list of [old, new]: changes of that file; each old text must be in it once
  text       the whole parameter file, instead of changes
  files      {name: text}: files that lie beside it
  options    options of the program; --dry-run unless given
  at         a text of one line of the changed file: the message must begin with its line
  says       what the message must contain, each once
  exit       the exit code; 1 unless given
  ranks      rank counts to run on; 1 and 2 unless given
  leaves     names that must be in the output directory afterwards; if not given, there must be none

Nothing may be printed twice or show a stack trace. Before the cases there may be an object {"let":
{name: value}}; "{name}" in a case means this text, or pair of "replace".
"""

import json
import os
import queue
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(os.path.dirname(HERE), "loaded"))
import loaded

NEVER = ("Stacktrace", "Stack trace", "stack trace", "terminate called", "unexpected", "Violated",
         "violated condition", "Exception", "MPI_ABORT", "MPI_Abort", "Signal:", "core dumped")


def run(command, directory, environment=None):
    """Runs a command, which may run as long as the machine makes it; what hangs is ended by the time limit
    of ctest. Returns its exit code and all that it printed."""
    with tempfile.TemporaryFile() as printed:
        process = subprocess.Popen(command, cwd=directory, stdin=subprocess.DEVNULL, stdout=printed,
                                   stderr=subprocess.STDOUT, env=environment)
        code = process.wait()
        printed.seek(0)
        return code, printed.read().decode(errors="replace")


def changed_file(path, changes):
    """The text of a file with changes, pairs of an old text, which is in it once, and a new one."""
    with open(path) as file:
        text = file.read()
    for old, new in changes:
        if text.count(old) != 1:
            raise ValueError("%r stands %d times in %s" % (old, text.count(old), path))
        text = text.replace(old, new)
    return text


def parameter_text(case):
    if "text" in case:
        return case["text"]
    return changed_file(os.path.join(HERE, case.get("file", "rod.prm")), case.get("replace", []))


def cases_of(path):
    with open(path) as file:
        cases = json.load(file)
    names = cases.pop(0)["let"] if "let" in cases[0] else {}

    def filled(value):
        if isinstance(value, dict):
            return {key: filled(item) for key, item in value.items()}
        if isinstance(value, list):
            return [filled(item) for item in value]
        return names.get(value[1:-1], value) if isinstance(value, str) and value[:1] == "{" else value

    return [filled(case) for case in cases]


def problems_of(case, program, mpiexec, ranks, session_directories):
    """What is wrong with the program in this case: a list of texts. It keeps the session of MPI in one of
    the directories of a queue: a program removes its session while another one makes its own."""
    directory = tempfile.mkdtemp(prefix="tombolo_case_")
    try:
        text = parameter_text(case).replace("@OUTPUT@", "output")
        with open(os.path.join(directory, "case.prm"), "w") as file:
            file.write(text)
        for name, content in case.get("files", {}).items():
            with open(os.path.join(directory, name), "w") as file:
                file.write(content)
        if case.get("has_parameter_file", True):
            options = case.get("options", ["--dry-run"]) + ["case.prm"]
        else:
            options = case["options"]
        launcher = [mpiexec, "-n", str(ranks)] if ranks > 1 else []
        session_directory = session_directories.get()
        code, printed = run(launcher + loaded.start_of(program) + options, directory,
                            environment=dict(loaded.environment(ranks), TMPDIR=session_directory))
        session_directories.put(session_directory)

        problems = []
        expected = case.get("exit", 1)
        if code != expected:
            problems.append("exit code %s instead of %s" % (code, expected))
        joined = " ".join(printed.split())
        if "at" in case:
            lines = [number for number, line in enumerate(text.split("\n"), 1) if case["at"] in line]
            if len(lines) != 1:
                raise ValueError("%r stands in %d lines" % (case["at"], len(lines)))
            beginning = "Error: case.prm:%d: " % lines[0]
            if joined.count(beginning) != 1:
                problems.append("%r stands %d times, not once" % (beginning, joined.count(beginning)))
        for piece in case["says"]:
            if joined.count(piece) != 1:
                problems.append("%r stands %d times, not once" % (piece, joined.count(piece)))
        if expected == 1 and len(re.findall(r"\bError: ", joined)) != 1:
            problems.append("not one error")
        for piece in NEVER:
            if piece in joined:
                problems.append("%r is shown" % piece)
        output = os.path.join(directory, "output")
        left = sorted(os.listdir(output)) if os.path.isdir(output) else []
        for name in case.get("leaves", []):
            if name not in left:
                problems.append("%s is missing in the output directory" % name)
        if "leaves" not in case and left:
            problems.append("it leaves %s" % left)
        if problems:
            problems.append("it printed:\n" + printed)
        return problems
    finally:
        shutil.rmtree(directory, ignore_errors=True)


def main():
    program, mpiexec, ranks, case_file = sys.argv[1:5]
    ranks = int(ranks)
    cases = cases_of(case_file)
    if len(sys.argv) > 5:
        cases = [case for case in cases if sys.argv[5] in case["name"]]
    names = [case["name"] for case in cases]
    if len(set(names)) != len(names):
        raise ValueError("two cases have one name")
    cases = [case for case in cases if ranks in case.get("ranks", [1, 2])]
    n_run, n_wrong = len(cases), 0
    loaded.start_of(program)
    session_directories = queue.Queue()
    # On several ranks most of the time is the waiting of mpirun.
    n_at_a_time = 1 if ranks == 1 else 2 * ranks
    for _ in range(n_at_a_time):
        session_directories.put(tempfile.mkdtemp(prefix="m"))
    with ThreadPoolExecutor(n_at_a_time) as pool:
        for case, problems in zip(cases, pool.map(
                lambda case: problems_of(case, program, mpiexec, ranks, session_directories), cases)):
            if problems:
                n_wrong += 1
                print("WRONG: %s\n  %s\n" % (case["name"], "\n  ".join(problems)), flush=True)
    while not session_directories.empty():
        shutil.rmtree(session_directories.get(), ignore_errors=True)
    print("%d of %d cases are as they should be on %d ranks" % (n_run - n_wrong, n_run, ranks))
    return 0 if n_wrong == 0 and n_run > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
