#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes runs with a stand-in for the program and shows that run_case.py fails where it must."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import body_meshes

RUNNER = Path(__file__).with_name("run_case.py")
# Writes the settings of --set: table = the rows of statistics.csv. meet = how many runs must
# have begun before it ends.
PROGRAM = """#!/usr/bin/env python3
import pathlib, sys, time
given = dict(a.split(" = ", 1) for a in sys.argv if " = " in a)
out = pathlib.Path(given["Output directory"])
out.mkdir(parents=True, exist_ok=True)
(out / "begun").touch()
while len(list(out.parent.glob("*/begun"))) < int(given.get("meet", 0)):
    time.sleep(0.01)
(out / "statistics.csv").write_text(given["table"].replace("|", chr(10)))
meshes = len(list(pathlib.Path().glob("*.msh")))
(out / "summary.json").write_text('{"steps": 3, "meshes": %d}' % meshes)
print("largest share of bytes 0.51")
sys.exit(int(given.get("exit", 0)))
"""
TABLE = "time [T],x [L],share|0,1,0|1,2,0.5"


class Runner(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.root = Path(self.temporary.name)
        self.program = self.root / "program"
        self.program.write_text(PROGRAM)
        os.chmod(self.program, 0o755)
        (self.root / "scene.prm").write_text("")

    def code(self, checks, tables=(TABLE, TABLE), jobs=1, **settings):
        runs = [{"name": f"r{i}", "file": "scene.prm", "set": {"table": table, **settings}}
                for i, table in enumerate(tables)]
        return self.code_of({"what": "", "runs": runs, "checks": checks}, jobs)

    def code_of(self, content, jobs=1):
        case = self.root / "case.json"
        case.write_text(json.dumps(content))
        return subprocess.run([sys.executable, str(RUNNER), str(case), "--program",
                               str(self.program), "--output", str(self.root / "out"), "--jobs", str(jobs)],
                              capture_output=True, text=True, check=False).returncode

    def test_a_bound_that_holds_passes_and_one_that_does_not_fails(self):
        self.assertEqual(self.code([{"value": "stat('r0', 'x')", "at_most": 2}]), 0)
        self.assertEqual(self.code([{"value": "stat('r0', 'x')", "at_most": 1.9}]), 1)
        self.assertEqual(self.code([{"value": "stat('r0', 'x', 0)", "at_least": 1}]), 0)
        self.assertEqual(self.code([{"value": "stat('r0', 'x', 0)", "at_least": 1.1}]), 1)
        self.assertEqual(self.code([{"value": "summary('r0', 'steps')", "equals": 3}]), 0)
        self.assertEqual(self.code([{"value": "summary('r0', 'steps')", "equals": 4}]), 1)

    def test_a_check_without_bound_or_a_case_without_check_fails(self):
        self.assertEqual(self.code([{"value": "stat('r0', 'x')"}]), 1)
        self.assertEqual(self.code([]), 1)
        self.assertEqual(self.code([{"value": "1", "atmost": 2}]), 1)

    def test_what_is_missing_or_not_finite_fails(self):
        self.assertEqual(self.code([{"value": "stat('r0', 'y')", "at_most": 1e300}]), 1)
        self.assertEqual(self.code([{"value": "stat('r9', 'x')", "at_most": 1e300}]), 1)
        self.assertEqual(self.code([{"value": "stat('r0', 'x', 7)", "at_most": 1e300}]), 1)
        self.assertEqual(self.code([{"value": "audit('r0', 'shard ([0-9.]+)')", "at_most": 9}]), 1)
        bad = "time [T],x [L]|0,1|1,nan"
        self.assertEqual(self.code([{"value": "stat('r0', 'x')", "at_most": 9}], (bad,)), 1)
        self.assertEqual(self.code([{"value": "largest('r0', 'x')", "at_most": 9}], (bad,)), 1)

    def test_a_run_that_ends_badly_fails(self):
        self.assertEqual(self.code([{"value": "stat('r0', 'x')", "at_most": 9}], exit=2), 1)

    def test_runs_are_side_by_side_and_a_bad_one_among_them_fails(self):
        holds = [{"value": "stat('r1', 'x')", "at_most": 9}]
        self.assertEqual(self.code(holds, (TABLE, TABLE, TABLE), jobs=2, meet=2), 0)
        self.assertEqual(self.code(holds, ("time [T],x [L]|0,1", TABLE), jobs=2, exit=2), 1)

    def test_runs_that_differ_are_noticed(self):
        near = "time [T],x [L],share|0,1,0|1,2.000001,0.5"
        same = [{"value": "difference('r0', 'r1')", "at_most": 1e-10}]
        bits = [{"value": "differing_files('r0', 'r1')", "equals": 0}]
        self.assertEqual(self.code(same), 0)
        self.assertEqual(self.code(bits), 0)
        self.assertEqual(self.code(same, (TABLE, near)), 1)
        self.assertEqual(self.code(bits, (TABLE, near)), 1)
        self.assertEqual(self.code(same, (TABLE, TABLE + "|2,3,0.5")), 1)
        self.assertEqual(self.code([{"value": "difference('r0', 'r1')", "at_most": 1e-6}],
                                   (TABLE, near)), 0)

    def test_pairs_and_common_settings_are_written_out(self):
        content = {"what": "", "sets": {"last": {"table": "time [T],x [L]|0,{x}"}, "bad": {"exit": 2}},
                   "runs": [{"name": "{run}", "for": {"run x": [["r0", 3], ["r1", 4]]},
                             "file": "scene.prm", "with": ["bad", "last"], "set": {"exit": 0}}],
                   "checks": [{"value": "stat('{run}', 'x')", "for": {"run x": [["r0", 3], ["r1", 4]]},
                               "equals": "{x}"}]}
        self.assertEqual(self.code_of(content), 0)
        content["checks"][0]["for"]["run x"][1][1] = 3
        self.assertEqual(self.code_of(content), 1)
        content["runs"][0]["with"] = ["lost"]
        self.assertEqual(self.code_of(content), 1)

    def test_a_mesh_that_is_named_is_written_and_not_taken_from_elsewhere(self):
        written = [{"value": "summary('r0', 'meshes')", "equals": 1}]
        self.assertEqual(self.code(written), 1)
        (self.root / "scene.prm").write_text("include body.prm\n")
        (self.root / "body.prm").write_text("  set File = static_drag.msh\n")
        self.assertEqual(self.code(written), 0)
        (self.root / "static_drag.msh").write_text("")
        self.assertEqual(self.code(written), 1)
        (self.root / "static_drag.msh").write_text(body_meshes.static_drag().text())
        self.assertEqual(self.code(written), 0)

    def test_a_number_is_found_in_what_was_printed(self):
        share = "audit('r0', 'share of bytes ([0-9.]+)')"
        self.assertEqual(self.code([{"value": share, "at_most": 0.6}]), 0)
        self.assertEqual(self.code([{"value": share, "at_most": 0.5}]), 1)


if __name__ == "__main__":
    unittest.main()
