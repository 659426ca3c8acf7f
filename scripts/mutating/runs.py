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

# A mutant that lets a test hang is detected: after so many times what the test needs without it, and at
# least so many seconds. A busy machine is no mistake.
TIMES = 10
LEAST_SECONDS = 120
SECONDS_WITHOUT_A_MISTAKE = 1800


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
        self.seconds = {}

    def passes(self, test, mutant=None):
        limit = SECONDS_WITHOUT_A_MISTAKE
        environment = {name: value for name, value in os.environ.items() if name != VARIABLE}
        if mutant is not None:
            environment[VARIABLE] = str(mutant.number)
            limit = max(LEAST_SECONDS, TIMES * self.seconds.get(test, 0.))
        with self.locks[test]:
            begin = time.monotonic()
            run = subprocess.run(["ctest", "--test-dir", str(self.directory), "--timeout", f"{limit:.0f}",
                                  "--no-tests=error", "-R", f"^{re.escape(test)}$"],
                                 env=environment, capture_output=True, text=True, check=False)
            if mutant is None:
                self.seconds[test] = time.monotonic() - begin
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
