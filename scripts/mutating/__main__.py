# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command line of scripts/mutate."""

import argparse
import sys
import textwrap
import time
from pathlib import Path

from mutating import copies, mutants, runs

ROOT = Path(__file__).resolve().parents[2]
LIST = ROOT / "tests" / "mutants.json"


def read_arguments():
    parser = argparse.ArgumentParser(
        prog="scripts/mutate", formatter_class=argparse.RawDescriptionHelpFormatter,
        description=textwrap.dedent("""\
            Puts the mistakes of tests/mutants.json into a copy of the project, all at once, each as a
            choice at run time; builds the copy; and runs the tests that are named with a mistake while
            it is made. A mistake survives where they pass. The exit code is 0 where none survives.
            With --only, the copy has no other mistakes, and little of it is compiled anew."""))
    parser.add_argument("--list", action="store_true", help="print the mistakes and end")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="judge these mistakes alone")
    parser.add_argument("--jobs", type=int, default=1, metavar="N",
                        help="judge so many mistakes at a time (default: 1)")
    parser.add_argument("--directory", type=Path, default=Path("build-mutate"),
                        help="of the copy, relative to the project (default: build-mutate)")
    return parser.parse_args()


def print_list(chosen):
    for mutant in chosen:
        print(f"{mutant.name}\n  {mutant.mistake} ({mutant.file})\n  {', '.join(mutant.tests)}")


def choose(listed, names):
    if not names:
        return listed
    by_name = {mutant.name: mutant for mutant in listed}
    unknown = [name for name in names if name not in by_name]
    if unknown:
        raise mutants.ListError(f'there is no mutant "{unknown[0]}"; scripts/mutate --list has all')
    return [by_name[name] for name in names]


def judge(chosen, directory, jobs):
    directory.mkdir(parents=True, exist_ok=True)
    copies.renew(ROOT, directory, chosen)
    named = sorted({test for mutant in chosen for test in mutant.tests})
    copies.build(directory, named)
    tests = runs.Tests(directory)
    begin = time.monotonic()
    failing = tests.failing(named, jobs)
    if failing:
        raise mutants.ListError("without a mistake these tests fail: " + ", ".join(failing))
    survivors = []
    for result in tests.judge_all(chosen, jobs):
        verdict = f"killed by {result.killed_by}" if result.killed_by else "SURVIVED"
        print(f"{result.mutant.name:44} {result.seconds:5.1f} s  {verdict}", flush=True)
        if not result.killed_by:
            survivors.append(result.mutant)
    print(f"{len(chosen) - len(survivors)} of {len(chosen)} mistakes were noticed, "
          f"{time.monotonic() - begin:.0f} s of tests")
    for mutant in survivors:
        print(f"survived: {mutant.name}: {mutant.mistake}")
    return 1 if survivors else 0


def main():
    arguments = read_arguments()
    try:
        listed = mutants.read(LIST)
        chosen = choose(listed, arguments.only)
        if arguments.list:
            print_list(chosen)
            return 0
        return judge(chosen, ROOT / arguments.directory, max(1, arguments.jobs))
    except (mutants.ListError, LookupError) as error:
        print(f"mutate: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
