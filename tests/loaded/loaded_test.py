#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A program that is loaded already runs as one that is started: streams, directory, environment,
signals, exit code, ranks.

    loaded_test.py PROGRAM MPIEXEC
"""

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "program"))
import loaded
import run_cases

PROGRAM = MPIEXEC = ""


class LoadedTest(unittest.TestCase):
    def setUp(self):
        self.start = loaded.start_of(PROGRAM)
        self.assertNotEqual(self.start, [PROGRAM])
        holder = tempfile.TemporaryDirectory(prefix="tombolo_loaded_test_")
        self.addCleanup(holder.cleanup)
        self.directory = holder.name

    def write(self, *changes):
        with open(os.path.join(self.directory, "rod.prm"), "w") as file:
            file.write(run_cases.parameter_text({"replace": changes}).replace("@OUTPUT@", "output"))

    def run_both(self, *options, ranks=1):
        """Exit code, standard output and standard error of the program, started and loaded."""
        launcher = [MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
        return [subprocess.run(launcher + command + list(options), cwd=self.directory, check=False,
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               env=loaded.environment(ranks)) for command in ([PROGRAM], self.start)]

    def assert_same(self, first, second, code, piece):
        self.assertEqual(first.returncode, code, first)
        self.assertEqual(second.returncode, code, second)
        # mpirun names its job, and the process that failed first.
        # [[job,step],rank] of Open MPI 4, [prterun-host-process@step,rank] of 5.
        texts = [re.sub(rb"\[\[\d+,\d+\],\d+\]|\[prterun-[^\]]*\]", b"[name]", each.stderr)
                 for each in (first, second)]
        self.assertEqual((first.stdout, texts[0]), (second.stdout, texts[1]))
        self.assertIn(piece, first.stdout + first.stderr)

    def test_a_valid_file(self):
        self.write()
        self.assert_same(*self.run_both("--validate", "rod.prm"), 0, b"nothing wrong was found")

    def test_a_mistake(self):
        self.write(["set End time         = 0.5", "set End time = -1"])
        for ranks in (1, 2):
            self.assert_same(*self.run_both("--validate", "rod.prm", ranks=ranks), 1, b"Error: rod.prm:")

    def test_runs_leave_the_same(self):
        self.write()
        for ranks in (1, 2):
            texts = []
            for command in ([PROGRAM], self.start):
                launcher = [MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
                subprocess.run(launcher + command + ["--quiet", "rod.prm"], cwd=self.directory, check=True,
                               env=loaded.environment(ranks))
                with open(os.path.join(self.directory, "output", "statistics.csv"), "rb") as file:
                    texts.append(file.read())
                with open(os.path.join(self.directory, "output", "summary.json")) as file:
                    self.assertEqual(json.load(file)["ranks"], ranks)
            self.assertEqual(*texts)

    def start_endless(self):
        self.write(["set End time         = 0.5", "set End time = 1e7\nsubsection Time step\n  set Fixed = 1e-4\nend"],
                   ["set Times = 0.25", "set Interval = 5e6"])
        process = subprocess.Popen(self.start + ["--quiet", "rod.prm"], cwd=self.directory,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, env=loaded.environment(1))
        while not os.path.exists(os.path.join(self.directory, "output", "statistics.csv")):
            self.assertIsNone(process.poll())
            time.sleep(0.01)
        return process

    def test_signals_are_passed_on(self):
        process = self.start_endless()
        process.send_signal(signal.SIGTERM)
        process.communicate()
        self.assertEqual(process.returncode, 128 + signal.SIGTERM)

    def test_what_is_killed_ends(self):
        process = self.start_endless()
        process.kill()
        # The end of the program closes its standard output.
        process.communicate()
        self.assertEqual(process.returncode, -signal.SIGKILL)


if __name__ == "__main__":
    PROGRAM, MPIEXEC = os.path.abspath(sys.argv[1]), sys.argv[2]
    unittest.main(argv=sys.argv[:1])
