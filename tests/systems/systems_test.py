#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What scripts/setup, scripts/submit and CMake print and do on other systems. usage: systems_test.py CMAKE

apt-get, dpkg-query, sbatch, srun and deal.II are stand-ins."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CMAKE = sys.argv.pop(1) if len(sys.argv) > 1 else "cmake"


class Case(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.directory = Path(temporary.name)
        self.bin = self.directory / "bin"
        self.bin.mkdir()

    def stand_in(self, name, script):
        path = self.bin / name
        path.write_text("#!/bin/sh\n" + script, "utf-8")
        path.chmod(0o755)

    def run_with(self, path, *command, **variables):
        """(exit status, all that was printed, with single blanks)"""
        finished = subprocess.run([str(word) for word in command], text=True, check=False, cwd=self.directory,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  env={**os.environ, "PATH": path, **variables})
        return finished.returncode, " ".join(finished.stdout.split())


class Setup(Case):
    def setUp(self):
        super().setUp()
        for tool in ("bash", "env", "dirname", "basename", "awk", "grep", "sed", "head", "nproc", "cat"):
            (self.bin / tool).symlink_to(shutil.which(tool))
        self.stand_in("id", "echo 0\n")

    def with_apt(self, message="", status=0, installed=False, linker=""):
        """What apt-get was called with is in the file `calls`."""
        configuration = self.directory / "deal.IIConfig.cmake"
        configuration.write_text(f'set(DEAL_II_LINKER_FLAGS "-rdynamic {linker} -Wl,-z,relro")\n', "utf-8")
        self.stand_in("apt-get", f'echo "$@" >> "{self.directory}/calls"\n'
                                 f'case "$*" in *install*) echo "{message}"; exit {status};; esac\n')
        self.stand_in("dpkg-query", f'case "$1 $2 $4" in -L*) echo "{configuration}";; '
                                    f'*mold) ;; *) {"printf installed" if installed else ":"};; esac\n')
        return self.setup()

    def setup(self, *options):
        return self.run_with(str(self.bin), ROOT / "scripts/setup", *options)

    def calls(self):
        path = self.directory / "calls"
        return path.read_text("utf-8").splitlines() if path.exists() else []

    def test_a_system_without_apt_get_is_told_what_to_install(self):
        status, printed = self.setup()
        self.assertEqual(status, 1)
        self.assertIn("neither Debian nor Ubuntu, so please install cmake c++ ninja git mpirun and deal.II 9.4", printed)
        for tool in ("cmake", "c++", "ninja", "git", "mpirun"):
            self.stand_in(tool, "")
        self.assertEqual(self.setup(), (0, ""))

    def test_nothing_is_asked_of_apt_where_all_is_there(self):
        self.assertEqual(self.with_apt(installed=True), (0, ""))
        self.assertEqual(self.calls(), [])

    def test_the_linker_of_deal_ii_comes_too(self):
        status, printed = self.with_apt(installed=True, linker="-fuse-ld=mold")
        self.assertEqual(status, 0, printed)
        self.assertTrue(self.calls()[-1].endswith("--no-install-recommends mold"), self.calls())
        self.stand_in("ld.mold", "")
        (self.directory / "calls").unlink()
        self.assertEqual(self.with_apt(installed=True, linker="-fuse-ld=mold"), (0, ""))
        self.assertEqual(self.calls(), [])

    def test_a_run_needs_nothing_that_draws(self):
        for options, draws in (((), True), (("--program",), False)):
            self.with_apt()
            self.setup(*options)
            last = self.calls()[-1]
            self.assertIn("libdeal.ii-dev", last)
            self.assertEqual("python3-vtk9" in last, draws, last)

    def test_packages_to_compare_with_come_on_request(self):
        for options, compares in (((), False), (("--peers",), True)):
            self.with_apt()
            self.setup(*options)
            self.assertEqual("lammps calculix-ccx" in self.calls()[-1], compares, self.calls()[-1])

    def test_what_hinders_apt_is_said_with_what_is_missing(self):
        for message, sentence in (
                ("E: Failed to fetch x Could not resolve y", "is there a network, and does the mirror"),
                ("E: Unable to locate package libdeal.ii-dev", "has no package of a name above; those that Tombolo needs"),
                ("E: You don't have enough free space in z", "the disk is full: please make room"),
                ("E: dpkg was interrupted", "apt-get could not install")):
            status, printed = self.with_apt(message, 100)
            self.assertEqual(status, 1)
            self.assertIn(message, printed)
            self.assertIn(sentence, printed)
            self.assertIn("libdeal.ii-dev libeigen3-dev", printed)

    def test_who_is_not_root_and_has_no_sudo_gets_the_command(self):
        self.stand_in("id", "echo 1000\n")
        status, printed = self.with_apt()
        self.assertEqual(status, 1)
        self.assertIn("as root, please run: apt-get install libdeal.ii-dev", printed)


class DealII(Case):
    def configure(self, version, without=(), more=""):
        package = self.directory / "dealii"
        package.mkdir(exist_ok=True)
        features = "".join(f"set(DEAL_II_WITH_{name} {'OFF' if name in without else 'ON'})\n"
                           for name in ("MPI", "P4EST", "TRILINOS", "HDF5", "MUPARSER"))
        (package / "deal.IIConfig.cmake").write_text(
            f"set(DEAL_II_VERSION {version})\nset(DEAL_II_PATH {package})\n{features}{more}\n"
            'macro(deal_ii_initialize_cached_variables)\nmessage(FATAL_ERROR "it will do")\nendmacro()\n', "utf-8")
        (package / "deal.IIConfigVersion.cmake").write_text(
            f"set(PACKAGE_VERSION {version})\nif(NOT {version} VERSION_LESS PACKAGE_FIND_VERSION)\n"
            "set(PACKAGE_VERSION_COMPATIBLE ON)\nendif()\n", "utf-8")
        return self.cmake(f"-DDEAL_II_DIR={package}")

    def cmake(self, *options):
        shutil.rmtree(self.directory / "build", ignore_errors=True)
        status, printed = self.run_with(os.environ["PATH"], CMAKE, "-S", ROOT, "-B", self.directory / "build", *options)
        self.assertNotEqual(status, 0)
        return printed

    def test_one_that_has_all_will_do(self):
        self.assertIn("it will do", self.configure("9.4.0"))
        self.assertIn("it will do", self.configure("9.8.0", more="set(DEAL_II_TRILINOS_WITH_EPETRA ON)"))

    def test_each_feature_that_lacks_is_named(self):
        printed = self.configure("9.6.2", ("P4EST", "MUPARSER"))
        self.assertIn("was configured without P4EST, MUPARSER, which Tombolo needs", printed)
        self.assertIn("-DDEAL_II_WITH_P4EST=ON -DDEAL_II_WITH_MUPARSER=ON", printed)
        for name in ("MPI", "P4EST", "TRILINOS", "HDF5", "MUPARSER"):
            self.assertIn(f"without {name}, which", self.configure("9.6.2", (name,)))
        self.assertIn("a Trilinos without Epetra", self.configure("9.8.0"))

    def test_one_that_is_too_old_or_not_there(self):
        printed = self.configure("9.3.3")
        self.assertIn("needs deal.II 9.4 or newer, and found 9.3.3", printed)
        self.assertIn("apt-get install libdeal.ii-dev", printed)
        self.assertIn("needs deal.II 9.4 or newer, and found none", self.cmake(f"-DDEAL_II_DIR={self.bin}"))


class Submit(Case):
    def setUp(self):
        super().setUp()
        self.log = self.directory / "calls"
        self.stand_in("srun", 'exec "$@"\n')
        # Slurm runs a copy of the script.
        self.stand_in("sbatch", 'script=$(mktemp); [ $# -gt 0 ] && cp "$2" "$script" || cat > "$script"\n'
                                'bash "$script"; status=$?; rm "$script"; exit $status\n')
        self.stand_in("program", f'echo "$@" >> "{self.log}"\n[ $(wc -l < "{self.log}") -ge 3 ] || exit 143\n')

    def submit(self, *options):
        if self.log.exists():
            self.log.unlink()
        status, printed = self.run_with(f"{self.bin}:{os.environ['PATH']}", ROOT / "scripts/submit",
                                        *options, "--program", self.bin / "program", "a file.prm", "--set", "End time = 3",
                                        TOMBOLO_JOB="")
        return status, printed, self.log.read_text("utf-8").splitlines() if self.log.exists() else []

    def test_jobs_go_on_until_the_run_is_complete(self):
        status, printed, calls = self.submit()
        self.assertEqual((status, printed), (0, ""))
        arguments = "a file.prm --set End time = 3"
        self.assertEqual(calls, [arguments, "--resume " + arguments, "--resume " + arguments])

    def test_the_number_of_jobs_is_limited(self):
        status, printed, calls = self.submit("--jobs", "2")
        self.assertEqual((status, len(calls)), (143, 2))
        self.assertIn("not complete after 2 jobs", printed)

    def test_a_run_that_fails_is_not_repeated(self):
        self.stand_in("program", f'echo "$@" >> "{self.log}"\nexit 1\n')
        status, _, calls = self.submit()
        self.assertEqual((status, len(calls)), (1, 1))

    def test_later_jobs_go_on_from_the_newest_checkpoint(self):
        _, _, calls = self.submit("--resume=old.h5")
        self.assertEqual(calls[0].split()[0], "--resume=old.h5")
        self.assertEqual(calls[1].split()[:2], ["--resume", "a"])

    def test_the_signal_comes_before_the_end(self):
        status, printed, _ = self.submit("--print", "-n", "64", "--time", "2-00:00:00", "--before", "600",
                                         "--sbatch=--partition=long")
        self.assertEqual(status, 0)
        for directive in ("--ntasks=64", "--time=2-00:00:00", "--signal=TERM@600", "--partition=long"):
            self.assertIn(f"#SBATCH {directive}", printed)

    def test_wrong_options_are_refused(self):
        for options, sentence in ((("--time", "30"), "--time needs HH:MM:SS"),
                                  (("--time", "00:05:00"), "has no time left to run"),
                                  (("-n", "0"), "-n needs a positive whole number"),
                                  (("--before", "70000", "--time", "48:00:00"), "at most 65535 seconds")):
            status, printed, _ = self.submit(*options)
            self.assertEqual(status, 1)
            self.assertIn(sentence, printed)
        (self.bin / "program").unlink()
        self.assertIn("please build it by scripts/build", self.submit()[1])


if __name__ == "__main__":
    unittest.main()
