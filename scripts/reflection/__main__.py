# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command line of scripts/reflection_study."""

import json
import multiprocessing
import os
import signal
import sys
import tempfile
import time
from functools import lru_cache
from pathlib import Path

from tombolo.command_line import parser_of, settings_of
from tombolo.errors import TomboloError
from tombolo.log import Log
from tombolo.parameter_file import InputError
from . import tables
from .burst import send_burst
from .case import Strip
from .operators import Probes, StripOperators, StudyError
from .settings import ReflectionSettings


def parse_arguments():
    parser = parser_of("reflection_study")
    parser.add_argument("--processes", type=int, default=len(os.sched_getaffinity(0)))
    return parser.parse_args()


read_operators = lru_cache(maxsize=2)(StripOperators)


def compute(task):
    """The result of a case, or the error that stops the study, and the seconds that it needed."""
    case, strip, file = task
    start = time.monotonic()
    try:
        result = send_burst(case, read_operators(strip, file))
    except StudyError as error:
        result = error
    return result, time.monotonic() - start


def ignore_interrupts():
    """In processes that end with the one that started them."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


class Study:
    def __init__(self, settings, n_processes):
        self.settings, self.n_processes = settings, max(1, n_processes)
        self.strips = [Strip(row.case) for group in settings.groups for row in group.rows]

    def probe(self, directory, validates=False):
        return Probes(self.strips, directory, self.n_processes, validates)

    def refuse(self, group, number, error):
        where = f'{self.settings.file.path}: section "Group: {group.name}"'
        raise type(error)(f"{where}: case {number} of the group cannot be computed: {error}"
                          ) from error

    def refuse_failures(self, probes):
        """Throws for the first case whose strip could not be built."""
        strips = iter(self.strips)
        for group in self.settings.groups:
            for number, strip in enumerate((next(strips) for _ in group.rows), 1):
                if strip in probes.failures:
                    self.refuse(group, number, probes.failures[strip])

    def validate(self):
        with tempfile.TemporaryDirectory() as directory:
            self.refuse_failures(self.probe(directory, validates=True))

    def run(self, log):
        """Computes all cases, and prints each group as soon as it is complete."""
        with tempfile.TemporaryDirectory() as directory, \
                multiprocessing.Pool(self.n_processes, ignore_interrupts) as pool:
            probes = self.probe(directory)
            self.refuse_failures(probes)
            cases = (row.case for group in self.settings.groups for row in group.rows)
            results = pool.imap(compute, [(case, strip, probes.file(strip))
                                          for case, strip in zip(cases, self.strips)])
            for group in self.settings.groups:
                for number, row in enumerate(group.rows, 1):
                    row.result, row.seconds = next(results)
                    if isinstance(row.result, StudyError):
                        self.refuse(group, number, row.result)
                log(tables.table(group))

    def write(self, directory, wall_seconds):
        groups = self.settings.groups
        (directory / "reflection.csv").write_text(tables.csv(groups), "utf-8")
        results = {"cases": self.settings.n_cases(), **tables.calibration(groups)}
        summary = json.dumps({"wall_seconds": wall_seconds, "results": results}, indent=2)
        (directory / "summary.json").write_text(summary + "\n", "utf-8")


def main():
    arguments, log, start = parse_arguments(), Log(), time.monotonic()
    settings = settings_of(arguments, ReflectionSettings)
    study = Study(settings, arguments.processes)
    if arguments.validate:
        study.validate()
        log(f"{arguments.file}: nothing wrong was found.")
        return
    directory = Path(settings.output)
    try:
        directory.mkdir(parents=True, exist_ok=True)
        (directory / "summary.json").unlink(missing_ok=True)
        (directory / "parameters.prm").write_text(settings.listing(documents=False), "utf-8")
    except OSError as error:
        settings.fail("Output directory", f"nothing can be written there: {error.strerror}")
    with open(directory / "log.txt", "w", encoding="utf-8") as log.file:
        log(f"Reflection study: {settings.title}")
        study.run(log)
        study.write(directory, time.monotonic() - start)
        log(f"\n{settings.n_cases()} cases, written to {directory / 'reflection.csv'}")


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(130)
    except InputError as error:
        sys.exit(f"\nError: {error}")
    except (TomboloError, OSError) as error:
        print(f"\nThe study stopped: {error}", file=sys.stderr)
        sys.exit(2)
