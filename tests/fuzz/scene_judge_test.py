#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The judge of random scenes detects what is wrong, and a scene is a function of its number alone.

The program is a stand-in that writes the results of a run, with the fault that its environment names.
"""

import json
import os
import subprocess
import sys
import unittest

from stand_ins import PROJECT, judge_of
from fuzzing import scene_files, scene_runs, scenes

STAND_IN = r'''#!/usr/bin/python3
import json, os, re, signal, sys, time
fault = os.environ["FAULT"]
ranks = int(os.environ.get("STAND_IN_RANKS", "1"))
text = open("case.prm").read()
resumed = any(argument.startswith("--resume") for argument in sys.argv)
perturbed = "sin(17" in text
if fault == "disorder":
    fault = "energy" if "Disorder" in text else ""
if fault == "hang" or fault == "hang on ranks" and ranks > 1:
    time.sleep(100)
if fault == "signal":
    os.kill(os.getpid(), signal.SIGSEGV)
if fault == "trace":
    print("Stacktrace:")
if fault == "refused" or fault == "refused on ranks" and ranks > 1:
    print("Error: case.prm:1: entry \"Title\": not this one, but another")
    sys.exit(1)
if fault == "refused without a word":
    sys.exit(1)
code = 2 if "stop" in fault else 0
if fault == "stopped":
    print("The run stopped: the energy balance does not hold")
os.makedirs("output/checkpoint", exist_ok=True)
for name in ("log.txt", "original.prm", "parameters.prm", "checkpoint/step_1.h5", "checkpoint/step_2.h5"):
    open("output/" + name, "w").close()
json.dump({}, open("output/parameters.json", "w"))
json.dump({"ended": "failed" if code == 2 else "finished", "wall_seconds": time.time(),
           "steps": 3 if fault == "resumed summary" and resumed else 2}, open("output/summary.json", "w"))
kinetic = 1.
if fault in ("ranks", "chaos") and ranks > 1:
    kinetic += 1e-6
if fault == "chaos" and perturbed:
    kinetic += 1e-7
if fault == "resumed" and resumed:
    kinetic += 2.3e-16
row = {"time [T]": 1, "step": 2, "time step [T]": 1.2 if fault == "step" and ranks > 1 else 1,
       "kinetic energy [M L^2/T^2]": kinetic, "total energy [M L^2/T^2]": 1, "largest speed [L/T]": 1,
       "energy error": 0.06 if fault in ("energy", "stopped") else 1e-3,
       "momentum x [M L/T]": float("nan") if fault == "not finite" else 1,
       "impulse z [M L/T]": 1e-6 if fault.startswith("sum") and ranks > 1 else 0,
       "momentum drift": 1e-6 if fault == "momentum" else 1e-16,
       "heat balance error": 1e-3 if fault == "heat" else 0,
       "smallest nodal temperature [temperature]": -1e9 if fault == "temperature" else 300,
       "largest nodal temperature [temperature]": 300}
with open("output/statistics.csv", "w") as file:
    file.write(",".join(row) + "\n")
    for _ in range(2):
        file.write(",".join(map(repr, row.values()))[:-3 if fault == "cut" else None] + "\n")
if fault == "sum of large impulses":
    with open("output/conditions.csv", "w") as file:
        file.write("time [T],a impulse z [M L/T],b impulse z [M L/T]\n1,1e6,-1e6\n")
if fault == "cut":
    open("output/statistics.csv", "a").write("1,2")
sys.exit(code)
'''


class JudgeTest(unittest.TestCase):
    def setUp(self):
        self.judge = judge_of(self, scene_runs.Judge, STAND_IN, 3.)
        scene = next(scene for scene in map(scenes.drawn, range(1000)) if scene["ranks"] == 2 and scene["motion"]
                     and scene["units"] == [0, 0, 0] and scene["disorder"] and scene["contacts"])
        self.scene = dict(scene, **{"resumed on": "one"})

    def judged(self, fault):
        os.environ["FAULT"] = fault
        return self.judge.judged(self.scene)

    def assert_fails(self, fault, kind, text):
        problem = self.judged(fault).problem
        self.assertIsNotNone(problem, fault)
        self.assertEqual(problem.kind, kind, problem)
        self.assertIn(text, problem.text)

    def test_a_run_without_fault_is_one(self):
        result = self.judged("")
        self.assertIsNone(result.problem, result.problem)
        self.assertEqual(result.kind, "run")
        self.assertEqual(result.figures["resumed"], 1)
        self.assertEqual(result.figures["ranks"], 0.)
        self.assertEqual(result.figures["energy"], 1e-3)

    def test_runs_that_say_why_they_do_not_go_on_are_no_failures(self):
        for fault, kind in (("stopped", "stopped"), ("refused", "refused")):
            result = self.judged(fault)
            self.assertIsNone(result.problem, result.problem)
            self.assertEqual(result.kind, kind)
            self.assertNotEqual(result.reason, "")

    def test_hangs_and_crashes_are_noticed(self):
        self.assert_fails("hang", "hang", "it hangs")
        self.assert_fails("hang on ranks", "hang", "on 2 ranks it hangs")
        self.assert_fails("signal", "crash", "signal 11")
        self.assert_fails("trace", "crash", "Stacktrace")

    def test_missing_words_are_noticed(self):
        self.assert_fails("refused without a word", "refusal", "0 errors")
        self.assert_fails("refused on ranks", "ranks", "")
        self.assert_fails("stop", "output", "does not say why")

    def test_output_that_is_not_whole_is_noticed(self):
        self.assert_fails("not finite", "output", "nan in")
        self.assert_fails("cut", "output", "is cut")

    def test_balances_that_do_not_close_are_noticed(self):
        self.assert_fails("energy", "energy", "0.06")
        self.assert_fails("momentum", "momentum", "1e-06")
        self.assert_fails("heat", "heat", "0.001")
        self.assert_fails("temperature", "heat", "1e+09")

    def test_differences_of_ranks_are_noticed(self):
        self.assert_fails("ranks", "ranks", "kinetic energy")
        self.assert_fails("step", "ranks", "first step")
        self.assert_fails("sum of small impulses", "ranks", "impulse z")
        result = self.judged("sum of large impulses")
        self.assertIsNone(result.problem, result.problem)

    def test_ranks_may_differ_where_any_change_grows(self):
        result = self.judged("chaos")
        self.assertIsNone(result.problem, result.problem)
        self.assertGreater(result.figures["growth"], 1e-8)

    def test_differences_of_resumed_runs_are_noticed_to_the_last_bit(self):
        self.assert_fails("resumed", "resume", "kinetic energy")
        self.assert_fails("resumed summary", "resume", "steps is 3, not 2")

    def test_a_failing_scene_is_reduced_to_what_fails(self):
        problem = self.judged("disorder").problem
        scene, _ = scene_runs.shrunk(self.judge, self.scene, problem)
        self.assertGreater(scene["disorder"], 0.)
        self.assertEqual(scene["contacts"], [])
        self.assertEqual(scene["ranks"], 1)
        self.assertEqual(scene["cells"][:scene["dimension"]], [1] * scene["dimension"])


class ScenesTest(unittest.TestCase):
    def test_a_scene_is_a_function_of_its_number(self):
        program = ("import json, sys; sys.path.insert(0, %r); from fuzzing import scenes, scene_files; "
                   "print(json.dumps([scene_files.files_of(scenes.drawn(i))['case.prm'].decode() for i in range(20)]))"
                   % os.path.join(PROJECT, "scripts"))
        texts = [json.loads(subprocess.run([sys.executable, "-c", program], stdout=subprocess.PIPE, check=True,
                                           env=dict(os.environ, PYTHONHASHSEED=seed)).stdout) for seed in "12"]
        self.assertEqual(texts[0], texts[1])
        self.assertEqual(len(set(texts[0])), 20)

    def test_scenes_have_all_features(self):
        texts = [scene_files.files_of(scenes.drawn(i))["case.prm"].decode() for i in range(1, 501)]
        for piece in (
                "Type = box", "Type = disc", "Type = cylinder", "Type = spherical shell", "Disorder", "Rotation",
                "Formulation = hexahedron", "Formulation = fully integrated hexahedron", "Degree = 3",
                "Formulation = lagrange hexahedron", "Formulation = momentum consistent particle", "from a",
                "Model = elastic", "= johnson cook", "= linear hardening", "= tabular", "= quintic spline",
                "Smoothing = paper", "Smoothing = fe matched", "Smoothing = phase", "Smoothing = affine",
                "Smoothing = none", "Smoothing = 1.3", "= updated Lagrangian", "Configuration = current",
                "Shape functions = moving least squares", "Bridge = trace", "Bond failure = effective plastic strain",
                "Bond failure = principal stress", "Bond failure = shear strain", "Self-contact", "Erosion strain",
                "Conversion strain", "Conversion scaled Jacobian", "Conversion time step", "Lattice filter",
                "Mass factor", "Process time factor", "Target time step", "Surface = plane", "Surface = sphere",
                "Surface = drill", "Surface = pin and shoulder", "Surface = profile", "Surface = triangles",
                "Surface = polyline", "Friction", "Conductance", "Angle", "set Mass =", "Type = symmetry",
                "Type = traction", "Type = body force", "Type = velocity", "Type = displacement", "Type = clamp",
                "Type = temperature", "Type = heat flux", "Type = convection", "Type = radiation", "Type = adiabatic",
                "Type = heat source", "= backward Euler", "= Crank-Nicolson", "Thermal expansion = 0.001",
                "bulk viscosity", "Stress =", "Temperature = 300 +"):
            self.assertTrue(any(piece in text for text in texts), piece)

    def test_simpler_scenes_are_legal_and_others(self):
        for i in range(1, 200, 10):
            scene = scenes.drawn(i)
            candidates = list(scenes.simpler(scene))
            self.assertNotEqual(candidates, [])
            for candidate in candidates:
                self.assertNotEqual(candidate, scene)
                self.assertEqual(candidate, scenes.legal(candidate))


if __name__ == "__main__":
    unittest.main()
