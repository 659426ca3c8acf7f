# SPDX-License-Identifier: LGPL-2.1-or-later
"""Whole runs of the elastic rod on one core."""

from .runs import CURRENT, FULLY_INTEGRATED, ONE_POINT, PAPER, rod
from .tables import number, print_table

# Label, parameter file, what is set besides.
WHOLE_RUNS = [
    ("hexahedron, one point", "parameter_files/elastic_wave/fe.prm", ONE_POINT),
    ("hexahedron, fully integrated", "parameter_files/elastic_wave/fe.prm", FULLY_INTEGRATED),
    ("particle, affine, functions kept", "parameter_files/elastic_wave/particles.prm", []),
    ("particle, paper, functions kept", "parameter_files/elastic_wave/particles.prm",
     [PAPER]),
    ("particle, affine, rebuilt every step", "parameter_files/elastic_wave/particles.prm",
     [CURRENT]),
    ("smoothed particle, corrected, rebuilt every step",
     "parameter_files/elastic_wave/smoothed_particles.prm", []),
    ("coupled, half and half", "parameter_files/elastic_wave/coupled.prm", []),
]
REFERENCE_RUN = WHOLE_RUNS[0][0]


def measure_whole_runs(program, cells, n_steps):
    return {label: program.run(file, rod(cells, n_steps) + settings).summary
            for label, file, settings in WHOLE_RUNS}


def print_whole_runs(runs):
    reference = runs[REFERENCE_RUN]["ns_per_node_step"]
    rows = []
    for label, summary in runs.items():
        per_node = summary["ns_per_node_step"]
        rows.append([label, f"{summary['nodes']:,}", summary["steps"],
                     number(summary.get("ns_per_cell_step")),
                     number(summary.get("ns_per_particle_step")), number(per_node),
                     number(per_node / reference),
                     number(summary["peak_memory_bytes"] / summary["nodes"])])
    print_table(f"Whole runs, one core; ratio of the node-steps to {REFERENCE_RUN}",
                ["run", "nodes", "steps", "ns/cell-step", "ns/particle-step", "ns/node-step",
                 "ratio", "peak bytes/node"], rows)
