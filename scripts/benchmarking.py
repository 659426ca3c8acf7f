"""Runs the benchmark programs and whole runs, and prints one table; see scripts/benchmark --help."""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

LENGTH = 10.0  # of the rod

ONE_POINT = "Part: rod/Formulation = hexahedron"
FULLY_INTEGRATED = "Part: rod/Formulation = fully integrated hexahedron"
CURRENT = "Part: rod/momentum consistent particle/Configuration = current"
PAPER = "Part: rod/momentum consistent particle/Smoothing = paper"

# Label, parameter file below parameter_files/elastic_wave/, what is set besides.
WHOLE_RUNS = [
    ("hexahedron, one point", "fe.prm", [ONE_POINT]),
    ("hexahedron, fully integrated", "fe.prm", [FULLY_INTEGRATED]),
    ("particle, affine, functions kept", "particles.prm", []),
    ("particle, paper, functions kept", "particles.prm", [PAPER]),
    ("particle, affine, rebuilt every step", "particles.prm", [CURRENT]),
    ("coupled, half and half", "coupled.prm", []),
]
REFERENCE_RUN = WHOLE_RUNS[0][0]


class BenchmarkError(Exception):
    pass


def run(command):
    finished = subprocess.run([str(part) for part in command], capture_output=True, text=True,
                              check=False)
    if finished.returncode != 0:
        raise BenchmarkError(f"{' '.join(map(str, command))} failed:\n"
                             + (finished.stderr or finished.stdout)[-2000:])


def run_benchmark_program(program, ranks=1, options=()):
    """What a Google Benchmark program reports, as a list of dictionaries."""
    with tempfile.TemporaryDirectory() as directory:
        file = Path(directory) / "benchmark.json"
        launcher = [] if ranks == 1 else ["mpirun", "-n", ranks]
        run([*launcher, program, f"--benchmark_out={file}", "--benchmark_out_format=json",
             *options])
        text = file.read_text("utf-8")
        # A filter that fits nothing leaves an empty file.
        return json.loads(text)["benchmarks"] if text.strip() else []


def measure_machine(binaries):
    """Bandwidth in bytes and peak rate in operations per second, on one core and on all."""
    cores = len(os.sched_getaffinity(0))
    machine = {}
    for ranks in sorted({1, cores}):
        for row in run_benchmark_program(binaries / "benchmark_machine", ranks):
            for name in ("bytes_per_second", "flops_per_second"):
                if name in row:
                    machine.setdefault(ranks, {})[name] = row[name]
    return machine


def measure_kernels(binaries, pattern):
    """{kernel: {counter in nanoseconds: value}}"""
    kernels = {}
    options = [f"--benchmark_filter={pattern}"] if pattern else []
    for program in sorted(binaries.glob("benchmark_*")):
        if program.name != "benchmark_machine":
            for row in run_benchmark_program(program, 1, options):
                counters = {name: value for name, value in row.items() if name.startswith("ns/")}
                kernels[row["name"]] = counters or {f"{row['time_unit']}/call": row["real_time"]}
    return kernels


def measure_whole_run(root, file, settings, cells, n_steps):
    """The summary of one run on one core of the rod with cubic cells."""
    spacing = LENGTH / cells[0]
    with tempfile.TemporaryDirectory() as directory:
        overrides = [
            f"Mesh/box/Upper corner = {LENGTH}, {cells[1] * spacing}, {cells[2] * spacing}",
            f"Mesh/box/Cells = {', '.join(map(str, cells))}",
            # A wave crosses about 0.9 cells a step.
            f"End time = {0.9 * spacing * n_steps}",
            "Output/Times =",
            f"Output directory = {directory}/run",
            *settings,
        ]
        run([root / "build/bin/tombolo", "--quiet",
             root / "parameter_files/elastic_wave" / file,
             *(part for one in overrides for part in ("--set", one))])
        return json.loads((Path(directory) / "run/summary.json").read_text("utf-8"))


def print_table(title, columns, rows):
    rows = [[str(entry) for entry in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(columns, *rows)]
    print(f"\n{title}\n")
    for row in [columns, ["-" * width for width in widths], *rows]:
        print("  ".join([row[0].ljust(widths[0])]
                        + [entry.rjust(width) for entry, width in zip(row[1:], widths[1:])]))
    sys.stdout.flush()


def number(value):
    return "" if value is None else f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def print_machine(machine):
    print_table("Machine", ["ranks", "bandwidth [GB/s]", "peak [GFlop/s]"],
                [[ranks, number(rates["bytes_per_second"] * 1e-9),
                  number(rates["flops_per_second"] * 1e-9)] for ranks, rates in machine.items()])


def print_kernels(kernels):
    print_table("Kernels, one core", ["kernel", "time", "unit"],
                [[name, number(value), unit] for name, counters in kernels.items()
                 for unit, value in counters.items()])


def print_whole_runs(runs):
    reference = runs.get(REFERENCE_RUN, {}).get("ns_per_node_step")
    rows = []
    for label, summary in runs.items():
        per_node = summary.get("ns_per_node_step")
        bytes_per_node = summary["peak_memory_bytes"] / summary["nodes"]
        rows.append([label, f"{summary['nodes']:,}", summary["steps"],
                     number(summary.get("ns_per_cell_step")),
                     number(summary.get("ns_per_particle_step")), number(per_node),
                     number(per_node / reference) if per_node and reference else "",
                     number(bytes_per_node)])
    print_table(f"Whole runs, one core; ratio of the node-steps to {REFERENCE_RUN}",
                ["run", "nodes", "steps", "ns/cell-step", "ns/particle-step", "ns/node-step",
                 "ratio", "peak bytes/node"], rows)


def parse_arguments():
    parser = argparse.ArgumentParser(prog="benchmark")
    parser.add_argument("root", type=Path)
    parser.add_argument("--cells", default="250,20,20",
                        type=lambda text: [int(one) for one in text.split(",")])
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--filter")
    parser.add_argument("--kernels", action="store_true")
    parser.add_argument("--runs", action="store_true")
    parser.add_argument("--output", type=Path)
    arguments = parser.parse_args()
    if len(arguments.cells) != 3 or min(arguments.cells) < 2:
        parser.error("--cells needs three numbers of at least 2, for example 250,20,20")
    return arguments


def main():
    arguments = parse_arguments()
    binaries = arguments.root / "build/bin"
    everything = not arguments.kernels and not arguments.runs
    results = {"machine": measure_machine(binaries)}
    print_machine(results["machine"])
    if arguments.kernels or everything:
        results["kernels"] = measure_kernels(binaries, arguments.filter)
        print_kernels(results["kernels"])
    if arguments.runs or everything:
        results["runs"] = {label: measure_whole_run(arguments.root, file, settings,
                                                    arguments.cells, arguments.steps)
                           for label, file, settings in WHOLE_RUNS}
        print_whole_runs(results["runs"])
    if arguments.output:
        arguments.output.write_text(json.dumps(results, indent=2), encoding="utf-8")


if __name__ == "__main__":
    try:
        main()
    except BenchmarkError as error:
        sys.exit(f"benchmark: {error}")
