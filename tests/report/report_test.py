#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs scripts/report on outputs made here, whole and damaged, and reads the pages."""

import base64
import contextlib
import html.parser
import io
import json
import math
import os
import re
import shutil
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "python"), str(Path(__file__).parent)]

from script_testing import run_module  # noqa: E402
import make_run  # noqa: E402
import numpy  # noqa: E402
from plotting.results import PlotError, Table  # noqa: E402
import reporting.__main__  # noqa: E402
from reporting import asked, bodies, charts, frames, pictures, report, run_files, units  # noqa: E402

NO_PICTURE = mock.patch.object(pictures.Painter, "draw", lambda painter, shot, one: "data:image/png;base64,")


def main(*arguments):
    """What the command returns and prints as errors, in this process."""
    printed = io.StringIO()
    with contextlib.redirect_stderr(printed), contextlib.redirect_stdout(io.StringIO()), NO_PICTURE:
        try:
            reporting.__main__.main([str(argument) for argument in arguments])
            return 0, printed.getvalue()
        except SystemExit as ending:
            return 1, str(ending.code)


class Reader(html.parser.HTMLParser):
    """The text, addresses and data of a page; elements must be closed in their order."""

    VOID = {"meta", "input", "img", "br"}

    def __init__(self, text):
        super().__init__()
        self.open, self.words, self.addresses, self.data, self.mistakes = [], [], [], {}, []
        self.feed(text)
        self.close()
        self.text = " ".join(" ".join(self.words).split())

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.addresses += [attributes[key] for key in ("src", "href") if key in attributes]
        if tag not in self.VOID:
            self.open.append((tag, attributes.get("id")))

    def handle_startendtag(self, tag, attributes):
        pass

    def handle_endtag(self, tag):
        if not self.open or self.open.pop()[0] != tag:
            self.mistakes.append(f"{tag} at {self.getpos()}")

    def handle_data(self, data):
        inside = self.open[-1] if self.open else ("", None)
        if inside[0] == "script" and inside[1]:
            self.data[inside[1]] = json.loads(data)
        elif inside[0] not in ("script", "style"):
            self.words.append(data)


class WholeRun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.rod = Path(cls.temporary.name) / "rod"
        make_run.make_run(cls.rod)
        cls.finished = run_module("reporting", cls.rod)
        assert cls.finished.returncode == 0, cls.finished.stderr
        cls.page = (cls.rod / "report.html").read_text("utf-8")
        cls.reader = Reader(cls.page)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_the_page_is_well_formed_and_needs_no_other_file(self):
        self.assertEqual(self.reader.mistakes, [])
        self.assertEqual(self.reader.open, [])
        for address in self.reader.addresses:
            self.assertRegex(address, "^(#|data:image/png;base64,)")
        self.assertNotRegex(self.page, r"https?://|@import|url\(")

    def test_what_was_asked_is_what_differs_from_the_defaults(self):
        parameters = run_files.RunFiles(self.rod).parameters
        entries = {entry.name: entry for entry in asked.entries(parameters, asked.read_defaults())}
        for name, differs in (("Title", True), ("Smoothing", True), ("Fixed", True), ("Formulation", True),
                              ("Dilation", False), ("Safety factor", False), ("Self-contact", False)):
            self.assertEqual(entries[name].differs, differs, name)
        self.assertEqual(entries["Smoothing"].default, "affine")
        self.assertIsNone(entries["Colour"].default)
        self.assertTrue(entries["Colour"].differs)
        self.assertIn("Smoothing paper affine", self.reader.text)

    def test_every_energy_is_named_and_warnings_are_shown(self):
        for name in Table(self.rod / "statistics.csv").columns:
            if name not in ("time", "step"):
                self.assertIn(name, self.reader.text)
        self.assertIn("3 cells of <the mesh> are turned.", self.reader.text)
        self.assertIn("warning: 3 cells of <the mesh> are turned.", self.finished.stderr)
        self.assertIn("Model: 208 nodes, 108 elements", self.reader.text)

    def test_forces_of_contacts_and_conditions_are_shown(self):
        self.assertIn("Contact forces wall", self.reader.text)
        self.assertIn("Condition forces wall", self.reader.text)
        self.assertIn("load", self.reader.text)
        peaks = [max(value for value in line if value is not None) for chart in self.reader.data["chart-numbers"]
                 for line in chart["y"]]
        self.assertTrue(any(math.isclose(peak, 7.0) or math.isclose(peak, 7000.0) for peak in peaks))

    def test_stages_have_a_page_each_and_one_that_leads_to_them(self):
        with tempfile.TemporaryDirectory() as temporary:
            scene = Path(temporary)
            for name in ("bend", "release"):
                make_run.make_run(scene / name)
                (scene / name / "original.prm").write_text("set Stages = bend, release, cool # of a sheet\n", "utf-8")
            finished = run_module("reporting", scene)
            self.assertEqual(finished.returncode, 0, finished.stderr)
            front = Reader((scene / "report.html").read_text("utf-8"))
            self.assertEqual([address for address in front.addresses if "#" not in address],
                             ["bend/report.html", "release/report.html"])
            bend = Reader((scene / "bend/report.html").read_text("utf-8"))
            self.assertIn("3 cells of <the mesh> are turned.", bend.text)
            self.assertIn("Stage 1 of 2: bend", bend.text)
            self.assertIn("../report.html", bend.addresses)
            self.assertEqual(run_module("reporting", scene, "--output", scene / "all stages.html").returncode, 0)
            self.assertIn("../all%20stages.html", Reader((scene / "bend/report.html").read_text("utf-8")).addresses)
            (scene / "bend/report.html").write_text("mine", "utf-8")
            self.assertIn("exists and is no report", run_module("reporting", scene).stderr)

    def test_a_title_cannot_leave_its_place(self):
        self.assertNotIn("<script>document.title", self.page)
        self.assertIn(make_run.TITLE, self.reader.text)

    def test_the_view_holds_all_outputs_in_few_bytes(self):
        view = self.reader.data["view-data"]
        self.assertEqual([frame["time"] for frame in view["frames"]], ["0 s", "4 ms", "6 ms", "9 ms"])
        first, last = view["frames"][0], view["frames"][-1]
        faces = numpy.frombuffer(base64.b64decode(first["faces"]), "<u4").reshape(-1, 4)
        self.assertEqual(len(faces), 2 * (3 * 3 + 12 * 3 + 12 * 3))
        self.assertEqual(last["faces"], 0)  # the faces are those of the first frame
        particles = numpy.frombuffer(base64.b64decode(last["particles"]), "<u2").reshape(-1, 3)
        positions = numpy.array(view["low"]) + particles / 65535 * numpy.array(view["span"])
        written = bodies.Grid(self.rod / "solution/particles_0003.pvtu").points
        numpy.testing.assert_allclose(positions, written, atol=2e-4)
        self.assertGreater(len(base64.b64decode(last["arrows"])), 0)
        self.assertGreater(len(base64.b64decode(first["tools"])), 0)

    def test_colours_span_the_1st_to_99th_percentile(self):
        one = bodies.ShownField("stress", "Stress", "GPa", "viridis", low=1.0, high=3.0)
        levels = frames.coloured(numpy.array([0.0, 1.0, 2.0, 3.0, 9.0, numpy.nan]), one)
        self.assertEqual(levels.tolist(), [1, 1, 128, 255, 255, 0])
        run = run_files.RunFiles(self.rod)
        seen = bodies.Bodies(run, wanted_fields=["displacement"])
        seen.set_ranges(seen.times)
        values = numpy.concatenate([seen.snapshot(time).values("displacement") for time in seen.times])
        numpy.testing.assert_allclose([seen.fields[0].low, seen.fields[0].high], numpy.percentile(values, (1, 99)))

    def test_tools_in_two_dimensions_are_ribbons(self):
        triangles = frames.ribbons(numpy.array([[[0, 0, 0], [3, 4, 0]], [[1, 1, 0], [1, 1, 0.0]]]), 0.1)
        areas = numpy.linalg.norm(numpy.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1) / 2
        numpy.testing.assert_allclose(areas, [0.25, 0.25, 0, 0], atol=1e-12)

    def test_pictures_show_body_force_and_tool(self):
        images = re.findall(r'<img src="data:image/png;base64,([^"]+)"', self.page)
        self.assertEqual(len(images), pictures.MAXIMUM_FIELDS * 4)
        with tempfile.NamedTemporaryFile(suffix=".png") as file:
            file.write(base64.b64decode(images[3]))
            file.flush()
            from matplotlib import image
            pixels = (255 * image.imread(file.name)).astype(int).reshape(-1, 4)
        red = int(pictures.FORCE_COLOUR[1:3], 16)
        self.assertGreater(numpy.count_nonzero((abs(pixels[:, 0] - red) < 3) & (pixels[:, 1] < 60) & (pixels[:, 3] > 250)), 20)
        self.assertGreater(len(numpy.unique(pixels, axis=0)), 100)

    def test_two_dimensions_and_a_cut_are_drawn(self):
        sheet = Path(self.temporary.name) / "sheet"
        make_run.make_run(sheet, dim=2)
        with NO_PICTURE:
            text, _ = report.make_report(sheet)
            self.assertTrue(Reader(text).data["view-data"]["flat"])
            text, _ = report.make_report(self.rod, cut=(1, 0.6), fields=["velocity"])
        view = Reader(text).data["view-data"]
        self.assertEqual([field["title"] for field in view["fields"]], ["Velocity"])
        self.assertLess(len(base64.b64decode(view["frames"][0]["particles"])), 13 * 4 * 4 * 6)

    def test_another_file_is_not_overwritten_unless_asked(self):
        run = Path(self.temporary.name) / "log only"
        run.mkdir()
        shutil.copy(self.rod / "log.txt", run)
        target = Path(self.temporary.name) / "mine.html"
        target.write_text("mine", encoding="utf-8")
        code, printed = main(run, "--output", target)
        self.assertEqual(code, 1)
        self.assertIn("is no report", printed)
        self.assertEqual(target.read_text("utf-8"), "mine")
        self.assertEqual(main(run, "--output", target, "--overwrite")[0], 0)
        self.assertEqual(main(run, "--output", target)[0], 0)
        self.assertIn("Model: 208 nodes", target.read_text("utf-8"))

    def test_what_does_not_exist_is_refused(self):
        empty = Path(self.temporary.name) / "empty"
        empty.mkdir()
        for arguments, message in (((self.rod / "nowhere",), "there is no directory"), ((empty,), "is not the output of a run"),
                                   ((self.rod, "--fields", "velocty"), 'no file has a field "velocty"'),
                                   ((self.rod, "--output", empty), "is a directory")):
            code, printed = main(*arguments)
            self.assertEqual(code, 1)
            self.assertIn(message, printed)
        self.assertEqual(list(empty.iterdir()), [])

    def test_columns_that_are_not_finite_leave_gaps(self):
        with tempfile.TemporaryDirectory() as directory:
            Path(directory, "t.csv").write_text("time [s],energy error\n0,0\n1,inf\n2,nan\n3,\n4,1\n", encoding="utf-8")
            text, numbers = charts.draw(charts.Chart("Error", Table(Path(directory, "t.csv")), ["energy error"]))
        self.assertEqual(numbers["y"], [[0.0, None, None, None, 1.0]])
        self.assertNotIn("nan", text)


class DamagedRun(unittest.TestCase):
    """The report of a damaged output is made and states what is missing."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.whole = Path(cls.temporary.name) / "whole"
        make_run.make_run(cls.whole)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def setUp(self):
        self.run_directory = Path(self.temporary.name) / "run"
        shutil.copytree(self.whole, self.run_directory)
        self.addCleanup(shutil.rmtree, self.run_directory)

    def reported(self, *messages):
        with NO_PICTURE:
            text, notices = report.make_report(self.run_directory)
        reader = Reader(text)
        self.assertEqual(reader.mistakes, [])
        notice_text = " ".join(notice.text for notice in notices)
        for message in messages:
            self.assertRegex(notice_text, message)
            self.assertRegex(reader.text, message)
        return reader

    def change(self, name, change):
        path = self.run_directory / name
        path.write_bytes(change(path.read_bytes()))

    def test_tables_that_are_missing_empty_or_cut_off(self):
        cut = (lambda content: content[:-9], "statistics.csv is damaged: 1 rows are left out, the first of them row 10")
        for change, message in ((None, "statistics.csv is missing"), (lambda _: b"", "statistics.csv is empty"),
                                (lambda content: content.splitlines()[0] + b"\n", "a header and no whole row"),
                                (lambda _: bytes(range(256)) * 9, "statistics.csv"), cut):
            if change is None:
                (self.run_directory / "statistics.csv").unlink()
            else:
                shutil.copy(self.whole / "statistics.csv", self.run_directory)
                self.change("statistics.csv", change)
            self.reported(message)
        (self.run_directory / "contact.csv").unlink()
        self.reported("contact.csv is missing")

    def test_pictures_that_are_missing_empty_or_cut_off(self):
        (self.run_directory / "solution/cells_0000.0001.vtu").unlink()
        self.change("solution/cells_0001.0001.vtu", lambda _: b"")
        self.change("solution/particles_0002.0000.vtu", lambda content: content[:len(content) // 2])
        reader = self.reported(r"t = 0 s is left out: solution/cells_0000.0001.vtu is missing",
                               r"t = 4 ms is left out: solution/cells_0001.0001.vtu ends early",
                               r"t = 6 ms is left out: solution/particles_0002.0000.vtu ends early")
        self.assertEqual([frame["time"] for frame in reader.data["view-data"]["frames"]], ["9 ms"])
        self.change("solution/cells_0003.pvtu", lambda _: b"<VTKFile>")
        reader = self.reported("No output of solution.pvd can be read")
        self.assertNotIn("view-data", reader.data)

    def test_content_of_pictures_that_is_damaged(self):
        garbled = re.compile(rb"(<AppendedData[^>]*>\s*_|format=\"binary\"[^>]*>\s*)(.{300})", re.DOTALL)
        self.change("solution/particles_0003.0000.vtu", lambda content: garbled.sub(lambda m: m.group(1) + b"A" * 300, content))
        self.reported("t = 9 ms is left out: solution/particles_0003.pvtu")

    def test_series_that_are_missing_or_damaged(self):
        self.change("tools.pvd", lambda content: content[:80])
        self.reported("tools.pvd is damaged")
        self.change("solution.pvd", lambda content: content[:80])
        self.reported("solution.pvd is damaged, there are no pictures")
        (self.run_directory / "solution.pvd").unlink()
        self.reported("solution.pvd is missing")

    def test_tools_that_are_damaged_are_left_out(self):
        self.change("solution/tools_0002.vtu", lambda content: content[:100])
        reader = self.reported("The tools at t = 6 ms are not drawn: solution/tools_0002.vtu ends early")
        self.assertEqual(len(reader.data["view-data"]["frames"]), 4)

    def test_a_run_that_goes_on_or_was_killed(self):
        (self.run_directory / "summary.json").unlink()
        self.reported("The run has not ended.* Its log ends at t = 9, step 90")
        self.change("log.txt", lambda _: b"")
        self.reported("log.txt is missing or empty")

    def test_a_run_that_stopped_was_interrupted_or_resumed(self):
        for more, message in (({"ended": "failed", "failure": "The <energy> is lost."}, "The run stopped: The <energy> is lost."),
                              ({"ended": "interrupted"}, "The run was interrupted before its end time"),
                              ({"resumed_from_step": 40}, "The run was resumed at step 40")):
            (self.run_directory / "summary.json").write_text(json.dumps(dict(make_run.SUMMARY, **more)), encoding="utf-8")
            self.reported(message)

    def test_summary_and_parameters_that_are_damaged(self):
        self.change("summary.json", lambda content: content[:100])
        self.change("parameters.json", lambda content: content[:100])
        self.reported("summary.json is damaged", "parameters.json is damaged", "The run has not ended")
        self.change("summary.json", lambda _: b"[1]")
        (self.run_directory / "parameters.json").unlink()
        self.reported("summary.json is damaged", "the report cannot say what was asked")

    def test_large_errors_are_pointed_at(self):
        table = (self.run_directory / "statistics.csv").read_text("utf-8").splitlines()
        column = table[0].split(",").index("energy error")
        row = table[4].split(",")
        row[column] = "0.2"
        table[4] = ",".join(row)
        (self.run_directory / "statistics.csv").write_text("\n".join(table) + "\n", encoding="utf-8")
        self.reported("The energy error reaches 0.2, more than 0.01")

    def test_a_file_whose_reading_ends_the_process_is_left_out(self):
        read = bodies.Grid.__init__

        def end(grid, path):
            if path.name.startswith("cells_0001"):
                os.abort()
            read(grid, path)

        with mock.patch.object(bodies.Grid, "__init__", end):
            reader = self.reported("t = 4 ms is left out: its files are damaged")
        self.assertEqual(len(reader.data["view-data"]["frames"]), 3)

    def test_rows_without_a_time_are_left_out(self):
        self.change("contact.csv", lambda content: content.replace(b"\n9.0,", b"\nnan,"))
        self.reported("contact.csv has 1 rows without a time")

    def test_a_log_alone_makes_a_report(self):
        for path in list(self.run_directory.iterdir()):
            if path.name != "log.txt":
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        reader = self.reported("statistics.csv is missing", "solution.pvd is missing")
        self.assertIn("Model: 208 nodes", reader.text)

    def test_the_reader_of_plots_refuses_damaged_rows(self):
        self.change("probes.csv", lambda content: content[:-3])
        with self.assertRaisesRegex(PlotError, "row 200 of .*probes.csv is not a line of 4 numbers"):
            Table(self.run_directory / "probes.csv")


class SmallParts(unittest.TestCase):
    def test_units_become_those_of_si_with_a_prefix(self):
        for value, unit, text in ((1e-4, "s", "100 µs"), (184, "kg m^2/s^2", "184 J"), (4e8, "kg/(m s^2)", "400 MPa"),
                                  (0.0254, "m", "25.4 mm"), (2e4, "kg m/s^2", "20 kN"), (3, "t mm/s^2", "3 N"),
                                  (3, "t/(mm s^2)", "3 MPa"), (1e-3, "GPa", "1 MPa"), (0.0102, "kg", "10.2 g"),
                                  (298, "K", "298 K"), (1, "M L/T^2", "1 M L/T²"), (5, "", "5"), (0, "kg", "0 kg"),
                                  (9, "ms", "9 ms"), (3, "furlong/s", "3 furlong/s"), (1, "kg/(m", "1 kg/(m")):
            self.assertEqual(units.quantity(value, unit), text)
        self.assertEqual(units.quantity(2, "kg m^2/s^2", "mean torque x"), "2 N m")

    def test_numbers_are_plain_or_have_a_power_of_ten(self):
        for value, text in ((2281.3, "2281"), (0.00123456, "0.001235"), (-1.5e-9, "−1.5·10⁻⁹"), (0, "0"), (1e7, "1·10⁷"),
                            (math.nan, "–"), (math.inf, "∞")):
            self.assertEqual(units.number(value), text)

    def test_ticks_are_round_and_inside(self):
        for low, high in ((0, 1), (-3e-7, 2e-7), (298, 560), (0, 1e9), (99.99, 100.01)):
            values, digits = charts.ticks(low, high)
            self.assertGreaterEqual(len(values), 3)
            self.assertTrue(all(low - 1e-6 * (high - low) <= value <= high + 1e-6 * (high - low) for value in values))
            self.assertEqual(len({charts.tick_text(value, digits) for value in values}), len(values))

    def test_times_are_chosen_evenly_with_both_ends(self):
        self.assertEqual(bodies.evenly(list(range(11)), 3), [0, 5, 10])
        self.assertEqual(bodies.evenly([1, 2], 9), [1, 2])
        self.assertEqual(bodies.evenly([1, 2, 3], 1), [3])


if __name__ == "__main__":
    unittest.main()
