# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes the whole output of a run, as small as can be: that of tests/plot with a wall, the input
and a log."""

import json
import sys
from pathlib import Path

import numpy
from vtk import VTK_LINE, VTK_TRIANGLE

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "plot"))

import make_output  # noqa: E402

TITLE = "rod </script><script>document.title = 'taken'</script> & wall"

PARAMETERS = """{
  "Title": %s,
  "Dimension": %d,
  "Parts": "rod",
  "Contacts": "wall",
  "Conditions": "load",
  "End time": 9,
  "Unit labels": "length: mm, time: ms, stress: GPa",
  "Part: rod": {
    "Formulation": "momentum consistent particle",
    "momentum consistent particle": { "Dilation": 1.80, "Smoothing": "paper", "Self-contact": false }
  },
  "Time step": { "Safety factor": 8.5e-1, "Fixed": 1e-3 },
  "Process: mine": { "Colour": "red" }
}
"""

LOG = """Tombolo: rod
Model: 208 nodes, 108 elements
Warning: 3 cells of <the mesh> are turned.
  part "rod": 208 material points
  0.0 %  t = 0  step 0  Δt = 0.1  0 node-steps/s  left ?  energy error 0
100.0 %  t = 9  step 90  Δt = 0.1  1e+05 node-steps/s  left 0:00  energy error 1e-4
"""

SUMMARY = {"ended": "finished", "title": TITLE, "dimension": 3, "nodes": 208, "fe_cells": 108, "particles": 208,
           "ranks": 2, "steps": 90, "simulated_time": 9.0, "time_step_max": 0.1, "energy_error_relative": 1e-4,
           "momentum_drift_relative": 1e-16, "wall_seconds": 0.5, "versions": {"tombolo": "0.1.0", "git": "abc"},
           "units": {"length": "mm", "time": "ms", "stress": "GPa"},
           "seconds_per_phase": {"particle forces": 0.2, "motion": 0.1},
           "results": {"contact": {"wall": {"impulse": [0.0, 1.0], "largest_penetration": None}}}}


def write_wall(directory, dim):
    points = numpy.array([[0, -1, 0], [0, 2, 0]] if dim == 2 else [[0, -1, -1], [0, 2, -1], [0, 2, 2], [0, -1, 2]], float)
    cells = numpy.array([[0, 1]] if dim == 2 else [[0, 1, 2], [0, 2, 3]])
    entries = []
    for number, time in enumerate(make_output.TIMES):
        name = f"solution/tools_{number:04}.vtu"
        make_output.write_grid(directory / name, points, cells, VTK_LINE if dim == 2 else VTK_TRIANGLE,
                               {"initial position": points, "displacement": 0 * points}, {})
        entries.append(f'<DataSet timestep="{time}" group="" part="0" name="tools" file="{name}"/>')
    (directory / "tools.pvd").write_text('<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1"><Collection>\n'
                                         + "\n".join(entries) + "\n</Collection></VTKFile>\n", encoding="utf-8")


def write_contact(directory):
    time = numpy.linspace(0, 9, 1000)
    # One peak between many rows, which the chart must keep.
    force = numpy.where(numpy.arange(1000) == 501, 7.0, numpy.sin(time))
    make_output.write_table(directory / "contact.csv", {
        "time [ms]": time, "step": numpy.arange(1000), "wall mean force x [kg mm/ms^2]": force,
        "wall mean force y [kg mm/ms^2]": 0 * time, "wall mean torque z [mJ]": numpy.cos(time),
        "wall penetration [mm]": 1e-3 * time, "wall work [mJ]": time})


def make_run(directory, dim=3):
    directory = Path(directory)
    make_output.make_output(directory, dim)
    (directory / "parameters.json").write_text(PARAMETERS % (json.dumps(TITLE), dim), encoding="utf-8")
    (directory / "log.txt").write_text(LOG, encoding="utf-8")
    (directory / "summary.json").write_text(json.dumps(SUMMARY), encoding="utf-8")
    write_contact(directory)
    write_wall(directory, dim)
