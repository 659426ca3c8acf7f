#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What an installation has: programs, commands, parameter files and pages, and that it can be moved.

    installation.py PREFIX PROGRAM DEMANDING SOURCE

PREFIX was installed from the build of PROGRAM; DEMANDING is a program that no processor is good enough for.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PREFIX, PROGRAM, DEMANDING, SOURCE = (Path(argument) for argument in sys.argv[1:5])
IS_X86 = os.uname().machine == "x86_64"


def run(*command, **options):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, **options)


class Installation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.directory = Path(cls.temporary.name)
        # Moved, and called through links as /usr/local/bin may have them.
        cls.prefix = cls.directory / "moved here"
        shutil.copytree(PREFIX, cls.prefix, symlinks=True)
        cls.commands = cls.directory / "links"
        cls.commands.mkdir()
        for command in (cls.prefix / "bin").iterdir():
            (cls.commands / command.name).symlink_to(command)
        cls.work = cls.directory / "work"
        cls.work.mkdir()

    def works(self, name, *arguments):
        finished = run(self.commands / name, *arguments, cwd=self.work)
        self.assertEqual(finished.returncode, 0, finished.stdout + finished.stderr)
        return finished.stdout

    def test_a_shipped_scene_runs_is_drawn_and_reported(self):
        scene = self.prefix / "share/tombolo/parameter_files/elastic_wave/coupled_2d.prm"
        self.works("tombolo", "--quiet", "--set", "End time = 0.5", "--set", "Output/Times = 0.5", scene)
        output, = (path.parent for path in self.work.rglob("summary.json"))
        pictures = self.works("tombolo-plot", output).split()
        self.assertTrue(any(picture.endswith("energies.png") for picture in pictures), pictures)
        self.works("tombolo-report", output)
        self.assertIn("<html", (output / "report.html").read_text("utf-8")[:500])
        # Nothing is written into the installation.
        self.assertEqual(list(self.prefix.rglob("__pycache__")), [])

    def test_commands_explain_themselves(self):
        for name in ("tombolo-plot", "tombolo-report", "tombolo-reflection-study", "tombolo-plot-reflection",
                     "tombolo-import", "tombolo-study", "tombolo-submit"):
            self.assertIn(f"usage: {name} ", self.works(name, "--help"))
        refused = run(self.commands / "tombolo-plot", "nowhere", cwd=self.work)
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("there is no directory nowhere", refused.stderr)

    def test_the_manual_and_the_completion_know_options_and_entries(self):
        manual = (self.prefix / "share/man/man1/tombolo.1").read_text("utf-8")
        self.assertIn("\\-\\-print\\-parameters", manual)
        self.assertIn(".B End time\n(mandatory) The run ends at this time", manual)
        script = self.prefix / "share/bash-completion/completions/tombolo"
        script_text = f"""source '{script}'; COMP_WORDS=('{self.commands / "tombolo"}' "$@"); COMP_CWORD=$#; _tombolo
                    printf '%s\\n' "${{COMPREPLY[@]}}" """
        rod = str(self.prefix / "share/tombolo/parameter_files/elastic_wave/coupled.prm")
        for words, expected in ((("--res",), "--resume"), (("--set", "safety"), '"Time step/Safety factor = '),
                                ((rod, "--set", "Part: steel side/hexahedron/Hourglass lim"),
                                 '"Part: steel side/hexahedron/Hourglass limit = ')):
            found = run("bash", "-c", script_text, "bash", *words).stdout.splitlines()
            self.assertIn(expected, found)

    def test_pages_and_all_parameter_files_are_there(self):
        pages = self.prefix / "share/doc/tombolo"
        for name in ("README.md", "CHANGELOG.md", "CITATION.cff", "LICENSE", "copyright", "doc/README.md",
                     "doc/parameters.md", "doc/pictures/report.png"):
            self.assertTrue((pages / name).is_file(), name)
        for file in (SOURCE / "parameter_files").rglob("*.*"):
            self.assertTrue((self.prefix / "share/tombolo" / file.relative_to(SOURCE)).exists(), file)
        self.assertEqual(list((self.prefix / "share/tombolo/scripts").glob("*setup*")), [])

    def test_versions_agree(self):
        version = json.loads(self.works("tombolo", "--version"))
        declared = re.search(r"project\(Tombolo VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text("utf-8")).group(1)
        self.assertEqual(version["tombolo"], declared)
        self.assertIn("architecture", version)
        self.assertIn(f"\nversion: {declared}\n", (SOURCE / "CITATION.cff").read_text("utf-8"))
        self.assertIn(f"\n## {declared}", (SOURCE / "CHANGELOG.md").read_text("utf-8"))
        text = (PROGRAM.parent.parent / "CPackConfig.cmake").read_text("utf-8")
        self.assertIn(f'set(CPACK_PACKAGE_VERSION "{declared}")', text)

    @unittest.skipUnless(IS_X86, "extensions are those of x86-64")
    def test_a_processor_that_lacks_something_is_refused_before_anything_else_runs(self):
        refused = run(DEMANDING)
        self.assertEqual(refused.returncode, 1)
        self.assertEqual(refused.stdout, "")
        self.assertIn("built for processors like x86-64-v9. This processor lacks:", refused.stderr)
        self.assertIn("avx512er", refused.stderr)
        self.assertNotIn("sse4.2", refused.stderr)

    @unittest.skipUnless(IS_X86 and shutil.which("objdump"), "needs objdump")
    def test_the_look_at_the_processor_uses_no_extension(self):
        text = run("objdump", "-d", "--no-show-raw-insn", PROGRAM).stdout
        for name in ("refuse_unsuitable_processor", "__cpu_indicator_init"):
            match = re.search(rf"^\S+ <[^>]*{name}[^>]*>:\n(.*?)(?:\n\n|\Z)", text, re.S | re.M)
            self.assertIsNotNone(match, name)
            self.assertGreater(match.group(1).count("\n"), 20)
            self.assertIsNone(re.search(r"\t(v[a-z0-9]+) .*%[xyz]mm", match.group(1)), name)
        sections = run("objdump", "-h", PROGRAM).stdout
        self.assertIn(".preinit_array", sections)


if __name__ == "__main__":
    del sys.argv[1:]
    unittest.main(verbosity=2)
