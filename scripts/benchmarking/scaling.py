# SPDX-License-Identifier: LGPL-2.1-or-later
"""Strong and weak scaling of the rod, and what independent runs lose beside each other."""

from . import communication
from .runs import ROD_LENGTH, available_cores, rod
from .tables import number, print_table

# Label, parameter file, whether its nodes have neighbours on both sides of a cut.
SCENES = [
    ("one-point elements", "parameter_files/elastic_wave/fe.prm", False),
    ("particles, affine", "parameter_files/elastic_wave/particles.prm", True),
    ("coupled", "parameter_files/elastic_wave/coupled.prm", True),
]


def rank_counts():
    """1, 2, 4, ... and all cores."""
    cores = available_cores()
    counts = [1]
    while 2 * counts[-1] < cores:
        counts.append(2 * counts[-1])
    return sorted({*counts, cores})


def interface_settings(file, length):
    return [f"Part: steel side/Cells = x < {length / 2}"] if file.endswith("coupled.prm") else []


def settings_of(file, cells, n_steps, copies=1):
    """Of a rod of so many pieces of these cells, one after the other."""
    length = ROD_LENGTH * copies
    # Stress along the rod is exact only where its length is that of the file.
    return (rod([cells[0] * copies, *cells[1:]], n_steps, length)
            + interface_settings(file, length))


def seconds_per_step(run):
    return run.summary["step_seconds"] / run.steps()


def row_of(run, ranks, efficiency):
    return {"ranks": ranks, "nodes": run.summary["nodes"], "steps": run.steps(),
            "seconds_per_step": seconds_per_step(run),
            "ns_per_node_step": run.summary["ns_per_node_step"], "efficiency": efficiency,
            **run.summary["rank_balance"]}


def measure_scene(program, file, cells, n_steps):
    counts = rank_counts()
    # One piece of the rod a rank in weak scaling; all of the rod in strong scaling.
    piece = [max(2, cells[0] // counts[-1] // 2 * 2), *cells[1:]]
    strong, weak, shared = [], [], []
    for ranks in counts:
        run = program.run(file, settings_of(file, cells, n_steps), ranks)
        alone = strong[0]["seconds_per_step"] if strong else seconds_per_step(run)
        strong.append(row_of(run, ranks, alone / (ranks * seconds_per_step(run))))
    for ranks in counts:
        run = program.run(file, settings_of(file, piece, n_steps, ranks), ranks)
        alone = weak[0]["seconds_per_step"] if weak else seconds_per_step(run)
        weak.append(row_of(run, ranks, alone / seconds_per_step(run)))
        copies = program.run_copies(file, settings_of(file, piece, n_steps), ranks)
        slowest = max(seconds_per_step(copy) for copy in copies)
        alone = shared[0]["seconds_per_step"] if shared else slowest
        shared.append({"copies": ranks, "nodes": copies[0].summary["nodes"],
                       "seconds_per_step": slowest, "efficiency": alone / slowest})
    return {"strong": strong, "weak": weak, "independent": shared}


def measure_scaling(program, cells, n_steps, n_projected, network):
    scenes = {label: measure_scene(program, file, cells, n_steps) for label, file, _ in SCENES}
    costs = {}
    for label, _, has_both_sides in SCENES:
        most = scenes[label]["weak"][-1]
        costs[label] = communication.Costs(most["ns_per_node_step"] * (1 - most["exchange_share"]),
                                           most["exchanges_per_step"], has_both_sides)
    return {"scenes": scenes,
            "projection": communication.project_all(costs, n_projected, network)}


def percent(value):
    return f"{100 * value:.0f} %"


def print_scaling(results):
    columns = ["run", "ranks", "nodes", "ms/step", "efficiency", "of independent runs",
               "in exchanges", "work, max/mean", "exchanges", "messages", "ghosts, most",
               "kB sent/step, most"]
    for kind in ("strong", "weak"):
        rows = []
        for label, scene in results["scenes"].items():
            for row, independent in zip(scene[kind], scene["independent"]):
                rows.append([label, row["ranks"], f"{row['nodes']:,}",
                             number(1e3 * row["seconds_per_step"]), percent(row["efficiency"]),
                             percent(independent["efficiency"]), percent(row["exchange_share"]),
                             f"{row['work_max_over_mean']:.2f}",
                             f"{row['exchanges_per_step']:.1f}",
                             f"{row['messages_per_step_max']:.1f}", number(row["ghost_nodes_max"]),
                             number(row["bytes_per_step_max"] * 1e-3)])
        print_table(f"{kind.capitalize()} scaling; beside it that many independent runs of one "
                    "rank at the same time", columns, rows)
