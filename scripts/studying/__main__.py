# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command line of scripts/study where it makes runs."""

import shutil
import signal
import sys
from pathlib import Path

from tombolo.command_line import parser_of, settings_of
from tombolo.log import Log
from tombolo.parameter_file import InputError
from .least import find_minimize
from .report import StudyReport
from .runs import Executor, StudyError, StudyInterrupted, make_runs
from .settings import StudySettings

PROJECT = Path(__file__).resolve().parents[2]


def program_of(study):
    """That of the study file, of this clone, or of an installation."""
    built = PROJECT / "build/bin/tombolo"
    program = study.program or (str(built) if built.exists() else shutil.which("tombolo"))
    if not program:
        raise InputError("There is no program that makes the runs: build it by scripts/build, or name it by the entry \"Program\".")
    return program


def run_study(study, runs, is_anew, log):
    """The exit code."""
    program = program_of(study)
    if study.searches_least:
        find_minimize()
    study.output.mkdir(parents=True, exist_ok=True)
    with open(study.output / "log.txt", "w", encoding="utf-8") as log.file:
        log(f"Trade study: {study.title}")
        (study.output / "parameters.prm").write_text(study.listing(documents=False), "utf-8")
        executor = Executor(study, program, study.output / "members", log)
        for one in (signal.SIGINT, signal.SIGTERM):
            signal.signal(one, lambda *_: executor.is_interrupted.set())
        try:
            executor.execute(runs, is_anew)
        except StudyInterrupted:
            log("Interrupted; runs that have ended are kept: the same command goes on.")
            return 130
        report = StudyReport(study, runs)
        for name, text in (("members.csv", report.csv()), ("study.json", report.json()), ("report.md", report.markdown())):
            (study.output / name).write_text(text, "utf-8")
        log("\n" + report.conclusions())
        log(f"Tables: {study.output / 'members.csv'}, {study.output / 'report.md'}")
        for column in report.empty_columns():
            log(f"Warning: no run has the value \"{column}\" of the entry \"Error/Columns\": its column is empty.")
        n_bad = sum(run.state in ("timed out", "crashed") for run in runs)
        if n_bad:
            log(f"Warning: {n_bad} runs crashed or took too long.")
        return 2 if n_bad else 0


def main():
    arguments, log = parser_of("study", "--list", "--anew").parse_args(), Log()
    study = settings_of(arguments, StudySettings)
    runs = make_runs(study)
    for note in study.notes:
        log(f"Note: {note}")
    if arguments.list:
        for run in runs:
            log(run.label)
    if arguments.validate:
        log(f"{arguments.file}: nothing wrong was found, {len(runs)} runs.")
    if arguments.list or arguments.validate:
        return 0
    return run_study(study, runs, arguments.anew, log)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except InputError as error:
        sys.exit(f"\nError: {error}")
    except (StudyError, OSError) as error:
        print(f"\nThe study stopped: {error}", file=sys.stderr)
        sys.exit(2)
