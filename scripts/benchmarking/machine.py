# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the machine can do, and the kernels of benchmarks/."""

import json
import tempfile
from pathlib import Path

from .runs import BenchmarkError, available_cores, launcher, run
from .tables import number, print_table


def run_benchmark_program(program, ranks=1, options=()):
    """What a Google Benchmark program reports, as a list of dictionaries."""
    if not program.exists():
        raise BenchmarkError(f"{program} is not built.")
    with tempfile.TemporaryDirectory() as directory:
        file = Path(directory) / "benchmark.json"
        run([*launcher(ranks), program, f"--benchmark_out={file}", "--benchmark_out_format=json",
             *options])
        text = file.read_text("utf-8")
        # A filter that fits nothing leaves an empty file.
        return json.loads(text)["benchmarks"] if text.strip() else []


def measure_machine(binaries):
    """Bandwidth in bytes and peak rate in operations per second, on one core and on all."""
    machine = {}
    for ranks in sorted({1, available_cores()}):
        for row in run_benchmark_program(binaries / "benchmark_machine", ranks):
            for name in ("bytes_per_second", "flops_per_second"):
                if name in row:
                    machine.setdefault(ranks, {})[name] = row[name]
    return machine


def print_machine(machine):
    print_table("Machine", ["ranks", "bandwidth [GB/s]", "peak [GFlop/s]"],
                [[ranks, number(rates["bytes_per_second"] * 1e-9),
                  number(rates["flops_per_second"] * 1e-9)] for ranks, rates in machine.items()])


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


def print_kernels(kernels):
    print_table("Kernels, one core", ["kernel", "time", "unit"],
                [[name, number(value), unit] for name, counters in kernels.items()
                 for unit, value in counters.items()])
