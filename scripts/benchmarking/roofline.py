# SPDX-License-Identifier: LGPL-2.1-or-later
"""Whole runs against what bandwidth and peak rate of one core would allow."""

import tempfile
from dataclasses import dataclass
from typing import Callable

from . import traffic
from .counters import Counters
from .runs import (AFFINE, CURRENT, ELASTIC, FULLY_INTEGRATED, JOHNSON_COOK, ONE_POINT, PAPER,
                   PARTICLE, rod, rod_cells)
from .tables import number, print_table

SCENE = "benchmarks/rod.prm"
JOHNSON_COOK_VARIABLES = 4  # plastic strain, plastic work, temperature, yield stress
HOURGLASS_VARIABLES = 4 * 3 + 1


@dataclass
class Case:
    label: str
    settings: list
    model: Callable  # traffic.Step of traffic.Rows
    cost: float      # about, in microseconds a node: for the number of steps


def element_case(label, formulation, material, n_points, cost):
    variables = JOHNSON_COOK_VARIABLES if material is JOHNSON_COOK else 0
    flops, own = ((traffic.ONE_POINT_CELL, HOURGLASS_VARIABLES) if n_points == 1
                  else (traffic.FULLY_INTEGRATED_CELL, 0))
    return Case(label, formulation + material,
                lambda rows: traffic.element_step(n_points, variables, own, flops), cost)


def particle_case(label, material, smoothing, extra=(), cost=0.5, **model):
    variables = JOHNSON_COOK_VARIABLES if material is JOHNSON_COOK else 0
    return Case(label, [*PARTICLE, *material, PAPER if smoothing == "paper" else AFFINE, *extra],
                lambda rows: traffic.particle_step(rows, variables, smoothing, **model), cost)


CASES = [
    element_case("one point, elastic", ONE_POINT, ELASTIC, 1, 0.1),
    element_case("one point, Johnson-Cook", ONE_POINT, JOHNSON_COOK, 1, 0.4),
    element_case("B-bar, elastic", FULLY_INTEGRATED, ELASTIC, 8, 0.25),
    element_case("B-bar, Johnson-Cook", FULLY_INTEGRATED, JOHNSON_COOK, 8, 2.),
    particle_case("particle, paper", ELASTIC, "paper", cost=0.25),
    particle_case("particle, affine", ELASTIC, "affine"),
    particle_case("particle, affine, rebuilt", ELASTIC, "affine", [CURRENT], cost=1.,
                  rebuilds=True),
    particle_case("particle, affine, Johnson-Cook", JOHNSON_COOK, "affine", cost=0.8),
]

SECONDS_OF_STEPS = 1.5  # of the longer run of a pair, about
FEWEST_STEPS = 12


def counted_run(program, counters, settings):
    with tempfile.NamedTemporaryFile() as file:
        run = program.run(SCENE, settings, prefix=counters.prefix(file.name))
        return run, counters.read(file.name)


def measure_case(program, counters, case, n_nodes, share_rows):
    cells = rod_cells(n_nodes)
    half = max(FEWEST_STEPS // 2, round(SECONDS_OF_STEPS / (1e-6 * case.cost * n_nodes) / 2))
    short, short_counts = counted_run(program, counters, rod(cells, half) + case.settings)
    long, long_counts = counted_run(program, counters, rod(cells, 2 * half) + case.settings)
    summary = long.summary
    n = summary["fe_cells"] or summary["particles"]
    # On the lattice of the rod all rows inside are the same; what is rebuilt is not compared.
    rows = traffic.Rows(long.mean_neighbours() or 0,
                        share_rows and CURRENT not in case.settings)
    model = case.model(rows)
    entity_steps = n * (long.steps() - short.steps())
    # What is in the caches all the time comes from memory by chance only.
    counted = {name: max(0., long_counts[name] - short_counts[name]) / entity_steps
               for name in long_counts}
    return {"nodes": summary["nodes"], "steps": summary["steps"],
            "neighbours": rows.neighbours, "shared_rows": rows.are_shared,
            "ns": summary.get("ns_per_cell_step") or summary["ns_per_particle_step"],
            "model_bytes": model.bytes, "model_flops": model.flops,
            "counted_bytes": counted.get("bytes"), "counted_flops": counted.get("flops")}


def add_roof(row, machine):
    """Times that bandwidth and peak rate allow, in ns; operations as counted where they were."""
    flops = row["counted_flops"] or row["model_flops"]
    row["flops_per_byte"] = flops / row["model_bytes"]
    row["bandwidth_ns"] = 1e9 * row["model_bytes"] / machine["bytes_per_second"]
    row["peak_ns"] = 1e9 * flops / machine["flops_per_second"]
    row["share_of_roof"] = max(row["bandwidth_ns"], row["peak_ns"]) / row["ns"]


def measure_roofline(program, machine, sizes, share_rows):
    counters = Counters()
    results = {}
    for case in CASES:
        results[case.label] = [measure_case(program, counters, case, size, share_rows)
                               for size in sizes]
        for row in results[case.label]:
            add_roof(row, machine)
    return results


def print_roofline(results):
    rows = [[label, f"{row['nodes']:,}", number(row["ns"]), number(row["model_bytes"]),
             number(row["counted_bytes"]), number(row["model_flops"]),
             number(row["counted_flops"]), f"{row['flops_per_byte']:.2f}",
             number(row["bandwidth_ns"]), number(row["peak_ns"]),
             f"{100 * row['share_of_roof']:.0f} %"]
            for label, run_rows in results.items() for row in run_rows]
    print_table("Roofline, one core: each cell-step or particle-step in a whole run",
                ["run", "nodes", "ns", "bytes", "from memory", "flops, model", "flops, counted",
                 "flops/byte", "ns by bandwidth", "ns by peak", "share of roof"], rows)
