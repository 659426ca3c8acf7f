#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs studies on a mock program and checks what is made of it.

usage: check.py DIRECTORY
"""

import csv
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

# What hangs is stopped after a second. All else has no limit: even the start of
# Python can need a second on a busy machine.
HANGS = ("--set", "Factor: behaviour/Values = hangs", "--set", "Time limit = 1")

HERE = Path(__file__).resolve().parent
START = [sys.executable, "-B", "-m", "studying"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(HERE.parents[1] / "scripts")}
MOCK = HERE / "mock_program.py"


class Checker:
    def __init__(self, directory):
        self.directory = Path(directory)
        shutil.rmtree(self.directory, ignore_errors=True)
        self.directory.mkdir(parents=True)
        self.log = self.directory / "calls.txt"
        self.problems = []

    def expect(self, holds, what):
        if not holds:
            self.problems.append(what)

    def command(self, study, *options):
        return [*START, str(HERE / study), "--set", f"Program = {MOCK}", *options]

    def run(self, study, output, *options, **environment):
        """Exit code, text and the calls of the mock program."""
        self.log.unlink(missing_ok=True)
        result = subprocess.run(
            self.command(study, "--set", f"Output directory = {self.directory / output}", *options),
            env={**ENVIRONMENT, "MOCK_LOG": str(self.log), **environment}, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        calls = self.log.read_text().splitlines() if self.log.exists() else []
        return result.returncode, result.stdout, calls

    def runs(self, output):
        with open(self.directory / output / "members.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))


def check_behaviours(checker):
    code, text, calls = checker.run("behaviours.prm", "behaviours", "--anew")
    checker.expect(code == 2, f"crashes must be told by exit code 2, not {code}: {text}")
    checker.expect(len(calls) == 12, f"12 members, {len(calls)} calls")
    rows = {(row["behaviour"], row["x"]): row for row in checker.runs("behaviours")}
    states = {"good": "measured", "refuses": "refused", "stops": "stopped", "crashes": "crashed",
              "mute": "crashed", "silent": "no value"}
    for (behaviour, x), row in rows.items():
        checker.expect(row["state"] == states[behaviour],
                       f'{behaviour}: {row["state"]}, not {states[behaviour]}')
        checker.expect((row["error"] != "") == (behaviour == "good"), f"{behaviour}: error {row}")
        if behaviour == "good":
            checker.expect(abs(float(row["error"]) * 16.2 * float(x) - 1) < 1e-6, f"error of {row}")
    checker.expect(rows["refuses", "1"]["message"] ==
                   'file.prm:3: entry "x" = "-1": allowed is a number above 0',
                   f'words of a refusal: {rows["refuses", "1"]["message"]}')
    checker.expect(rows["stops", "1"]["message"] == "node 7 is lost.",
                   f'words of a run that stopped: {rows["stops", "1"]["message"]}')
    checker.expect("x 1 → 2: error ÷ 2, time × 2." in text, f"the sentence of x: {text}")
    checker.expect("behaviour crashes: 2 of 2 runs without a result." in text, "failures are told")
    with open(checker.directory / "behaviours/study.json", encoding="utf-8") as file:
        front = [m["name"] for m in json.load(file)["members"] if m["on_front"]]
    checker.expect(len(front) == 2, f"both good runs are on the front: {front}")

    _, text, calls = checker.run("behaviours.prm", "behaviours")
    checker.expect(len(calls) == 0, f"members that ran before run again: {calls}")
    _, _, calls = checker.run("behaviours.prm", "behaviours", "--set",
                              "Factor: x/Values = 1 & 1 | 2 & 1 | 4 & 1")
    checker.expect(len(calls) == 6, f"only the new members run: {len(calls)}")
    record = checker.directory / "behaviours/members/behaviour=good+x=1.json"
    record.write_text(record.read_text()[:40])
    _, _, calls = checker.run("behaviours.prm", "behaviours")
    checker.expect(len(calls) == 1, f"a run with a damaged record runs again: {len(calls)}")
    _, _, calls = checker.run("behaviours.prm", "behaviours", MOCK_VERSION="2")
    checker.expect(len(calls) == 12, f"with another program all run again: {len(calls)}")


def check_files(checker):
    """Meshes and tables that the entries name are of the run."""
    base, table = checker.directory / "scene.prm", checker.directory / "load.csv"
    base.write_text("set Function = 2*table(load.csv, t); 0\n" + (HERE / "base.prm").read_text())
    options = ("--set", f"Base file = {base}", "--set", "Factor: behaviour/Values = good")
    for text, n_calls in (("0, 1", 2), ("0, 1", 0), ("0, 2", 2)):
        table.write_text(text)
        _, _, calls = checker.run("behaviours.prm", "files", *options)
        checker.expect(len(calls) == n_calls, f"with the table {text} {n_calls} runs are made, not {len(calls)}")


def check_values(checker):
    """Operators of expressions separate no values."""
    code, text, _ = checker.run("behaviours.prm", "listed", "--list", "--set", "Factor: behaviour/Values = x < 1 || x > 2|all",
                                "--set", "Factor: x/Values = x > 1 && x < 2 & 1 | 2 & 1")
    checker.expect(code == 0 and "behaviour = x < 1 || x > 2, x = x > 1 && x < 2" in text and len(text.splitlines()) == 4,
                   f"values with operators: ({code}) {text}")


def check_measurement(checker):
    options = ("--set", "Factor: behaviour/Values = good", "--set",
               "Error/Quantities of interest = measured.json/sum", "--set", "Error/References = 1")
    code, text, calls = checker.run("behaviours.prm", "measured", *options, "--set",
                                    "Measurement = mock_measurement.py {output} 10")
    checker.expect(code == 0, f"a measured study ends with {code}: {text}")
    errors = [float(row["error"]) for row in checker.runs("measured")]
    checker.expect(errors == [10.0, 11.0], f"what the program measures is the value: {errors}")
    _, _, calls = checker.run("behaviours.prm", "measured", *options, "--set",
                              "Measurement = mock_measurement.py {output} 10")
    checker.expect(not calls, f"measured runs run again: {calls}")
    _, _, calls = checker.run("behaviours.prm", "measured", *options, "--set",
                              "Measurement = mock_measurement.py {output} ten")
    rows = checker.runs("measured")
    checker.expect(len(calls) == 2, f"with another measurement all run again: {calls}")
    for row in rows:
        checker.expect(row["state"] == "no value" and
                       row["message"] == "it could not be measured: there is no number ten",
                       f"words of a measurement that fails: {row}")


def check_hangs(checker):
    code, text, _ = checker.run("behaviours.prm", "hangs", "--anew", *HANGS)
    checker.expect(code == 2, f"hangs must be told by exit code 2, not {code}: {text}")
    rows = checker.runs("hangs")
    checker.expect(len(rows) == 2, f"2 members, {len(rows)} rows")
    for row in rows:
        checker.expect(row["state"] == "timed out" and row["error"] == "", f"hangs: {row}")
    checker.expect("behaviour hangs: 2 of 2 runs without a result." in text, "hangs are told")
    _, text, calls = checker.run("behaviours.prm", "hangs", *HANGS)
    checker.expect(len(calls) == 0, f"members that hung before run again: {calls}")
    _, _, calls = checker.run("behaviours.prm", "hangs", *HANGS, "--set",
                              "Factor: x/Values = 1 & 1 | 2 & 1 | 4 & 1")
    # It may be stopped before it writes that it was called.
    checker.expect(len(calls) <= 1, f"of members that hang only the new one runs: {calls}")
    checker.expect([row["state"] for row in checker.runs("hangs")] == ["timed out"] * 3,
                   "the new member hangs, too")


def check_search(checker):
    code, text, _ = checker.run("search.prm", "search", "--anew")
    checker.expect(code == 0, f"search ends with {code}: {text}")
    for row in checker.runs("search"):
        value = float(row["Model/x"] or "nan")
        if row["behaviour"] == "bounded":
            checker.expect(0.7 / 1.0101 <= value <= 0.7, f"the limit 0.7 is found as {value}")
            checker.expect("x is too large" in row["message"], f"why: {row['message']}")
        elif row["behaviour"] == "good":
            checker.expect(value == 4, f"what always succeeds has the largest value: {value}")
        else:
            checker.expect(row["state"] == "refused" and math.isnan(value), f"refused: {row}")
    checker.run("search.prm", "relative", "--anew", "--set", "Search/Relative to = summary.json/limit",
                "--set", "Search/To = 8", "--set", "Search/From = 0.02", "--set", "Common settings = Model/x = 0.1")
    values = [float(row["Model/x"] or "nan") for row in checker.runs("relative")
              if row["behaviour"] == "bounded"]
    checker.expect(values and all(1.4 / 1.0101 <= v <= 1.4 for v in values),
                   f"in multiples of 0.5 the limit is 1.4: {values}")
    calls = (checker.directory / "calls.txt").read_text()
    checker.expect("--set Part: a/kernel/Dilation = 2 --set Part: b/kernel/Dilation = 2" in calls
                   and "Part: c" not in calls, "* stands for the sections that there are")


def check_least(checker):
    """What is refused before the first run; tests of the search itself need SciPy."""
    bad = {
        "Search/Kind = smallest": "allowed is largest, least",
        "Search/Entry =": "needs entries whose values it tries",
        "Search/Entry = Model/x & Model/x": "an entry is missing, or named twice",
        "Search/Entry = Model/x & Model/y": "1 values for 2 entries",
        "Search/From =": "needs the ends",
        "Search/To = 0.05": "is not larger than the smallest",
        "Search/Largest number of runs = 1": "a whole number from 2",
        "Error/Reference run = behaviour = good": "give References",
        "Search/Kind = largest": "with a search the value that was found",
    }
    for setting, words in bad.items():
        code, text, _ = checker.run("least.prm", "refused", "--set", setting)
        checker.expect(code == 1 and words in text, f"{setting}: expected {words}, found ({code}) {text}")
    code, text, _ = checker.run("least.prm", "refused", "--set", "Error/Quantities of interest =", "--set", "Error/References =")
    checker.expect(code == 1 and "needs values of a run" in text, f"a least error of nothing: ({code}) {text}")
    for setting, words in (("Search/From = 0", "a number from 1e-300"), ("Search/Entry = Model/x & Model/y", "of one entry")):
        code, text, _ = checker.run("search.prm", "refused", "--set", setting)
        checker.expect(code == 1 and words in text, f"{setting}: expected {words}, found ({code}) {text}")
    # A SciPy that cannot be imported.
    without = checker.directory / "without"
    without.mkdir()
    (without / "scipy.py").write_text("raise ImportError('none')\n")
    path = os.pathsep.join([str(without), ENVIRONMENT["PYTHONPATH"]])
    code, text, calls = checker.run("least.prm", "refused", PYTHONPATH=path)
    checker.expect(code == 1 and not calls and "needs SciPy for Python" in text, f"a search without SciPy: ({code}) {text}")
    code, text, _ = checker.run("least.prm", "refused", "--validate", PYTHONPATH=path)
    checker.expect(code == 0, f"a file is read without SciPy: ({code}) {text}")


def check_interruption(checker):
    process = subprocess.Popen(
        checker.command("behaviours.prm", "--anew", "--set",
                        f"Output directory = {checker.directory / 'interrupted'}", "--set",
                        "Factor: behaviour/Values = good | hangs"),
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=ENVIRONMENT)
    record = checker.directory / "interrupted/members/behaviour=good+x=2.json"
    while not record.exists() and process.poll() is None:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    text, _ = process.communicate()
    checker.expect(process.returncode == 130, f"interrupted: exit code {process.returncode}: {text}")
    checker.expect(record.exists(), "what ran before the interruption is kept")


def check_former_names(checker):
    former = {"Factors": "Knobs", "Factor:": "Knob:", "Runs at a time": "Members at a time",
              "Quantities of interest": "Measures"}
    text = (HERE / "behaviours.prm").read_text()
    for name, former_name in former.items():
        text = text.replace(name, former_name)
    text = text.replace("base.prm", str(HERE / "base.prm"))
    study = checker.directory / "former.prm"
    study.write_text(text)
    _, listed, _ = checker.run("behaviours.prm", "listed", "--list")
    code, text, _ = checker.run(study, "listed", "--list")
    checker.expect(code == 0 and all(line in text for line in listed.splitlines()),
                   f"a study with former names has other runs: ({code}) {text}")
    checker.expect('entry "Knobs" is now called "Factors".' in text
                   and 'entry "Error/Measures" is now called "Quantities of interest".' in text,
                   f"former names are noted: {text}")
    checker.run(study, "former", "--anew", "--set", "Knob: behaviour/Values = good")
    written = checker.directory / "former/parameters.prm"
    code, text, _ = checker.run(written, "listed", "--validate")
    checker.expect(code == 0 and "is now called" not in text,
                   f"the parameters that were written are read: ({code}) {text}")


def check_refusals(checker):
    bad = {
        ("Grids", "behavour"): 'Did you mean "behaviour"',
        ("Grids", "x = 3"): '"3" is no value of the factor x; allowed is 1, 2',
        ("Grids", "x x x"): "names the factor x twice",
        ("Factor: x/Values", "1 | 2"): "has 1 texts for 2 entries",
        ("Factor: x/Values", "1 & 1 | 1 & 2"): 'two values are called "1"',
        ("Factor: x/Labels", "a"): "1 labels for 2 values",
        ("Factor: x/Entries", "Part: z*/x & Model/error"): "no section of",
        ("Error/Quantities of interest", "length"): "does not name a value",
        ("Error/Quantities of interest", "largest of summary.json/x"): "only a column of a table",
        ("Error/References", "1, 2"): "2 references for 1 quantities",
        ("Error/References", "0"): "relative to zero",
        ("Error/Reference run", "x = 1"): "no grid has this run",
        ("Base file", "nowhere.prm"): "there is no file",
        ("Measurement", "nowhere.py {output}"): "there is no file",
        ("Measurement", "base.prm {output}"): "is no program that may be run",
        ("Measurement", "mock_measurement.py 1"): "is not told where the run is",
        ("Factor: behaviour/Values", "1 to 2 in 1"): "2 to 1000 values",
        ("Factor: behaviour/Values", "-1 to 2 in 3 geometric"): "geometric range are positive",
    }
    for (entry, value), words in bad.items():
        code, text, calls = checker.run("behaviours.prm", "refused", "--set", f"{entry} = {value}")
        checker.expect(code == 1 and words in " ".join(text.split()) and entry in text,
                       f"{entry} = {value}: expected {words}, found ({code}) {text}")
        checker.expect(not calls, f"{entry} = {value}: a run ran")
    code, text, _ = checker.run("behaviours.prm", "refused", "--set", "Search/Entry = Model/x")
    checker.expect(code == 1 and "with a search the value that was found" in text,
                   f"a search and measures of an error: ({code}) {text}")
    code, text, _ = checker.run("behaviours.prm", "refused", "--set", "Error/Quantities of interest =",
                                "--set", "Error/References =")
    checker.expect(code == 1 and "a study measures something" in text,
                   f"a study without a measure: ({code}) {text}")
    checker.expect(not (checker.directory / "refused").exists(), "a refused study leaves nothing")


def main():
    checker = Checker(sys.argv[1])
    for check in (check_behaviours, check_files, check_values, check_measurement, check_hangs, check_search, check_least,
                  check_interruption, check_former_names, check_refusals):
        check(checker)
    for problem in checker.problems:
        print(problem)
    sys.exit(1 if checker.problems else 0)


if __name__ == "__main__":
    main()
