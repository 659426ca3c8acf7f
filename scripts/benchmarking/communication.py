# SPDX-License-Identifier: LGPL-2.1-or-later
"""The time of a step on many ranks: a model of blocks that exchange their surfaces."""

from dataclasses import dataclass

from .tables import number, print_table

BYTES_PER_NODE = 32
N_NEIGHBOURS = 26  # blocks that share a face, an edge or a corner


@dataclass
class Network:
    """Of one rank, while all others use it too."""
    latency: float = 2e-6   # seconds, of a message
    bandwidth: float = 1e9  # bytes a second


@dataclass
class Costs:
    """Of a model of the rod, as they were measured."""
    ns_per_node_step: float
    exchanges_per_step: float
    has_both_sides: bool  # particles have neighbours on all sides; of cells one side owns the nodes


def ghosts_of_block(n_nodes, has_both_sides):
    """Ghost nodes of a cube of n nodes, one layer on each side or on one."""
    edge = n_nodes ** (1 / 3)
    return (edge + (2 if has_both_sides else 1)) ** 3 - n_nodes


def project(costs, n_nodes, ranks, network):
    """A step of n nodes: each rank computes on its block, then sends and receives its surface to
    and from all blocks around it, exchange after exchange, with nothing hidden."""
    own = n_nodes / ranks
    ghosts = ghosts_of_block(own, costs.has_both_sides)
    n_bytes = ghosts * BYTES_PER_NODE * costs.exchanges_per_step
    work = 1e-9 * costs.ns_per_node_step * own
    exchange = (costs.exchanges_per_step * N_NEIGHBOURS * network.latency
                + n_bytes / network.bandwidth)
    return {"ranks": ranks, "nodes_per_rank": own, "ghosts": ghosts, "bytes": n_bytes,
            "work_seconds": work, "exchange_seconds": exchange,
            "efficiency": work / (work + exchange)}


def project_all(costs_of_runs, n_nodes, network):
    return {label: [project(costs, n_nodes, ranks, network)
                    for ranks in (10 ** k for k in range(2, 7))]
            for label, costs in costs_of_runs.items()}


def print_projection(projection, n_nodes, network):
    rows = [[label, f"{row['ranks']:,}", number(row["nodes_per_rank"]), number(row["ghosts"]),
             number(row["bytes"] * 1e-3), number(row["work_seconds"] * 1e3),
             number(row["exchange_seconds"] * 1e3),
             number((row["work_seconds"] + row["exchange_seconds"]) * 1e3),
             f"{100 * row['efficiency']:.0f} %"]
            for label, run_rows in projection.items() for row in run_rows]
    print_table(f"Projection to {n_nodes:.0e} nodes: {network.latency * 1e6:g} us and "
                f"{network.bandwidth * 1e-9:g} GB/s a rank",
                ["run", "ranks", "nodes/rank", "ghosts", "kB/rank and step", "work [ms]",
                 "exchange [ms]", "step [ms]", "efficiency"], rows)
