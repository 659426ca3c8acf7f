# SPDX-License-Identifier: LGPL-2.1-or-later
"""Floating-point operations and memory traffic of a process, where `perf` can count them."""

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

LINE = 64  # bytes that one fill of the caches brings

# By name of the processor's vendor: {event: what one of it counts for}. Lines that the second-level
# prefetcher brings are not among the fills of the first level from memory.
EVENTS = {
    "AuthenticAMD": {
        "flops": {"fp_ret_sse_avx_ops.all": 1},
        "bytes": {"ls_any_fills_from_sys.mem_io_local": LINE, "l2_pf_miss_l2_l3": LINE},
    },
    "GenuineIntel": {
        "flops": {"fp_arith_inst_retired.scalar_double": 1,
                  "fp_arith_inst_retired.128b_packed_double": 2,
                  "fp_arith_inst_retired.256b_packed_double": 4,
                  "fp_arith_inst_retired.512b_packed_double": 8},
        "bytes": {"longest_lat_cache.miss": LINE},
    },
}


def _vendor():
    match = re.search(r"^vendor_id\s*:\s*(\S+)", Path("/proc/cpuinfo").read_text("utf-8"),
                      re.MULTILINE)
    return match.group(1) if match else None


def _read(file):
    """{event: count} of what `perf stat -x ,` has written; events that were not counted are
    missing."""
    counts = {}
    for line in Path(file).read_text("utf-8").splitlines():
        fields = line.split(",")
        if len(fields) > 2 and fields[0].isdigit():
            counts[re.sub(r":u$", "", fields[2])] = int(fields[0])
    return counts


class Counters:
    """What this machine can count: use `with_prefix` to start a process, `read` afterwards."""

    def __init__(self):
        self.groups = {}
        if shutil.which("perf") is None:
            return
        for name, events in EVENTS.get(_vendor(), {}).items():
            counted = self._count(["true"], events)
            if counted is not None:
                self.groups[name] = events

    @staticmethod
    def _prefix(events, file):
        return ["perf", "stat", "-x", ",", "-o", file, "-e",
                ",".join(f"{event}:u" for event in events), "--"]

    def _count(self, command, events):
        with tempfile.NamedTemporaryFile() as file:
            done = subprocess.run([*self._prefix(events, file.name), *command],
                                  capture_output=True, check=False)
            counts = _read(file.name)
        return counts if done.returncode == 0 and set(counts) == set(events) else None

    def prefix(self, file):
        """What to put before a command, so that its counts go to @p file."""
        events = [event for group in self.groups.values() for event in group]
        return self._prefix(events, file) if events else []

    def read(self, file):
        """{"flops": ..., "bytes": ...}, as far as they can be counted."""
        if not self.groups:
            return {}
        counts = _read(file)
        return {name: sum(counts[event] * weight for event, weight in group.items())
                for name, group in self.groups.items() if set(group) <= set(counts)}
