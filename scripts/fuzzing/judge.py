# SPDX-License-Identifier: LGPL-2.1-or-later
"""Whether the program did with an input what it promises."""

import csv
import json
import math
import os
import re
import xml.etree.ElementTree as ElementTree

import run_case  # tests/regression
import run_cases  # tests/program

# "could not be read" and the like of other libraries come with these.
NEVER = [piece for piece in run_cases.NEVER if piece != "Violated"] + ["Sanitizer", "runtime error:", "Assertion"]


def problem_of(ending, printed, directory, given):
    """What is wrong, or None, and what the program did: "refused" or "run". `given` are the names of the
    files that the program was given."""
    if ending.stopped in ("set-up", "end", "hang"):
        return {"set-up": "the time limit is reached before the first step",
                "end": "it does not end after SIGTERM", "hang": "it hangs"}[ending.stopped], "failed"
    for piece in NEVER:
        if piece in printed:
            return "it prints %r" % piece, "failed"
    if ending.code < 0:
        return "it is killed by signal %d" % -ending.code, "failed"
    allowed = (0, 1, 2, 143) if ending.stopped == "asked" else (0, 1, 2)
    if ending.code not in allowed:
        return "the exit code is %d" % ending.code, "failed"
    left = sorted(set(os.listdir(directory)) - {name.split("/")[0] for name in given})
    if ending.code == 1:
        return problem_of_refusal(printed, left, given), "refused"
    outputs = [os.path.dirname(path) for path in walk(directory) if os.path.basename(path) == "log.txt"]
    if len(outputs) != 1:
        return "it leaves %d output directories" % len(outputs), "run"
    try:
        check_output(outputs[0], {0: "finished", 2: "failed", 143: "terminated"}[ending.code])
    except (Unreadable, OSError, ValueError, KeyError, LookupError, ElementTree.ParseError) as error:
        return "its output is not whole: %r" % error, "run"
    if ending.code == 2 and not re.search(r"The run stopped: \S", printed):
        return "it does not say why it stops", "run"
    return None, "run"


def problem_of_refusal(printed, left, given):
    errors = re.findall(r"(?:^|\n)Error: ([^\n]*)", printed)
    if len(errors) != 1:
        return "it prints %d errors" % len(errors)
    if len(errors[0].strip()) < 20:
        return "its message is empty"
    if left:
        return "it is refused and leaves %s" % left
    mistakes = errors
    if re.match(r"\d+ mistakes were found", errors[0]):
        mistakes = re.findall(r"\n *\d+\. ([^\n]*)", printed)
        if len(mistakes) < 2:
            return "it lists %d mistakes" % len(mistakes)
    # The position: a file and mostly a line. What used the memory is unknown.
    for mistake in mistakes:
        if not any(name in mistake for name in given) and "The memory is exhausted" not in mistake:
            return "its message names no file"
    return None


class Unreadable(Exception):
    pass


def walk(directory):
    for path, _, names in os.walk(directory):
        for name in names:
            yield os.path.join(path, name)


def require(condition, what):
    if not condition:
        raise Unreadable(what)


def check_output(output, ended):
    """Reads all that a run left."""
    names = list(walk(output))
    require(not [name for name in names if name.endswith(".tmp")], "a file that is not finished")
    with open(os.path.join(output, "summary.json"), encoding="utf-8") as file:
        summary = json.load(file, parse_constant=refuse_constant)
    require(summary["ended"] == ended, "the summary says %s" % summary["ended"])
    for name in ("original.prm", "parameters.prm"):
        require(os.path.isfile(os.path.join(output, name)), name)
    with open(os.path.join(output, "parameters.json"), encoding="utf-8") as file:
        json.load(file)
    for name in names:
        if name.endswith(".csv"):
            check_table(name)
        elif name.endswith((".pvtu", ".pvd")):
            check_links(name)
        elif name.endswith(".vtu"):
            check_picture(name)


def refuse_constant(name):
    raise Unreadable("%s in JSON" % name)


def check_table(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    require(rows, "%s is empty" % path)
    for row in rows[1:]:
        require(len(row) == len(rows[0]), "a row of %s is cut" % path)
        for name, value in zip(rows[0], row):
            # Where the exact solution vanishes there is no relative error.
            require(not value or math.isfinite(float(value)) or name.startswith("relative error"),
                    "%s in %s" % (value, path))


def check_links(path):
    root = ElementTree.parse(path).getroot()
    for element in list(root.iter("DataSet")) + list(root.iter("Piece")):
        name = element.get("file") or element.get("Source")
        require(os.path.isfile(os.path.join(os.path.dirname(path), name)), "%s is missing" % name)


def check_picture(path):
    piece = ElementTree.parse(path).getroot().find(".//Piece")
    n_points = int(piece.get("NumberOfPoints"))
    for array in piece.find("PointData"):
        if n_points > 0:
            require(len(run_case.compressed_array(array)) == n_points, "an array of %s is cut" % path)
