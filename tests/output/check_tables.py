# SPDX-License-Identifier: LGPL-2.1-or-later
"""Tables in HDF5 (`Table format`) beside those of comma-separated values, of sheared.prm.

    check_tables.py RANKS MPIEXEC PROGRAM SCRIPTS
"""

import random
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import h5py
import numpy as np

RANKS, MPIEXEC, PROGRAM, SCRIPTS = sys.argv[1:5]
sys.path[:0] = [SCRIPTS, str(Path(__file__).resolve().parents[1] / "loaded")]
import loaded  # noqa: E402
import tombolo  # noqa: E402
from plotting.results import Results  # noqa: E402
from reporting.run_files import RunFiles  # noqa: E402
from studying.quantities import Quantity  # noqa: E402
from tombolo import histories  # noqa: E402
from tombolo.table import Table  # noqa: E402

SCENE = Path(__file__).with_name("sheared.prm")
BOTH, HDF5 = ("Output/Table format = " + value for value in ("csv and hdf5", "hdf5"))
TABLES = {"statistics", "contact", "conditions", "parts", "probes"}
SETTINGS = ("End time = 0.8", "Output/visualization/Precision = single", "Output/Further outputs = part history",
            "Output/probes/Locations = tip: 2, 1, 1", "Output/probes/Steps = 1", "Output/contact history/Steps between rows = 3",
            "Output/contact history/Columns = floor *, ball penetration")
OPENS_AND_DIES = """
import os, sys, h5py
file = h5py.File(sys.argv[1], "r+", libver="latest")
file.swmr_mode = True
os._exit(1)
"""
CHECKPOINTS = ("Checkpoint/Step interval = 7", "Checkpoint/Keep = 1000")


class Tables(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.directory = Path(self.temporary.name)

    def command(self, name, *settings, options=(), number=5, start=(PROGRAM,)):
        scene = self.directory / "scene.prm"
        scene.write_text(SCENE.read_text("utf-8").replace("@OUTPUT@", str(self.directory / name)), "utf-8")
        command = [] if RANKS == "1" else [MPIEXEC, "-n", RANKS]
        entries = (*SETTINGS, f"Output/Number = {number}", *settings)
        return command + [*start, str(scene), *options] + [word for entry in entries for word in ("--set", entry)]

    def run_scene(self, name, *settings, options=(), code=0, number=5):
        command = self.command(name, *settings, options=options, number=number, start=loaded.start_of(PROGRAM))
        finished = subprocess.run(command, env=loaded.environment(int(RANKS)), capture_output=True, text=True, check=False)
        self.assertEqual(finished.returncode, code, finished.stdout + finished.stderr)
        return self.directory / name, finished.stdout + finished.stderr

    def tables(self, directory):
        """{name: (columns, units, rows)}, of a whole file that another program may read."""
        with h5py.File(directory / "histories.h5", "r") as file:
            return {name: (list(table.attrs["columns"]), list(table.attrs["units"]), table[:]) for name, table in file.items()}

    def check_same(self, tables, others):
        self.assertEqual(set(tables), set(others))
        for name, (columns, units, rows) in tables.items():
            self.assertEqual(columns, others[name][0])
            self.assertEqual(units, others[name][1])
            np.testing.assert_array_equal(rows, others[name][2], err_msg=name)

    def test_contents_are_those_of_the_other_format_to_the_last_digit(self):
        csv, _ = self.run_scene("csv")
        self.assertFalse((csv / "histories.h5").exists())
        both, _ = self.run_scene("both", BOTH)
        tables = self.tables(both)
        self.assertEqual(set(tables), TABLES)
        for name, (columns, units, rows) in tables.items():
            self.assertEqual((both / f"{name}.csv").read_bytes(), (csv / f"{name}.csv").read_bytes())
            table = Table(csv / f"{name}.csv")
            self.assertEqual(columns, list(table))
            self.assertEqual(["" if unit == "1" else unit for unit in units], list(table.units.values()))
            self.assertGreater(len(rows), 4)
            np.testing.assert_array_equal(rows, np.array(list(table.columns.values())).T, err_msg=name)
        self.assertIn("mm", tables["probes"][1])
        self.assertEqual([name for name in tables["contact"][0] if name.startswith("ball")], ["ball penetration"])

    def test_scripts_read_both(self):
        csv, _ = self.run_scene("csv")
        only, _ = self.run_scene("only", HDF5)
        self.assertEqual(list(only.glob("*.csv")), [])
        for name in TABLES:
            first, second = Table(csv / f"{name}.csv"), Table(only / f"{name}.csv")
            self.assertEqual(first.units, second.units)
            for column in first:
                np.testing.assert_array_equal(first[column], second[column], err_msg=column)
        self.assertEqual(set(RunFiles(csv).tables), set(RunFiles(only).tables))
        self.assertEqual([notice for notice in RunFiles(only).notices if "missing" in notice.text], [])
        self.assertEqual(len(Results(only).table("parts.csv")), len(Results(csv).table("parts.csv")))
        self.assertIsNone(Results(only).table("specimen.csv"))
        self.assertEqual(tombolo.Run(only).probes.frame().shape if has_pandas() else None,
                         tombolo.Run(csv).probes.frame().shape if has_pandas() else None)
        text = "mean of probes.csv/tip velocity x"
        self.assertEqual(Quantity(text).value(only), Quantity(text).value(csv))
        (only / "histories.h5").write_bytes((only / "histories.h5").read_bytes()[:900])
        with self.assertRaisesRegex(tombolo.TomboloError, "histories.h5 is damaged"):
            Table(only / "probes.csv")
        self.assertTrue(any("histories.h5 is damaged" in notice.text for notice in RunFiles(only).notices))

    def test_a_resumed_run_continues_the_tables(self):
        whole, _ = self.run_scene("whole", BOTH, *CHECKPOINTS)
        before = self.tables(whole)
        checkpoints = sorted((whole / "checkpoint").glob("*.h5"))
        self.assertGreater(len(checkpoints), 2)
        for number, form in enumerate((BOTH, HDF5)):
            with self.subTest(form=form):
                output, _ = self.run_scene(f"output{number}", form, *CHECKPOINTS)
                self.check_same(self.tables(output), before)
                checkpoint = output / "checkpoint" / checkpoints[1].name
                self.run_scene(f"output{number}", form, *CHECKPOINTS, options=(f"--resume={checkpoint}",))
                self.check_same(self.tables(output), before)
                self.assertEqual(bool(list(output.glob("*.csv"))), form == BOTH)
                self.assertFalse((output / "histories.h5.tmp").exists())

    def test_a_table_that_cannot_be_continued_is_told(self):
        output, _ = self.run_scene("output", HDF5, *CHECKPOINTS)
        whole = (output / "histories.h5").read_bytes()
        option = (f"--resume={sorted((output / 'checkpoint').glob('*.h5'))[1]}",)
        with h5py.File(output / "histories.h5", "a") as file:
            file["probes"].resize(2, axis=0)
        _, printed = self.run_scene("output", HDF5, *CHECKPOINTS, options=option, code=2)
        self.assertIn('its table "probes" has 2 rows', printed)
        self.assertIn("Resume into another output directory", printed)
        (output / "histories.h5").write_bytes(whole[:1000])
        _, printed = self.run_scene("output", HDF5, *CHECKPOINTS, options=option, code=2)
        self.assertIn("histories.h5: it is damaged", printed)
        (output / "histories.h5").write_bytes(whole)
        _, printed = self.run_scene("output", *CHECKPOINTS, options=option, code=1)
        self.assertIn("with `Table format = hdf5` in section \"Output\", not `csv`", printed)
        self.run_scene("output", HDF5, *CHECKPOINTS, options=option)
        self.run_scene("elsewhere", *CHECKPOINTS, options=option)

    @unittest.skipUnless(RANKS == "1", "one number of ranks is enough")
    def test_a_file_that_a_killed_run_had_open_is_read_and_continued(self):
        output, _ = self.run_scene("output", HDF5, *CHECKPOINTS)
        before = self.tables(output)
        subprocess.run([sys.executable, "-c", OPENS_AND_DIES, str(output / "histories.h5")], check=False)
        with self.assertRaises(OSError):
            h5py.File(output / "histories.h5", "r")
        np.testing.assert_array_equal(Table(output / "probes.csv")["time"], before["probes"][2][:, 0])
        self.run_scene("output", HDF5, *CHECKPOINTS, options=("--resume",))
        self.check_same(self.tables(output), before)

    @unittest.skipUnless(RANKS == "1", "one number of ranks is enough")
    def test_a_full_disk_ends_the_run_and_leaves_the_rows_before(self):
        settings = (HDF5, "Output/probes/Where = x > -1")
        whole, _ = self.run_scene("whole", *settings, number=20)
        size = sum(file.stat().st_size for file in whole.rglob("*")) * 9 // 10
        (self.directory / "disk").mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", self.directory / "disk"],
                                 capture_output=True, check=False)
        if mounted.returncode != 0:
            self.skipTest("file systems cannot be mounted here")
        self.addCleanup(subprocess.run, ["umount", self.directory / "disk"], check=True)
        finished = subprocess.run(self.command("disk/output", *settings, number=20), capture_output=True,
                                  text=True, check=False)
        self.assertEqual(finished.returncode, 2, finished.stdout + finished.stderr)
        self.assertIn("Cannot write", finished.stdout + finished.stderr)
        for name in ("probes", "statistics"):
            rows = histories.read_table(self.directory / "disk/output" / f"{name}.csv")[2]
            self.assertGreater(len(rows), 3)
            np.testing.assert_array_equal(rows, histories.read_table(whole / f"{name}.csv")[2][:len(rows)])

    @unittest.skipUnless(RANKS == "1", "one number of ranks is enough")
    def test_files_of_an_earlier_run_and_links_are_not_written_through(self):
        output, _ = self.run_scene("output", HDF5)
        elsewhere = self.directory / "elsewhere"
        elsewhere.write_text("mine", "utf-8")
        (output / "histories.h5").unlink()
        (output / "histories.h5").symlink_to(elsewhere)
        self.run_scene("output", HDF5)
        self.assertFalse((output / "histories.h5").is_symlink())
        self.run_scene("output")
        self.assertFalse((output / "histories.h5").exists())
        self.assertEqual(elsewhere.read_text("utf-8"), "mine")

    @unittest.skipUnless(RANKS == "1", "one number of ranks is enough")
    def test_a_program_that_reads_the_file_does_not_stop_the_run(self):
        output = self.directory / "output"
        process = subprocess.Popen(self.command("output", HDF5, number=200), stdout=subprocess.PIPE, text=True)
        while not (output / "histories.h5").exists() and process.poll() is None:
            time.sleep(0.002)
        n_read = 0
        while process.poll() is None:
            with histories.opened(output / "histories.h5") as file:
                n_read += 1
                time.sleep(0.01)
                self.assertNotIn("nothing", file)
        self.assertEqual(process.returncode, 0, process.communicate()[0])
        self.assertGreater(n_read, 1)

    @staticmethod
    def resumes(output):
        return ("--resume",) if list((output / "checkpoint").glob("step_*.h5")) else ()

    @staticmethod
    def is_in_hdf5(output, name):
        if not (output / "histories.h5").exists():
            return False
        with histories.opened(output / "histories.h5") as file:
            return name in file

    @unittest.skipUnless(RANKS == "1", "one number of ranks is enough")
    def test_a_killed_run_loses_no_more_than_the_other_format(self):
        settings = (BOTH, *CHECKPOINTS)
        whole, _ = self.run_scene("whole", *settings, number=150)
        expected = self.tables(whole)
        output = self.directory / "output"
        generator = random.Random(3)
        n_killed = 0
        for _ in range(8):
            process = subprocess.Popen(self.command("output", *settings, number=150, options=self.resumes(output)),
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            while not (output / "histories.h5").exists() and process.poll() is None:
                time.sleep(0.002)
            time.sleep(generator.uniform(0.3, 0.9))
            process.kill()
            printed = process.communicate()[1]
            if process.returncode == 0:
                shutil.rmtree(output)
                continue
            self.assertEqual(process.returncode, -9, printed)
            n_killed += 1
            for name in expected:
                path = output / f"{name}.csv"
                if not self.is_in_hdf5(output, name):
                    continue  # the table was about to be begun
                # A table is begun in CSV first, rows are written there first, and a run that is resumed cuts them there first.
                csv_rows = np.array(list(Table(path, leaves_out_damaged_rows=True).columns.values())).T
                rows = np.array(histories.read_table(path)[2]).reshape(-1, csv_rows.shape[1])
                n_rows = min(len(rows), len(csv_rows))
                np.testing.assert_array_equal(rows[:n_rows], csv_rows[:n_rows], err_msg=name)
                self.assertGreaterEqual(len(rows), len(csv_rows) - 2, name)
        self.assertGreater(n_killed, 3)
        if output.exists():
            self.run_scene("output", *settings, options=self.resumes(output), number=150)
            self.check_same(self.tables(output), expected)


def has_pandas():
    try:
        import pandas  # noqa: F401
    except ImportError:
        return False
    return True


if __name__ == "__main__":
    del sys.argv[1:]
    unittest.main(verbosity=2)
