# SPDX-License-Identifier: LGPL-2.1-or-later
"""Tests with one mutant, or with none."""

import os
import re
import subprocess
import threading
import time
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from mutating import copies
from mutating.mutants import VARIABLE

SECONDS = 120  # a mutant that lets a test hang is noticed


@dataclass(frozen=True)
class Result:
    mutant: object
    killed_by: str  # the test, or nothing
    seconds: float


class Tests:
    """The tests of a copy. One test runs only once at a time, since it may write files."""

    def __init__(self, copy):
        self.directory = copy / copies.BUILD
        self.locks = defaultdict(threading.Lock)

    def passes(self, test, mutant=None):
        environment = {name: value for name, value in os.environ.items() if name != VARIABLE}
        if mutant is not None:
            environment[VARIABLE] = str(mutant.number)
        with self.locks[test]:
            run = subprocess.run(["ctest", "--test-dir", str(self.directory), "--timeout", str(SECONDS),
                                  "--no-tests=error", "-R", f"^{re.escape(test)}$"],
                                 env=environment, capture_output=True, text=True, check=False)
        if "No tests were found" in run.stdout + run.stderr:
            raise LookupError(f"there is no test {test}")
        return run.returncode == 0

    def failing(self, tests, jobs):
        """Those that fail without a mutant."""
        with ThreadPoolExecutor(jobs) as pool:
            passed = list(pool.map(self.passes, tests))
        return [test for test, good in zip(tests, passed) if not good]

    def judge(self, mutant):
        begin = time.monotonic()
        killed_by = next((test for test in mutant.tests if not self.passes(test, mutant)), "")
        return Result(mutant, killed_by, time.monotonic() - begin)

    def judge_all(self, mutants, jobs):
        """Yields a result for each mutant, in the order of the list."""
        with ThreadPoolExecutor(jobs) as pool:
            yield from pool.map(self.judge, mutants)
