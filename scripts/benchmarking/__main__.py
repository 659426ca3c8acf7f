# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command line of scripts/benchmark."""

import argparse
import json
import sys
from pathlib import Path

from . import communication, machine, peers, roofline, scaling, solutions, whole, whole_runs
from .runs import BenchmarkError, Program, rod_cells


def list_of_cells(text):
    cells = [int(one) for one in text.split(",")]
    if len(cells) != 3 or min(cells) < 2:
        raise argparse.ArgumentTypeError("three numbers of at least 2, for example 250,20,20")
    return cells


def list_of_sizes(text):
    return [int(float(one)) for one in text.split(",")]


def parse_arguments():
    parser = argparse.ArgumentParser(prog="benchmark")
    parser.add_argument("root", type=Path)
    parser.add_argument("--program", type=Path)
    for kind in ("kernels", "runs", "roofline", "scaling", "whole", "peers", "solutions"):
        parser.add_argument(f"--{kind}", action="store_true")
    parser.add_argument("--cells", type=list_of_cells)
    parser.add_argument("--steps", type=int)
    parser.add_argument("--filter")
    parser.add_argument("--sizes", default=[10 ** 4, 10 ** 5], type=list_of_sizes)
    parser.add_argument("--own-rows", action="store_true")
    parser.add_argument("--projected", default=10 ** 9, type=float)
    parser.add_argument("--latency", default=communication.Network.latency, type=float)
    parser.add_argument("--network", default=communication.Network.bandwidth, type=float)
    parser.add_argument("--rounds", default=3, type=int)
    parser.add_argument("--against", type=Path)
    parser.add_argument("--output", type=Path)
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    if arguments.against and not arguments.whole:
        parser.error("--against goes with --whole")
    if arguments.picture and not arguments.solutions:
        parser.error("--picture goes with --solutions")
    return arguments


def main():
    arguments = parse_arguments()
    binaries = arguments.root / "build/bin"
    program = Program(arguments.root, arguments.program)
    beside_the_machine = (arguments.kernels or arguments.runs or arguments.roofline
                          or arguments.scaling)
    everything = not (beside_the_machine or arguments.whole or arguments.peers or arguments.solutions)
    cells = arguments.cells or [250, 20, 20]
    results = {}
    if everything or beside_the_machine:
        results["machine"] = machine.measure_machine(binaries)
        machine.print_machine(results["machine"])
    if arguments.kernels or everything:
        results["kernels"] = machine.measure_kernels(binaries, arguments.filter)
        machine.print_kernels(results["kernels"])
    if arguments.runs or everything:
        results["runs"] = whole_runs.measure_whole_runs(program, cells,
                                                        arguments.steps or 100)
        whole_runs.print_whole_runs(results["runs"])
    if arguments.roofline:
        results["roofline"] = roofline.measure_roofline(program, results["machine"][1],
                                                        arguments.sizes, not arguments.own_rows)
        roofline.print_roofline(results["roofline"])
    if arguments.scaling:
        network = communication.Network(arguments.latency, arguments.network)
        results["scaling"] = scaling.measure_scaling(program, cells,
                                                     arguments.steps or 40, arguments.projected,
                                                     network)
        scaling.print_scaling(results["scaling"])
        communication.print_projection(results["scaling"]["projection"], arguments.projected,
                                       network)
    if arguments.whole:
        other = Program(arguments.root, arguments.against) if arguments.against else None
        results["whole"] = whole.measure_whole(program, other, arguments.root, arguments.rounds,
                                               arguments.filter)
        whole.print_whole(results["whole"])
    if arguments.peers:
        results["peers"] = peers.measure_peers(program, arguments.root, arguments.cells or rod_cells(30000),
                                               arguments.rounds)
        peers.print_peers(results["peers"])
    if arguments.solutions:
        results["solutions"] = solutions.measure_solutions(program, arguments.root, arguments.rounds,
                                                           arguments.filter)
        solutions.print_solutions(results["solutions"])
    if arguments.output:
        arguments.output.write_text(json.dumps(results, indent=2), encoding="utf-8")
    if arguments.picture:
        from plotting.solutions import draw_solutions  # only here is matplotlib needed
        print(draw_solutions(results["solutions"], arguments.picture))


if __name__ == "__main__":
    try:
        main()
    except BenchmarkError as error:
        sys.exit(f"benchmark: {error}")
