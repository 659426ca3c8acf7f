#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command line, what a run leaves behind, signals, and the parameter files of the repository.

    command_line.py PROGRAM MPIEXEC SOURCE_DIRECTORY options|leavings|signals|shipped
"""

import csv
import glob
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import run_cases
import loaded

PROGRAM = MPIEXEC = SOURCE = ""


class Case(unittest.TestCase):
    """A directory of its own with the small rod in it."""

    def setUp(self):
        self.directory = tempfile.mkdtemp(prefix="tombolo_line_")
        self.addCleanup(shutil.rmtree, self.directory, True)
        self.write_rod("rod.prm", "output")

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)

    def write_rod(self, name, output, *changes):
        text = run_cases.parameter_text({"replace": changes}).replace("@OUTPUT@", output)
        self.write(name, text)

    def path(self, *names):
        return os.path.join(self.directory, *names)

    def read(self, *names):
        with open(self.path(*names)) as file:
            return file.read()

    def run_program(self, *options, exits=0, ranks=1):
        launcher = [MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
        code, printed = run_cases.run(launcher + loaded.start_of(PROGRAM) + list(options), self.directory,
                                      environment=loaded.environment(ranks))
        self.assertEqual(code, exits, printed)
        for piece in run_cases.NEVER:
            self.assertNotIn(piece, printed)
        return printed


class Options(Case):
    def test_help_names_every_option(self):
        printed = self.run_program("--help")
        for option in ("--help", "--version", "--validate", "--dry-run", "--print-parameters",
                       "--list-plugins", "--set", "--resume", "--overwrite", "--quiet", "FILE.prm"):
            self.assertIn(option, printed)

    def test_version_names_the_libraries(self):
        versions = json.loads(self.run_program("--version", ranks=2))
        for key in ("tombolo", "deal.II", "Trilinos", "p4est", "git", "build_type"):
            self.assertTrue(versions[key], key)

    def test_validate_writes_nothing(self):
        printed = self.run_program("--validate", "rod.prm")
        self.assertIn("nothing wrong was found", printed)
        self.assertEqual(os.listdir(self.directory), ["rod.prm"])

    def test_dry_run_prints_the_audit_and_writes_nothing(self):
        printed = self.run_program("--dry-run", "rod.prm", ranks=2)
        self.assertEqual(os.listdir(self.directory), ["rod.prm"])
        self.assertIn("Model: 33 nodes (18 of elements, 18 particles, 3 shared), 10 elements", printed)
        for piece in ('part "left"', 'part "right"', "neighbours", "mass 80,", "extent [0, 2] x [0, 0.4]",
                      "wave speeds", "time step", "estimate, from the", "steps", "memory", "wall time"):
            self.assertIn(piece, printed)
        self.assertNotIn("t = 0", printed)

    def test_plugins_are_listed_by_kind_with_their_description(self):
        lines = self.run_program("--list-plugins").splitlines()
        for plugin in ("formulation: hexahedron - ", "formulation: momentum consistent particle - ",
                       "kernel: cubic spline - ", "kernel: quintic spline - ", "material: elastic - ",
                       "mesh: box - ", "mesh: file - ", "pairing: tied - ", "pairing: touching - "):
            found = [line for line in lines if line.startswith(plugin)]
            self.assertEqual(len(found), 1, plugin)
            self.assertGreater(len(found[0]), len(plugin) + 10)

    def test_printed_parameters_can_be_fed_back(self):
        printed = self.run_program("--print-parameters", "rod.prm", ranks=2)
        self.assertIn("Young's modulus", printed)
        self.write("again.prm", printed)
        self.run_program("--validate", "again.prm")
        self.assertEqual(self.run_program("--print-parameters=prm", "again.prm"), printed)

    def test_printed_parameters_are_json_or_xml(self):
        values = json.loads(self.run_program("--print-parameters=json", "rod.prm"))
        self.assertIn("Parts", values)
        tree = xml.etree.ElementTree.fromstring(self.run_program("--print-parameters=xml", "rod.prm"))
        self.assertEqual(tree.tag, "ParameterHandler")
        self.assertIn("allowed is prm, json, xml or markdown",
                      self.run_program("--print-parameters=yaml", "rod.prm", exits=1))

    def test_set_overrides_an_entry(self):
        printed = self.run_program("--dry-run", "rod.prm", "--set", "Mesh/box/Cells = 20, 4",
                                   "--set", "Material: steel/elastic/Density = 200")
        self.assertIn("Model: 105 nodes", printed)
        self.assertIn("mass 160,", printed)

    def test_bad_overrides_are_refused(self):
        for assignment, message in (
                ("Mesh/box/Cell = 4, 4", 'Did you mean "Cells"?'),
                ("Meshh/Type = box", 'Did you mean "Mesh"?'),
                ("Mesh/box/Cells", '"=" is missing'),
                ("= 4", "a name is missing"),
                ("Material: steel/elastic/Density = -1", "allowed is a number larger than zero"),
                ("Mesh/Type = bx", 'allowed is one of "box", "disc", "file"')):
            printed = self.run_program("--validate", "rod.prm", "--set", assignment, exits=1)
            self.assertEqual(printed.count("Error: --set"), 1, printed)
            self.assertIn(message, printed)
        self.assertIn("already set", self.run_program("--validate", "rod.prm", "--set", "End time = 1",
                                                      "--set", "End time = 2", exits=1))
        self.assertIn("--set needs an argument", self.run_program("rod.prm", "--set", exits=1))

    def test_implicit_is_no_mistyped_explicit(self):
        self.write_rod("case.prm", "output")
        printed = self.run_program("--validate", "case.prm", "--set", "Time integration = implicit", exits=1)
        self.assertIn('allowed is one of "explicit"', printed)
        self.assertNotIn("Did you mean", printed)

    def test_a_wrong_command_line_is_refused_once(self):
        for options, message in ((("--validat", "rod.prm"), "Did you mean --validate?"),
                                 (("--dryrun", "rod.prm"), "Did you mean --dry-run?"),
                                 (("rod.prm", "fe.prm"), "Two parameter files: rod.prm and fe.prm"),
                                 ((), "No parameter file given"),
                                 (("nowhere.prm",), "nowhere.prm")):
            printed = self.run_program(*options, exits=1)
            self.assertIn(message, printed)
            self.assertEqual(printed.count("Error: "), 1)
        printed = self.run_program("nowhere.prm", exits=1, ranks=2)
        self.assertEqual(printed.count("Error: "), 1)
        os.mkdir(self.path("directory.prm"))
        self.assertIn("directory", self.run_program("directory.prm", exits=1))

    def test_quiet_prints_no_progress_but_logs_it(self):
        self.assertNotIn("node-steps/s", self.run_program("--quiet", "rod.prm"))
        self.assertIn("node-steps/s", self.read("output", "log.txt"))


class Leavings(Case):
    def test_a_run_leaves_all_that_is_promised(self):
        for ranks in (1, 2):
            shutil.rmtree(self.path("output"), True)
            self.run_program("rod.prm", ranks=ranks)
            self.check_output(ranks)

    def check_output(self, ranks):
        self.assertEqual(sorted(os.listdir(self.path("output"))),
                         ["conditions.csv", "log.txt", "original.prm", "parameters.json", "parameters.prm", "run.json", "solution",
                          "solution.pvd", "statistics.csv", "summary.json"])
        self.assertEqual([name for name in glob.glob(self.path("output", "**"), recursive=True)
                          if name.endswith(".tmp")], [])
        log = self.read("output", "log.txt")
        self.assertIn("Model: 33 nodes", log)
        self.assertIn("t = 0.5", log)
        self.assertIn(self.read("rod.prm").strip(), self.read("output", "original.prm"))
        values = json.loads(self.read("output", "parameters.json"))
        self.assertIn("Parts", values)

        with open(self.path("output", "statistics.csv")) as file:
            rows = list(csv.reader(line for line in file if not line.startswith("#")))
        header = rows[0]
        for column in ("time", "step", "energy error", "momentum drift", "lattice mode share"):
            self.assertTrue(any(name.strip().startswith(column) for name in header), column)
        times = [float(row[0]) for row in rows[1:]]
        self.assertEqual(times, [0, 0.25, 0.5])
        self.assertTrue(all(len(row) == len(header) for row in rows))

        collection = xml.etree.ElementTree.parse(self.path("output", "solution.pvd")).getroot()
        files = [entry.get("file") for entry in collection.iter("DataSet")]
        self.assertEqual(len(files), 6)  # cells and particles at three times
        for name in files:
            piece_file = xml.etree.ElementTree.parse(self.path("output", name)).getroot()
            pieces = [piece.get("Source") for piece in piece_file.iter("Piece")]
            self.assertEqual(len(pieces), ranks)
            for piece in pieces:
                self.assertTrue(os.path.isfile(self.path("output", os.path.dirname(name), piece)))

        summary = json.loads(self.read("output", "summary.json"))
        for key in ("versions", "ranks", "nodes", "fe_cells", "particles", "shared_nodes", "steps",
                    "simulated_time", "wall_seconds", "step_seconds", "step_processor_seconds",
                    "seconds_per_phase", "ns_per_cell_step",
                    "ns_per_particle_step", "peak_memory_bytes", "time_step_min", "time_step_max",
                    "energy_error_relative", "momentum_drift_relative", "results", "ended"):
            self.assertIn(key, summary)
        for key, value in (("ranks", ranks), ("nodes", 33), ("fe_cells", 10), ("particles", 18),
                           ("shared_nodes", 3), ("simulated_time", 0.5), ("ended", "finished")):
            self.assertEqual(summary[key], value, key)
        self.assertGreater(summary["peak_memory_bytes"], 1e6)
        self.assertLess(abs(summary["momentum_drift_relative"]), 1e-12)

    def test_the_parameters_of_a_run_repeat_it(self):
        at_rest = run_cases.parameter_text({"file": "bar.prm", "replace": []})
        self.write("bar.prm", at_rest.replace("@OUTPUT@", "output"))
        for file in ("rod.prm", "bar.prm"):
            with self.subTest(file):
                self.run_program("--quiet", file)
                first = self.read("output", "statistics.csv")
                shutil.copy(self.path("output", "parameters.prm"), self.path("again.prm"))
                shutil.rmtree(self.path("output"))
                self.run_program("--quiet", "again.prm")
                self.assertEqual(self.read("output", "statistics.csv"), first)
                shutil.rmtree(self.path("output"))

    def test_a_second_run_replaces_the_first(self):
        self.run_program("--quiet", "rod.prm")
        self.run_program("--quiet", "rod.prm", "--set", "End time = 0.25", "--set",
                         "Output/Times = 0.125")
        self.assertEqual(json.loads(self.read("output", "summary.json"))["simulated_time"], 0.25)
        self.assertEqual(len(self.read("output", "statistics.csv").strip().splitlines()),
                         3 + sum(line.startswith("#")
                                 for line in self.read("output", "statistics.csv").splitlines()) + 1)

    def test_a_run_that_stops_says_so_in_its_summary_and_log(self):
        self.write_rod("wild.prm", "output",
                       ["0.1*sin(pi*t); 0", "0.1/(0.25-t)*(t>0.2); 0"])
        printed = self.run_program("--quiet", "wild.prm", exits=2, ranks=2)
        self.assertEqual(printed.count("The run stopped:"), 1)
        summary = json.loads(self.read("output", "summary.json"))
        self.assertEqual(summary["ended"], "failed")
        self.assertIn("not finite", summary["failure"])
        self.assertIn("The run stopped: ", self.read("output", "log.txt"))
        rows = self.read("output", "statistics.csv")
        self.assertNotIn("nan", rows)
        self.assertNotIn("inf", rows)


class Signals(Case):
    def check(self, number, code, ended, ranks):
        # Small steps: a run that is never stopped must not get to where its load tears it apart.
        self.write_rod("long.prm", "output",
                       ["set End time         = 0.5", "set End time         = 1e7\n"
                        "subsection Time step\n  set Fixed = 1e-4\nend"],
                       ["set Times = 0.25", "set Interval = 5e6"])
        launcher = [MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
        process = subprocess.Popen(launcher + [PROGRAM, "long.prm"], cwd=self.directory,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT)
        try:
            while process.poll() is None:
                try:
                    if "t = 0 " in self.read("output", "log.txt"):
                        break
                except FileNotFoundError:
                    pass
                time.sleep(0.05)
            for options in ((), ("--overwrite",), ("--resume",)):
                self.assertIn("another run writes there now", self.run_program(*options, "long.prm", exits=1))
            process.send_signal(number)
            printed = process.communicate()[0].decode(errors="replace")
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()
        if ranks == 1:
            self.assertEqual(process.returncode, code, printed)
            # Whatever the scene sets for checkpoints, what was computed is not lost.
            self.assertEqual(len(glob.glob(self.path("output", "checkpoint", "step_*.h5"))), 1)
            self.assertIn("To continue: ", printed)
        else:
            self.assertNotEqual(process.returncode, 0, printed)
        for piece in run_cases.NEVER:
            self.assertNotIn(piece, printed)
        summary = json.loads(self.read("output", "summary.json"))
        self.assertEqual(summary["ended"], ended)
        last = self.read("output", "statistics.csv").strip().splitlines()[-1].split(",")
        self.assertEqual(float(last[0]), summary["simulated_time"])
        self.assertEqual(int(float(last[1])), summary["steps"])
        collection = xml.etree.ElementTree.parse(self.path("output", "solution.pvd")).getroot()
        times = [float(entry.get("timestep")) for entry in collection.iter("DataSet")]
        self.assertAlmostEqual(max(times), summary["simulated_time"], delta=1e-6 * max(times) + 1e-12)

    def test_an_interrupt_ends_the_run_with_complete_outputs(self):
        self.check(signal.SIGINT, 130, "interrupted", 1)

    def test_a_termination_ends_the_run_with_complete_outputs(self):
        self.check(signal.SIGTERM, 143, "terminated", 1)


class Shipped(Case):
    # The model is made on fewer cells where its scenes are the largest; that of the file is only read.
    FEWER_CELLS = {"taylor_impact": ("Mesh/cylinder/Core cells = 4", "Mesh/cylinder/Rings = 2",
                                     "Mesh/cylinder/Cells along axis = 12"),
                   "heated_plate": ("Mesh/box/Cells = 12, 4, 6",),
                   "verney_shell": ("Mesh/spherical shell/Cells along edge = 8",
                                    "Mesh/spherical shell/Cells through thickness = 4")}

    def test_every_parameter_file_is_valid_and_makes_a_model(self):
        names = [name for name in
                 glob.glob(os.path.join(SOURCE, "parameter_files", "**", "*.prm"), recursive=True)
                 if not self.is_a_piece(name)]
        self.assertGreaterEqual(len(names), 6)
        validated = set()
        for name in sorted(names):
            with self.subTest(file=os.path.relpath(name, SOURCE)):
                if self.is_of_another_program(name):
                    continue
                # A dry run reads all that `--validate` reads but later stages and, with fewer cells, the
                # mesh of the file, which is that of a piece.
                directory = os.path.dirname(name)
                pieces = {(directory, line) for line in ("", *self.lines_of(name, "include"))}
                if pieces - validated or self.lines_of(name, "set Stages", "set Initial state"):
                    validated |= pieces
                    self.assertIn("nothing wrong was found", self.run_program("--validate", name))
                if self.goes_on_from_another_run(name):
                    self.assertIn("A run leaves the state at its end",
                                  self.run_program("--dry-run", name, exits=1))
                    continue
                fewer = self.FEWER_CELLS.get(os.path.basename(os.path.dirname(name)), ())
                printed = self.run_program("--dry-run", name,
                                           *(text for entry in fewer for text in ("--set", entry)))
                self.assertIn("Model: ", printed)
                for line in printed.splitlines():
                    if line.startswith("Warning"):  # a named surface within, bodies that touch
                        self.assertIn("are not joined there" if os.sep + "contact" + os.sep in name
                                      else "lies inside the body", line)
        self.assertEqual(os.listdir(self.directory), ["rod.prm"])

    @staticmethod
    def lines_of(name, *beginnings):
        with open(name) as text:
            return tuple(line for line in text if line.startswith(beginnings))

    def is_a_piece(self, name):
        """A file without a title is there to be included by others."""
        return not self.lines_of(name, "set Title")

    @staticmethod
    def goes_on_from_another_run(name):
        """Its initial state is below output/, where other shipped files put theirs."""
        with open(name) as text:
            return re.search(r"^\s*set Initial state\s*= output/", text.read(), re.MULTILINE)

    def is_of_another_program(self, name):
        """Files of studies, which scripts read; their tests check them."""
        return self.lines_of(name, "set Factors", "set Groups")


if __name__ == "__main__":
    PROGRAM, MPIEXEC, SOURCE, subject = sys.argv[1:5]
    loader = unittest.TestLoader()
    result = unittest.TextTestRunner(verbosity=2).run(
        loader.loadTestsFromTestCase({"options": Options, "leavings": Leavings, "signals": Signals,
                                      "shipped": Shipped}[subject]))
    sys.exit(0 if result.wasSuccessful() and result.testsRun > 0 else 1)
