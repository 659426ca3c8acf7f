#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs scripts/plot on output directories made here and checks the pictures."""

import os
import shutil
import subprocess
import sys
import tempfile
import traceback
import types
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(PROJECT / "scripts"), str(Path(__file__).parent)]

import make_output  # noqa: E402
import numpy  # noqa: E402
from matplotlib import image  # noqa: E402
from plotting import __main__ as plotting_main  # noqa: E402
from plotting import fields, particle_shapes, profile, results  # noqa: E402

ALL_PICTURES = {"profile_stress_xx.png", "field_stress_xx.png", "field_velocity.png",
                "field_displacement.png", "energies.png", "probes.png", "specimen.png",
                "conditions.png"}


def started_plot(*arguments):
    return subprocess.run([sys.executable, "-B", "-m", "plotting", *map(str, arguments)],
                          env=dict(os.environ, PYTHONPATH=str(PROJECT / "scripts")),
                          capture_output=True, text=True, check=False)


def exit_code_of(function):
    """That with which Python would end after this function."""
    try:
        function()
    except SystemExit as end:
        if end.code is not None and not isinstance(end.code, int):
            print(end.code, file=sys.stderr)
            return 1
        return end.code or 0
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


def plot(*arguments):
    """The same in a copy of this process, which has loaded the packages."""
    with tempfile.TemporaryFile("w+") as printed, tempfile.TemporaryFile("w+") as complaints:
        child = os.fork()
        if child == 0:
            os.dup2(printed.fileno(), 1)
            os.dup2(complaints.fileno(), 2)
            sys.argv = ["plotting", *map(str, arguments)]
            code = exit_code_of(plotting_main.main)
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        texts = []
        for file in (printed, complaints):
            file.seek(0)
            texts.append(file.read())
        return subprocess.CompletedProcess(arguments, code, *texts)


def colours_of(picture):
    """Pixels that are not white, and the number of different colours."""
    pixels = (255 * image.imread(picture)[:, :, :3]).astype(int).reshape(-1, 3)
    return numpy.count_nonzero(pixels.min(axis=1) < 250), len(numpy.unique(pixels @ [65536, 256, 1]))


class PlotTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.rod = Path(cls.temporary.name) / "rod"
        cls.sheet = Path(cls.temporary.name) / "sheet"
        make_output.make_output(cls.rod, dim=3)
        make_output.make_output(cls.sheet, dim=2)
        cls.without_tables = Path(cls.temporary.name) / "without_tables"
        shutil.copytree(cls.rod, cls.without_tables, ignore=shutil.ignore_patterns("*.csv"))

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_all_pictures_of_a_run_are_drawn(self):
        for directory in (self.rod, self.sheet):
            finished = plot(directory)
            self.assertEqual(finished.returncode, 0, finished.stderr)
            self.assertEqual(finished.stderr, "")
            pictures = directory / "pictures"
            self.assertEqual({path.name for path in pictures.iterdir()}, ALL_PICTURES)
            self.assertEqual(len(finished.stdout.splitlines()), len(ALL_PICTURES))
            for picture in pictures.iterdir():
                n_drawn, n_colours = colours_of(picture)
                self.assertGreater(n_drawn, 5000, picture)
                self.assertGreater(n_colours, 50, picture)

    def test_times_fields_and_place_can_be_chosen(self):
        directory = Path(self.temporary.name) / "chosen"
        finished = plot(self.without_tables, "--times", "5.9", "--fields", "velocity x", "--profiles",
                        "velocity x", "--magnify", "20", "--output", directory)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        self.assertLessEqual({"profile_velocity_x.png", "field_velocity_x.png"},
                             {path.name for path in directory.iterdir()})
        self.assertFalse((directory / "field_displacement.png").exists())

    def test_a_body_can_be_cut_open(self):
        directory = Path(self.temporary.name) / "cut"
        for axis in ("y=0.6", "z=0.6"):
            finished = plot(self.without_tables, "--times", "6", "--fields", "stress xx", "--cut", axis,
                            "--output", directory)
            self.assertEqual(finished.returncode, 0, finished.stderr)
            n_drawn, n_colours = colours_of(directory / "field_stress_xx.png")
            self.assertGreater(n_drawn, 5000)
            self.assertGreater(n_colours, 50)
        for wrong, message in (("r", '"r" is not one of'), ("y=7", "nothing of the body")):
            finished = plot(self.without_tables, "--cut", wrong, "--output", directory)
            self.assertNotEqual(finished.returncode, 0)
            self.assertIn(message, finished.stderr)

    def test_a_slice_is_drawn_with_its_axes(self):
        directory = Path(self.temporary.name) / "slice"
        for slice_ in ("x=4.9", "y=0.3", "z=0.3"):
            finished = plot(self.without_tables, "--times", "6", "--fields", "stress xx", "--slice", slice_,
                            "--output", directory)
            self.assertEqual(finished.returncode, 0, finished.stderr)
            n_drawn, _ = colours_of(directory / "field_stress_xx.png")
            self.assertGreater(n_drawn, 5000)
        for wrong, message in (("x", "has no place"), ("r=1", '"r" is not one of'),
                               ("y=7", "nothing of the body lies in the slice")):
            finished = plot(self.without_tables, "--slice", wrong, "--output", directory)
            self.assertNotEqual(finished.returncode, 0)
            self.assertIn(message, finished.stderr)

    def test_a_slice_holds_what_the_plane_passes_through_now(self):
        grids = results.Results(self.rod).grids_at(6)
        for axis, cells, particles in ((1, 12 * 3, 13 * 4), (2, 12 * 3, 13 * 4)):
            slice_ = fields.sliced(grids, (axis, 0.45))
            # One of three layers of cells, and one of four of particles: positions are 0, 0.4, 0.8, 1.2.
            self.assertEqual(len(slice_["cells"].cells), cells)
            self.assertEqual(slice_["particles"].n_points, particles)
        moved = results.Results(self.rod).grids_at(6)
        moved["particles"].points = moved["particles"].points + [0, 0.4, 0]
        self.assertEqual(fields.sliced(moved, (1, 0.0)).keys(), {"cells"})

    def test_a_slice_is_seen_along_its_axis(self):
        for axis, shown in ((0, ("y", "z")), (1, ("x", "z")), (2, ("x", "y"))):
            camera = fields.SliceCamera(axis)
            self.assertAlmostEqual(numpy.linalg.det(camera.matrix), 1)
            self.assertEqual(abs(camera.matrix[2, axis]), 1)
            self.assertEqual(camera.axes, shown)

    def test_particles_are_stretched_and_turned_as_their_surroundings(self):
        start = numpy.array(list(numpy.ndindex(5, 5, 5)), dtype=float)
        for dim in (2, 3):
            points = start[start[:, 2] == 0] if dim == 2 else start
            stretch = numpy.diag([2, 0.5, 1.0])
            turn = numpy.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
            found = particle_shapes.stretches(points, points @ (turn @ stretch).T)
            numpy.testing.assert_allclose(found, numpy.tile(turn @ stretch @ turn.T, (len(points), 1, 1)), atol=1e-12)

    def test_a_particle_that_is_torn_off_is_a_ball_and_its_neighbours_are_as_before(self):
        start = numpy.array(list(numpy.ndindex(5, 5, 5)), dtype=float)
        now = start.copy()
        now[62] += [0, 0, 100]
        numpy.testing.assert_allclose(particle_shapes.stretches(start, now), numpy.tile(numpy.eye(3), (125, 1, 1)), atol=1e-12)

    def test_a_particle_without_a_bond_is_a_ball(self):
        start = numpy.array(list(numpy.ndindex(5, 5, 5)), dtype=float)
        bonds = numpy.zeros(125)
        bonds[62] = 1
        grid = types.SimpleNamespace(points=start * [2, 0.5, 1], initial_points=lambda: start,
                                     point_data={"volume": numpy.ones(125), "broken bonds": bonds})
        shapes = particle_shapes.particle_shapes(grid) / particle_shapes.particle_shapes(grid)[62, 0, 0]
        numpy.testing.assert_allclose(shapes[62], numpy.eye(3), atol=1e-12)
        numpy.testing.assert_allclose(shapes[63], numpy.diag([2, 0.5, 1]), atol=1e-12)

    def test_bodies_at_rest_have_no_picture_of_velocities(self):
        class Still(results.Results):
            def grids_at(self, time):
                grids = super().grids_at(time)
                for grid in grids.values():
                    grid.point_data["velocity"][:] = 0
                return grids

        self.assertTrue(plotting_main.moves(results.Results(self.rod), [6]))
        self.assertFalse(plotting_main.moves(Still(self.rod), [6]))

    def test_a_directory_of_stages_names_them(self):
        with tempfile.TemporaryDirectory() as directory:
            (Path(directory) / "bend").mkdir()
            (Path(directory) / "bend/statistics.csv").write_text("time\n", "utf-8")
            self.assertIn(f"directories in it have: {directory}/bend", plot(directory).stderr)

    def test_an_ellipsoid_is_the_ellipse_of_its_farthest_points(self):
        shape = numpy.array([[2, 0.3, 0.1], [0.3, 1, -0.2], [0.1, -0.2, 0.7]])
        sphere = numpy.random.default_rng(1).normal(size=(200000, 3))
        points = sphere / numpy.linalg.norm(sphere, axis=1, keepdims=True) @ shape
        root = particle_shapes.outlines(shape[None], numpy.eye(3))[0]
        inside = numpy.linalg.norm(points[:, :2] @ numpy.linalg.inv(root), axis=1)
        self.assertLessEqual(inside.max(), 1 + 1e-12)
        self.assertGreater(inside.max(), 0.9999)

    def test_a_frame_is_a_number_above_zero(self):
        directory = Path(self.temporary.name) / "frame"
        finished = plot(self.without_tables, "--times", "6", "--fields", "velocity", "--frame", "1.5", "--output", directory)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        for wrong in ("0", "-1", "inf", "wide"):
            finished = plot(self.without_tables, "--frame", wrong, "--output", directory)
            self.assertEqual(finished.returncode, 2, wrong)
            self.assertIn(wrong, finished.stderr)

    def test_a_cut_keeps_the_cells_and_particles_beyond_it(self):
        grids = results.Results(self.rod).grids_at(6)
        cells, particles = (grids[kind].beyond(1, 0.5) for kind in ("cells", "particles"))
        # Two of three cells across have their middle beyond, and two of four particles.
        self.assertEqual(len(cells.cells), 12 * 2 * 3)
        self.assertEqual(len(cells.cell_data["stress"]), 12 * 2 * 3)
        self.assertEqual(particles.n_points, 13 * 2 * 4)
        self.assertEqual(len(particles.point_data["volume"]), 13 * 2 * 4)

    def test_the_axis_of_the_cut_points_away_from_the_viewer(self):
        for cut_axis in range(3):
            camera = fields.Camera([5, 2, 1], cut_axis)
            self.assertAlmostEqual(numpy.linalg.det(camera.matrix), 1)
            self.assertLess(camera.matrix[2, cut_axis], -0.8)

    def test_what_does_not_exist_is_refused_with_the_nearest_name(self):
        finished = plot(self.rod, "--fields", "velocty")
        self.assertEqual(finished.returncode, 1)
        self.assertIn('no file has a field "velocty", did you mean "velocity"?', finished.stderr)
        self.assertNotIn("Traceback", finished.stderr)
        finished = plot(self.rod / "nowhere")
        self.assertEqual(finished.returncode, 1)
        self.assertIn("there is no directory", finished.stderr)

    def test_a_directory_without_results_is_refused(self):
        with tempfile.TemporaryDirectory() as empty:
            finished = started_plot(empty)
        self.assertEqual(finished.returncode, 1)
        self.assertIn("neither solution.pvd nor tables", finished.stderr)

    def test_damaged_files_are_refused_in_words(self):
        for name, change, message in (
                ("solution/cells_0003.0001.vtu", lambda content: content[:-200], "cells_0003.0001.vtu ends early"),
                ("statistics.csv", lambda content: content[:-3], "row 10 of .*statistics.csv is not a line of"),
                ("solution.pvd", lambda content: content[:-20], "solution.pvd is damaged")):
            with tempfile.TemporaryDirectory() as directory:
                damaged = Path(directory) / "sheet"
                shutil.copytree(self.sheet, damaged, ignore=shutil.ignore_patterns("pictures"))
                (damaged / name).write_bytes(change((damaged / name).read_bytes()))
                with self.assertRaisesRegex(results.PlotError, message):
                    run = results.Results(damaged)
                    run.grids_at(9)
                    run.table("statistics.csv")

    def test_pieces_of_all_ranks_are_read(self):
        run = results.Results(self.rod)
        self.assertEqual(list(run.files), list(make_output.TIMES))
        cells, particles = run.grid(6, "cells"), run.grid(6, "particles")
        self.assertEqual(len(cells.cells), 12 * 3 * 3)
        # Faces between cells of two ranks are no outer ones.
        self.assertEqual(len(fields.outer_faces(cells.cells)[0]), 2 * (3 * 3 + 12 * 3 + 12 * 3))
        self.assertEqual(particles.n_points, 13 * 4 * 4)
        positions, values = cells.samples("exact stress")
        numpy.testing.assert_allclose(values[:, 0], make_output.pulse(positions[:, 0], 6), atol=1e-12)

    def test_the_interface_is_where_the_shared_nodes_are(self):
        grids = results.Results(self.rod).grids_at(4)
        self.assertAlmostEqual(profile.interface_position(grids, 0, 10.0), make_output.INTERFACE)
        self.assertIsNone(profile.interface_position(grids, 1, 1.2))
        self.assertIsNone(profile.interface_position({"cells": grids["cells"]}, 0, 10.0))

    def test_samples_of_one_coordinate_become_mean_and_range(self):
        section = profile.Section(numpy.array([0, 0, 0, 1, 1, 1.0]),
                                  numpy.array([1, 2, 6, 4, 4, 4.0]), 1e-6)
        numpy.testing.assert_allclose(section.coordinate, [0, 1])
        numpy.testing.assert_allclose(section.values, [3, 4])
        numpy.testing.assert_allclose(section.lowest, [1, 4])
        numpy.testing.assert_allclose(section.highest, [6, 4])

    def test_only_outer_faces_are_drawn(self):
        _, cells = make_output.lattice(3, 0, make_output.INTERFACE)
        self.assertEqual(len(fields.outer_faces(cells)[0]), 2 * (3 * 3 + 12 * 3 + 12 * 3))

    def test_components_of_stress_are_those_of_vtk(self):
        values = numpy.array([[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]])
        found = [results.Field(f"stress {name}").of(values)[0] for name in ("xx", "yy", "zz", "xy", "yz", "xz")]
        self.assertEqual(found, [1, 2, 3, 4, 5, 6])
        self.assertAlmostEqual(results.Field("stress").of(values)[0], numpy.sqrt(3 + 3 * (16 + 25 + 36)))

    def test_headers_give_names_and_units(self):
        table = results.Results(self.rod).table("probes.csv")
        self.assertEqual(list(table.columns), ["time", "step", "tip displacement x",
                                               "middle, left velocity x"])
        self.assertEqual(table.units["tip displacement x"], "mm")
        self.assertEqual(results.Units({"length": "mm"}).label("M L/T^2"), "M mm/T^2")
        self.assertEqual(results.Units({"force": "kN"}).label("M L/T^2"), "kN")

    def test_a_field_has_the_unit_of_its_array_in_the_files(self):
        class Files:
            units = {"state of the plug-in": "GPa"}

        self.assertEqual(results.Field("state of the plug-in xx").label([Files]), "state of the plug-in xx [GPa]")
        self.assertEqual(results.Field("damage").label([Files]), "damage")


if __name__ == "__main__":
    unittest.main()
