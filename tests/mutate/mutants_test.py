#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""That the mistakes of tests/mutants.json can still be made, and what scripts/mutate makes of them."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

from mutating import copies, mutants, runs  # noqa: E402

LIST = ROOT / "tests" / "mutants.json"
SOURCE = "// licence\ndouble f(double x)\n{\n  x += 1.;\n  return 0.5 * x *\n    x;\n}\n"


def entry(**changes):
    result = {"name": "half", "mistake": "It is twice as much.", "file": "f.cc",
              "original": "0.5 * x", "mutated": "x", "tests": ["unit.base/f.mpirun=1"]}
    return {**result, **changes}


class Case(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.root = Path(temporary.name)
        (self.root / "f.cc").write_text(SOURCE, "utf-8")

    def read(self, *entries):
        path = self.root / "mutants.json"
        path.write_text(json.dumps({"mutants": entries}), "utf-8")
        return mutants.read(path)

    def mutated(self, *entries):
        return mutants.sources_with_mutants(self.root, self.read(*entries))[Path("f.cc")]

    def refusal(self, *entries):
        with self.assertRaises(mutants.ListError) as caught:
            self.mutated(*entries)
        return str(caught.exception)


class TheList(unittest.TestCase):
    def test_every_mistake_has_one_place_in_the_sources(self):
        listed = mutants.read(LIST)
        self.assertGreaterEqual(len(listed), 60)
        mutants.sources_with_mutants(ROOT, listed)

    def test_brackets_are_closed_where_they_are_opened(self):
        for mutant in mutants.read(LIST):
            for text in (mutant.original, mutant.mutated):
                for opening, closing in ("()", "[]", "{}"):
                    self.assertEqual(text.count(opening), text.count(closing), mutant.name)

    def test_every_test_that_is_named_has_a_file(self):
        for mutant in mutants.read(LIST):
            for test in mutant.tests:
                kind, name = test.split(".", 1)
                name, _, ranks = name.partition(".mpirun=")
                if kind == "program":
                    registered = (ROOT / "tests/program/tests.cmake").read_text("utf-8")
                    for word in name.replace("_is_refused", "").split("_"):
                        self.assertRegex(registered, rf"\b\w*{word}\b", mutant.name)
                    continue
                path = ROOT / "tests" / kind / (name + (".cc" if kind == "unit" else ".json"))
                self.assertTrue(path.is_file(), f"{mutant.name}: {test}")
                if ranks not in ("", "1"):
                    self.assertRegex(path.read_text("utf-8"), rf"// ranks:.*\b{ranks}\b", mutant.name)


class AMutatedSource(Case):
    def test_chooses_an_expression_whatever_its_layout(self):
        text = self.mutated(entry(original="0.5 * x * x"))
        self.assertIn("return (tombolo_mutant(0) ? (x) : (0.5 * x *\n    x));", text)
        self.assertTrue(text.startswith("// licence\n#include <tombolo/base/mutant.h>\n"))

    def test_chooses_a_statement(self):
        text = self.mutated(entry(original="x += 1.;", mutated=""))
        self.assertIn("{ if (tombolo_mutant(0)) {  } else { x += 1.; } }", text)

    def test_has_all_its_mistakes(self):
        text = self.mutated(entry(), entry(name="sum", original="x += 1.;", mutated="x -= 1.;"))
        self.assertIn("tombolo_mutant(0)", text)
        self.assertIn("{ if (tombolo_mutant(1)) { x -= 1.; } else { x += 1.; } }", text)

    def test_takes_the_first_place_after_other_words(self):
        text = self.mutated(entry(original="x", mutated="y", after="0.5"))
        self.assertIn("0.5 * (tombolo_mutant(0) ? (y) : (x)) *", text)

    def test_is_refused_where_the_original_is_missing_or_there_twice(self):
        self.assertIn("0 times", self.refusal(entry(original="0.7 * x")))
        self.assertIn("times; it must have it once", self.refusal(entry(original="x", mutated="y")))
        self.assertIn("there is no g.cc", self.refusal(entry(file="g.cc")))

    def test_is_refused_where_the_original_is_the_end_of_a_statement(self):
        self.assertIn("the end of a statement", self.refusal(entry(original="1.;", mutated="2.;")))

    def test_is_refused_where_the_original_is_cut_off(self):
        for text in ("0.5 *", "return 0.5 * x"):
            self.assertIn("neither a whole expression", self.refusal(entry(original=text, mutated="1.")))

    def test_is_refused_where_an_expression_assigns(self):
        (self.root / "f.cc").write_text(SOURCE.replace("x += 1.;", "x = 1. * x;"), "utf-8")
        self.assertIn("neither a whole expression", self.refusal(entry(original="x = 1.", mutated="x")))

    def test_is_refused_where_only_its_beginning_belongs_to_a_condition(self):
        (self.root / "f.cc").write_text(SOURCE.replace("x += 1.;", "if (x < 1.)\n    x += 1.;\n  x += 2.;"),
                                        "utf-8")
        self.assertIn("only the first statement", self.refusal(entry(original="x += 1.;\n  x += 2.;",
                                                                     mutated="")))

    def test_is_refused_where_the_original_declares(self):
        self.assertIn("declares what follows uses",
                      self.refusal(entry(original="double x", mutated="double y")))

    def test_is_refused_where_two_change_the_same_text(self):
        self.assertIn('the same text as "half"',
                      self.refusal(entry(), entry(name="other", original="0.5 * x * x", mutated="0")))
        self.assertIn("the same text", self.refusal(entry(), entry(name="other", mutated="0")))

    def test_is_refused_where_an_entry_is_wrong(self):
        self.assertIn("misspelt", self.refusal(entry(misspelt="")))
        self.assertIn("two mutants", self.refusal(entry(), entry()))
        self.assertIn("changes nothing", self.refusal(entry(mutated="0.5 * x")))
        self.assertIn("is an expression", self.refusal(entry(mutated="")))
        self.assertIn("needs names of", self.refusal(entry(tests=[])))


class ACopy(Case):
    def test_follows_the_project_and_writes_only_what_changed(self):
        copy = self.root / "build-mutate"
        (self.root / "tests").mkdir()
        (self.root / "tests" / "t.cc").write_text("", "utf-8")
        listed = self.read(entry())
        copies.renew(self.root, copy, listed)
        self.assertIn("tombolo_mutant(0)", (copy / "f.cc").read_text("utf-8"))
        self.assertTrue((copy / mutants.HEADER).is_file())
        os.utime(copy / "f.cc", (1, 1))
        (self.root / "tests" / "t.cc").unlink()
        copies.renew(self.root, copy, listed)
        self.assertEqual((copy / "f.cc").stat().st_mtime, 1)
        self.assertFalse((copy / "tests" / "t.cc").exists())


class AnEvaluation(unittest.TestCase):
    """In a directory with two tests: one fails with mutant 0, the other one with none."""

    def test_tells_what_is_killed_from_what_survives(self):
        with tempfile.TemporaryDirectory() as name:
            build = Path(name) / copies.BUILD
            build.mkdir()
            (build / "CTestTestfile.cmake").write_text(
                'add_test(unit.base/f.mpirun=1 "sh" "-c" "test \\"\\$TOMBOLO_MUTANT\\" != 0")\n'
                'add_test(unit.base/g.mpirun=1 "true")\n', "utf-8")
            tests = runs.Tests(Path(name))
            self.assertEqual(tests.failing(["unit.base/f.mpirun=1", "unit.base/g.mpirun=1"], 1), [])
            one = mutants.Mutant(0, tests=("unit.base/g.mpirun=1", "unit.base/f.mpirun=1"),
                                 name="", mistake="", file="", original="", mutated="")
            other = mutants.Mutant(1, tests=one.tests, name="", mistake="", file="", original="",
                                   mutated="")
            killed = [result.killed_by for result in tests.judge_all([one, other], 2)]
            self.assertEqual(killed, ["unit.base/f.mpirun=1", ""])
            with self.assertRaises(LookupError):
                tests.passes("unit.base/h.mpirun=1")


class TheProgram(unittest.TestCase):
    def run_it(self, *options):
        return subprocess.run([ROOT / "scripts" / "mutate", *options], capture_output=True, text=True,
                              check=False)

    def test_lists_mistakes_and_refuses_unknown_names(self):
        listed = self.run_it("--list", "--only", "trace.ghosts_of_velocity")
        self.assertEqual(listed.returncode, 0)
        self.assertIn("stale trace velocity", listed.stdout)
        refused = self.run_it("--only", "no_such")
        self.assertEqual(refused.returncode, 2)
        self.assertIn('there is no mutant "no_such"', refused.stderr)


if __name__ == "__main__":
    unittest.main()
