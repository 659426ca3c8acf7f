#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Faults from outside: full disks, directories that cannot be written, killed ranks, signals at any
moment, damaged checkpoints. A run must end with a message or go on, leave nothing unreadable, and lose
no more than the steps since its last checkpoint: resumed, it is the run without the fault, bit by bit.

    faults.py PROGRAM MPIEXEC SOURCE_DIRECTORY EDIT_CHECKPOINT disk|endings|damage|all [--long] [--report]

--long injects more faults (some minutes), --report prints the table in Markdown.
"""

import atexit
import collections
import contextlib
import glob
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import checkpoint
import command_line
import run_cases
import loaded
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts"))
from fuzzing import server

EDIT = ""
LONG = False
INTERVAL = 10
NOBODY = 65534

# Rows of the table: fault -> outcome -> how often, and the most steps that were lost.
Row = collections.namedtuple("Row", "outcomes lost")
TABLE = collections.OrderedDict()


def some(short, long):
    return long if LONG else short


class Case(checkpoint.Case):
    """A run of some 300 steps with outputs, probes and checkpoints."""

    RUN = ["--quiet", "rod.prm"]

    def setUp(self):
        super().setUp()
        self.write_small_rod(
            ["set End time         = 0.5", "set End time = 30"],
            ["set Times = 0.25", "set Number = 40\n  subsection probes\n    set Locations = left: 0.2, 0.2\n"
             "    set Steps = 1\n  end"],
            checkpoints="subsection Checkpoint\n  set Step interval = %d\nend\n" % INTERVAL)
        self.make_whole(1)

    # The undisturbed runs of all tests, by rank count: directory and seconds.
    whole = {}

    def make_whole(self, ranks):
        """The undisturbed run, made once."""
        if ranks not in self.whole:
            directory = tempfile.mkdtemp(prefix="tombolo_whole_")
            atexit.register(shutil.rmtree, directory, True)
            begin = time.monotonic()
            launcher = [command_line.MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
            code, printed = self.end_of(self.start(*self.RUN, launcher=launcher, output="whole"))
            self.assertEqual(code, 0, printed)
            self.assert_clean(printed)
            shutil.copytree(self.path("whole"), directory, dirs_exist_ok=True)
            self.whole[ranks] = (directory, time.monotonic() - begin)
        self.fresh("whole")
        directory, self.seconds = self.whole[ranks]
        shutil.copytree(directory, self.path("whole"))

    def note(self, fault, outcome, lost=None):
        row = TABLE.setdefault(fault, Row(collections.Counter(), []))
        row.outcomes[outcome] += 1
        if lost is not None:
            row.lost.append(lost)

    def execute(self, *options, launcher=(), output="output", **keywords):
        """Runs to the end: exit code and what was printed."""
        if not launcher and not keywords:
            return run_cases.run([*loaded.start_of(command_line.PROGRAM), *options, "--set",
                                  "Output directory = " + output], self.directory,
                                 environment=loaded.environment(1))
        return self.end_of(self.start(*options, launcher=launcher, output=output, **keywords))

    def start(self, *options, launcher=(), output="output", program=(), **keywords):
        """Of a program that is loaded, which passes signals on, or of its file, which can be killed and limited."""
        command = [*launcher, *(program or [command_line.PROGRAM]), *options, "--set", "Output directory = " + output]
        keywords.setdefault("stdout", subprocess.PIPE)
        return subprocess.Popen(command, cwd=self.directory, stdin=subprocess.DEVNULL, stderr=subprocess.STDOUT,
                                **keywords)

    def end_of(self, process):
        printed = process.communicate()[0]
        return process.returncode, (printed or b"").decode(errors="replace")

    def assert_clean(self, printed):
        for piece in run_cases.NEVER:
            self.assertNotIn(piece, printed)

    def last_step(self, output="output"):
        """The last step in the table of the probes."""
        try:
            lines = self.read(output, "probes.csv").strip().split("\n")
            header = [name.split(" [")[0] for name in lines[0].split(",")]
            return int(float(lines[-1].split(",")[header.index("step")]))
        except (OSError, ValueError, IndexError):
            return 0

    def go_on(self, output="output"):
        """Resumes, or runs anew without a checkpoint; compares with the undisturbed run. Returns the steps
        that were lost."""
        reached = self.last_step(output)
        kept = self.checkpoints(output)
        printed = self.run_program(*(["--resume"] if kept else []), *self.RUN, "--set",
                                   "Output directory = " + output)
        found = re.search(r"Resumed from \S+: step (\d+)", printed)
        self.assertEqual(found is not None, bool(kept), printed)
        self.assert_same_results("whole", output)
        lost = reached - (int(found.group(1)) if found else 0)
        self.assertLessEqual(lost, INTERVAL)
        return max(lost, 0)

    def fresh(self, output="output"):
        shutil.rmtree(self.path(output), True)


class Disk(Case):
    """Disks that are full and directories that cannot be written."""

    def mount(self, size):
        os.makedirs(self.path("disk"), exist_ok=True)
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=%d" % size, "tmpfs", self.path("disk")],
                              stderr=subprocess.DEVNULL, check=False).returncode == 0
        if done:
            self.addCleanup(subprocess.run, ["umount", "-l", self.path("disk")], stderr=subprocess.DEVNULL,
                            check=False)
        return done

    def remount(self, options):
        subprocess.run(["mount", "-o", "remount," + options, self.path("disk")], check=True)

    def size_of(self, directory):
        return sum(os.path.getsize(os.path.join(path, name)) for path, _, names in os.walk(self.path(directory))
                   for name in names)

    def test_disk_that_fills(self):
        whole = self.size_of("whole")
        n = some(8, 60)
        for k in range(n):
            size = 4096 * (1 + int(1.3 * whole * k / n) // 4096)
            if not self.mount(size):
                self.skipTest("mounting is not allowed here")
            with self.subTest(size=size):
                code, printed = self.execute(*self.RUN, output="disk/output")
                self.check_full_disk(code, printed, "full disk", "disk/output")
            subprocess.run(["umount", self.path("disk")], check=True)

    def check_full_disk(self, code, printed, fault, output):
        self.assert_clean(printed)
        if code == 0:
            self.assert_same_results("whole", output)
            self.note(fault, "has room enough")
            return
        self.assertIn(code, (1, 2), printed)
        self.assertRegex(printed, "(Error|The run stopped): .*" + output)
        self.assertRegex(printed, "No space left|disk full|File too large|cannot be written")
        if fault == "full disk":
            self.remount("size=100m")
        self.note(fault, "refused before the first step" if code == 1 else "stops with a message",
                  self.go_on(output))

    def test_limit_of_the_size_of_files(self):
        sizes = [os.path.getsize(name) for name in glob.glob(self.path("whole", "**", "*"), recursive=True)
                 if os.path.isfile(name)]
        n = some(6, 40)
        for k in range(n):
            limit = 100 + int(1.1 * max(sizes) * (k / n) ** 2)
            with self.subTest(limit=limit):
                self.fresh()
                code, printed = self.execute(
                    *self.RUN, env=dict(os.environ, **server.ALONE),  # MPI has files, too
                    preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY)))
                self.check_full_disk(code, printed, "file-size limit", "output")

    def test_mesh_that_cannot_be_divided_for_want_of_room_leaves_no_file(self):
        scene = os.path.join(command_line.SOURCE, "parameter_files", "adaptive_refinement", "pulse.prm")
        code, printed = self.execute(
            "--quiet", scene, "--set", "End time = 1", "--set", "Output/Write solution = false",
            env=dict(os.environ, **server.ALONE),
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (60000, resource.RLIM_INFINITY)))
        self.assertEqual(code, 2, printed)
        self.assert_clean(printed)
        self.assertIn("refinement.h5.tmp cannot be written", printed)
        self.assertNotIn("refinement.h5.tmp", os.listdir(self.path("output")))

    def test_printing_to_a_full_device_or_to_nobody_does_not_end_a_run(self):
        with open("/dev/full", "w") as full:
            self.assertEqual(self.execute("rod.prm", stdout=full)[0], 0)
        self.assert_same_results("whole", "output")
        self.note("standard output on a full device", "the run goes on", 0)
        self.fresh()
        reading, writing = os.pipe()
        os.close(reading)
        process = self.start("rod.prm", stdout=writing)
        os.close(writing)
        self.assertEqual(self.end_of(process)[0], 0)
        self.assert_same_results("whole", "output")
        self.note("standard output that nobody reads", "the run goes on", 0)

    def test_directory_that_cannot_be_written(self):
        os.makedirs(self.path("closed"))
        os.chmod(self.directory, 0o755)
        os.chmod(self.path("closed"), 0o555)
        becomes = {"user": NOBODY, "group": NOBODY, "extra_groups": []} if os.getuid() == 0 else {}
        for output in ("closed", "closed/deep/output"):
            code, printed = self.execute(*self.RUN, output=output, **becomes)
            self.assertEqual(code, 1, printed)
            self.assert_clean(printed)
            self.assertRegex(printed, 'Error: --set "Output directory = %s": .*closed.* cannot be written' % output)
            self.assertEqual(os.listdir(self.path("closed")), [])
            self.note("directory of another user", "refused, nothing is written")
        if not self.mount(10000000):
            return
        self.remount("ro")
        code, printed = self.execute(*self.RUN, output="disk/output")
        self.assertEqual(code, 1, printed)
        self.assertIn("Read-only file system", printed)
        self.note("read-only file system", "refused, nothing is written")

    def test_disk_that_becomes_read_only(self):
        for wait in some((1,), range(6)):
            if not self.mount(100000000):
                self.skipTest("mounting is not allowed here")
            process = self.start(*self.RUN, output="disk/output")
            while process.poll() is None and len(self.checkpoints("disk/output")) < 1 + wait % 2:
                time.sleep(0.001)
            time.sleep(0.003 * wait)
            # Refused while a file is open for writing.
            while process.poll() is None and subprocess.run(
                    ["mount", "-o", "remount,ro", self.path("disk")], stderr=subprocess.DEVNULL,
                    check=False).returncode != 0:
                pass
            code, printed = self.end_of(process)
            self.assert_clean(printed)
            self.assertIn(code, (0, 2), printed)
            if code == 2:
                self.assertIn("Read-only file system", printed)
            self.remount("rw")
            self.note("disk becomes read-only in the run", "stops with a message" if code else "had ended",
                      self.go_on("disk/output"))
            subprocess.run(["umount", self.path("disk")], check=True)

    def test_directories_that_vanish(self):
        for name in ("solution", "checkpoint", ""):
            with self.subTest(name=name):
                self.fresh()
                process = self.start(*self.RUN)
                while process.poll() is None and len(self.checkpoints()) < 2:
                    time.sleep(0.001)
                shutil.rmtree(self.path("output", name), True)
                code, printed = self.end_of(process)
                self.assert_clean(printed)
                self.assertIn(code, (0, 2), printed)
                if code == 2:
                    self.assertRegex(printed, "The run stopped: .*output")
                self.note("directory removed in the run", "stops with a message" if code else
                          "made anew, the run goes on")


class Endings(Case):
    """Processes that are killed or requested to end."""

    def check_signalled(self, number, fault, code, printed):
        self.assert_clean(printed)
        exit_code = 128 + number
        if code == -number and os.path.exists(self.path("output", "summary.json")):
            # On its way out: the summary is the last that is written.
            self.assert_same_results("whole", "output")
            self.note(fault, "had ended", 0)
        elif code == -number:
            # Before anything is written.
            self.assertFalse(os.path.exists(self.path("output", "statistics.csv")), printed)
            self.assertFalse(os.path.exists(self.path("output", "log.txt")), printed)
            self.note(fault, "ends before it writes anything", self.go_on())
        elif code == exit_code:
            self.assertRegex(printed, r"To continue: \S+ --resume rod\.prm")
            self.note(fault, "ends the step, writes outputs and a checkpoint", self.go_on())
        else:
            self.assertEqual(code, 0, printed)
            self.assert_same_results("whole", "output")
            self.note(fault, "had ended", 0)

    def check_moments(self, number, fault, n):
        generator = random.Random(number)
        begin = time.monotonic()
        self.run_program(*self.RUN)
        seconds = time.monotonic() - begin
        for k in range(n):
            self.fresh()
            process = self.start(*self.RUN, program=loaded.start_of(command_line.PROGRAM))
            # All over the run from its start, at random within equal pieces.
            time.sleep(1.1 * seconds * (k + generator.random()) / n)
            process.send_signal(number)
            with self.subTest(k=k):
                self.check_signalled(number, fault, *self.end_of(process))

    def test_sigterm_at_any_moment(self):
        self.check_moments(signal.SIGTERM, "SIGTERM", some(10, 100))

    def test_sigint_at_any_moment(self):
        self.check_moments(signal.SIGINT, "SIGINT", some(6, 60))

    def test_sigterm_while_a_file_is_written(self):
        generator = random.Random(3)
        for pattern in ("output/checkpoint/*.tmp", "output/solution/*.tmp", "output/solution/*0.vtu"):
            for k in range(some(2, 15)):
                self.fresh()
                process = self.start(*self.RUN, program=loaded.start_of(command_line.PROGRAM))
                while process.poll() is None and not glob.glob(self.path(pattern)):
                    time.sleep(0.0003)
                time.sleep(0.002 * generator.random())
                process.send_signal(signal.SIGTERM)
                with self.subTest(pattern=pattern, k=k):
                    kind = "checkpoint" if "checkpoint" in pattern else "picture"
                    self.check_signalled(signal.SIGTERM, "SIGTERM while a %s is written" % kind,
                                         *self.end_of(process))

    def test_sigterm_twice(self):
        process = self.start(*self.RUN, program=loaded.start_of(command_line.PROGRAM))
        while process.poll() is None and not self.checkpoints():
            time.sleep(0.001)
        for _ in range(2):
            process.send_signal(signal.SIGTERM)
        self.check_signalled(signal.SIGTERM, "SIGTERM twice", *self.end_of(process))

    def test_kill_while_a_checkpoint_is_written(self):
        generator = random.Random(5)
        for k in range(some(5, 60)):
            self.fresh()
            process = self.start(*self.RUN)
            wanted = generator.randrange(4)
            while process.poll() is None and (len(self.checkpoints()) < min(wanted, 2) or not glob.glob(
                    self.path("output/checkpoint/*.tmp"))):
                time.sleep(0.0003)
            time.sleep(0.002 * generator.random())
            process.kill()
            code, printed = self.end_of(process)
            with self.subTest(k=k):
                self.assertIn(code, (-signal.SIGKILL, 0), printed)
                unfinished = bool(glob.glob(self.path("output/checkpoint/*.tmp")))
                self.note("kill -9 about the writing of a checkpoint",
                          "had ended" if code == 0 else
                          "leaves an unfinished one, which is passed over" if unfinished else "leaves whole ones",
                          self.go_on())

    def test_kill_at_any_moment(self):
        generator = random.Random(6)
        n = some(4, 60)
        for k in range(n):
            self.fresh()
            process = self.start(*self.RUN)
            time.sleep(1.1 * self.seconds * (k + generator.random()) / n)
            process.kill()
            code, printed = self.end_of(process)
            with self.subTest(k=k):
                self.assertIn(code, (-signal.SIGKILL, 0), printed)
                self.note("kill -9", "had ended" if code == 0 else "killed", self.go_on())

    def ranks_of(self, process):
        children = []
        while process.poll() is None and len(children) < 2:
            found = subprocess.run(["ps", "-o", "pid=", "--ppid", str(process.pid)], stdout=subprocess.PIPE,
                                   text=True, check=False)
            children = [int(word) for word in found.stdout.split()]
        return children

    def test_killed_rank(self):
        launcher = [command_line.MPIEXEC, "-n", "2"]
        self.make_whole(2)
        generator = random.Random(8)
        for k in range(some(2, 30)):
            self.fresh()
            process = self.start(*self.RUN, launcher=launcher)
            ranks = self.ranks_of(process)
            wanted = 1 + generator.randrange(2)
            while process.poll() is None and len(self.checkpoints()) < wanted:
                time.sleep(0.001)
            time.sleep(0.02 * generator.random())
            if process.poll() is None:
                with contextlib.suppress(ProcessLookupError):  # just ended
                    os.kill(ranks[k % 2], signal.SIGKILL)
            code = self.end_of(process)[0]
            with self.subTest(k=k):
                lost = self.last_step()
                kept = int(re.findall(r"step_(\d+)", self.checkpoints()[-1])[-1])
                printed = self.run_program("--resume", *self.RUN, "--set", "Output directory = output", ranks=2)
                self.assertIn("step %d," % kept, printed)
                self.assert_same_results("whole", "output")
                self.assertLessEqual(lost - kept, INTERVAL)
                self.note("kill -9 of one of two ranks", "all end" if code else "had ended", max(0, lost - kept))

    def test_sigterm_of_mpirun(self):
        launcher = [command_line.MPIEXEC, "-n", "2"]
        self.make_whole(2)
        for k in range(some(1, 10)):
            self.fresh()
            process = self.start(*self.RUN, launcher=launcher)
            while process.poll() is None and not self.checkpoints():
                time.sleep(0.001)
            time.sleep(0.01 * k)
            process.send_signal(signal.SIGTERM)
            code, printed = self.end_of(process)
            with self.subTest(k=k):
                self.assert_clean(printed)
                lost = self.last_step()
                kept = int(re.findall(r"step_(\d+)", self.checkpoints()[-1])[-1])
                self.run_program("--resume", *self.RUN, "--set", "Output directory = output", ranks=2)
                self.assert_same_results("whole", "output")
                self.assertLessEqual(lost - kept, INTERVAL)
                self.note("SIGTERM of mpirun, two ranks", "all end" if code else "had ended", max(0, lost - kept))


class Damage(Case):
    """Checkpoints with any of their bytes or fields changed."""

    def setUp(self):
        super().setUp()
        shutil.copytree(self.path("whole"), self.path("output"))
        self.checkpoint = self.checkpoints()[0]
        with open(self.checkpoint, "rb") as file:
            self.whole = file.read()
        listed = self.edit(self.checkpoint, "list").strip().split("\n")
        self.fields = [line.split("\t") for line in listed]
        self.assertGreater(len(self.fields), 40)

    def edit(self, *arguments):
        result = subprocess.run([EDIT, *[str(argument) for argument in arguments]], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, check=False)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def damaged(self, data):
        with open(self.path("damaged.h5"), "wb") as file:
            file.write(data)
        return "damaged.h5"

    def check_damage(self, fault, name, field=None, may_be_harmless=False):
        """Resumes from a file. Refused, it must be named, with its field where that is known; harmless,
        the run must be the undisturbed one."""
        self.fresh("resumed")
        code, printed = self.execute("--quiet", "--resume=" + name, "rod.prm", output="resumed")
        self.assert_clean(printed)
        if code == 1:
            self.assertEqual(len(re.findall(r"\bError: ", printed)), 1, printed)
            self.assertIn(name, printed)
            if field is not None:
                self.assertIn('"' + field, printed)
            self.assertFalse(os.path.exists(self.path("resumed")), printed)
            self.note(fault, "refused")
            return
        self.assertTrue(may_be_harmless and code == 0, printed)
        self.assertEqual(self.read("resumed", "statistics.csv"), self.read("whole", "statistics.csv"))
        self.note(fault, "means nothing: the same run")

    def test_flipped_bit_in_each_field(self):
        generator = random.Random(11)
        fields = [field for field in self.fields if int(field[2]) > 0]
        for name, offset, size in fields if LONG else generator.sample(fields, 12):
            for _ in range(some(1, 3)):
                data = bytearray(self.whole)
                data[int(offset) + generator.randrange(int(size))] ^= 1 << generator.randrange(8)
                with self.subTest(field=name):
                    self.check_damage("checkpoint: a bit of a field", self.damaged(data), name)

    def test_flipped_bit_anywhere(self):
        generator = random.Random(12)
        for _ in range(some(10, 300)):
            data = bytearray(self.whole)
            index = generator.randrange(len(data))
            data[index] ^= 1 << generator.randrange(8)
            with self.subTest(index=index):
                self.check_damage("checkpoint: a bit of the file", self.damaged(data), None, True)

    def test_cut(self):
        for k in range(some(6, 60)):
            with self.subTest(k=k):
                self.check_damage("checkpoint: cut", self.damaged(self.whole[:len(self.whole) * k // some(6, 60)]))

    def test_pieces_overwritten(self):
        generator = random.Random(13)
        for _ in range(some(4, 60)):
            data = bytearray(self.whole)
            begin = generator.randrange(len(data))
            n = min(generator.choice([8, 512, 4096]), len(data) - begin)
            data[begin:begin + n] = bytes(n) if generator.random() < 0.5 else generator.randbytes(n)
            with self.subTest(begin=begin):
                self.check_damage("checkpoint: a block of the disk", self.damaged(data), None, True)

    def test_fields_of_another_version(self):
        generator = random.Random(14)
        names = [field[0] for field in self.fields]
        actions = [("removed", "remove", ()), ("longer", "resize", (1, 0)), ("shorter", "resize", (-1, 0)),
                   ("empty", "resize", (-10000000, 0)), ("wider", "resize", (0, 1)),
                   ("of another kind of number", "retype", ())]
        chosen = [(name, action) for name in names for action in actions]
        for name, (what, action, numbers) in chosen if LONG else generator.sample(chosen, 24):
            with self.subTest(field=name, action=what):
                self.damaged(self.whole)
                self.edit(self.path("damaged.h5"), action, name, *numbers)
                # What continues files is not read where a run is resumed into another directory.
                self.check_damage("checkpoint: a field " + what, "damaged.h5", name,
                                  what in ("of another kind of number", "removed") or name.startswith("outputs/"))


def print_table(report):
    rows = [("fault", "times", "outcome", "steps lost, of %d between checkpoints" % INTERVAL)]
    for fault, row in TABLE.items():
        outcomes = ", ".join("%s (%d)" % each for each in row.outcomes.most_common())
        rows.append((fault, str(sum(row.outcomes.values())), outcomes,
                     "at most %d" % max(row.lost) if row.lost else ""))
    if report:
        rows.insert(1, ("---",) * 4)
        print("\n".join("| " + " | ".join(row) + " |" for row in rows))
    else:
        widths = [max(len(row[column]) for row in rows) for column in range(4)]
        print("\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths)) for row in rows))


if __name__ == "__main__":
    options = [argument for argument in sys.argv[1:] if argument.startswith("--")]
    command_line.PROGRAM, command_line.MPIEXEC, command_line.SOURCE, EDIT, subject = \
        [argument for argument in sys.argv[1:] if not argument.startswith("--")][:5]
    command_line.PROGRAM, command_line.MPIEXEC, command_line.SOURCE, EDIT = \
        [os.path.abspath(name) if os.path.exists(name) else name for name in
         (command_line.PROGRAM, command_line.MPIEXEC, command_line.SOURCE, EDIT)]
    LONG = "--long" in options
    classes = {"disk": Disk, "endings": Endings, "damage": Damage}
    suite = unittest.TestSuite(unittest.defaultTestLoader.loadTestsFromTestCase(each)
                               for name, each in classes.items() if subject in (name, "all"))
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    print_table("--report" in options)
    sys.exit(0 if result.wasSuccessful() and result.testsRun > 0 else 1)
