# SPDX-License-Identifier: LGPL-2.1-or-later
"""The search for the values of entries that make the error of a run least."""

import csv
import shutil
import sys
from pathlib import Path

from tombolo.parameter_file import InputError

# The error of a trial without a result: finite, so that differences of two are.
WITHOUT_RESULT = sys.float_info.max / 4


def find_minimize():
    """SciPy's; throws InputError where it is not installed."""
    try:
        from scipy.optimize import minimize  # only where it is needed
    except ImportError as error:
        raise InputError("Search/Kind = least needs SciPy for Python, which scripts/study installs (on Debian: apt-get install "
                         f"python3-scipy): {error}.") from error
    return minimize


class LeastError:
    """Nelder and Mead's simplex within bounds, in values scaled by these to 0 to 1. It begins in the middle."""

    def __init__(self, runner):
        self.runner, self.study, self.run = runner, runner.study, runner.one
        self.trials = {}  # {texts of the values: (error, state, message)}
        self.best = None

    def search(self):
        study, run = self.study, self.run
        n_values = len(study.search_entries)
        middle = [0.5] * n_values
        simplex = [middle] + [[0.5 + 0.25 * (index == one) for index in range(n_values)] for one in range(n_values)]
        ended = find_minimize()(self.error_of, middle, method="Nelder-Mead", bounds=[(0, 1)] * n_values, options={
            "initial_simplex": simplex, "xatol": study.search_tolerance, "fatol": float("inf"), "maxfev": study.search_runs})
        self.write_trials()
        if self.best is None:
            _, state, message = list(self.trials.values())[-1]
            run.state, run.message = state if state != "measured" else "no value", f"fails at all values tried: {message}"
            return
        error, found, run.values, run.columns, run.cost = self.best
        run.state, run.found = "measured", found
        for path, kept in self.kept():
            shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)
            kept.rename(path)
        named = [f"{name} = {value:.4g}" for name, value in zip(study.found_names(), found)]
        run.message = f"{study.error_name} {error:.4g} at {', '.join(named)}, {run.n_executions} runs"
        at_ends = [name for name, value, begin, end in zip(study.found_names(), found, study.search_from, study.search_to)
                   if min(value - begin, end - value) <= study.search_tolerance * (end - begin)]
        if at_ends:
            run.message += f"; {', '.join(at_ends)} is at an end of what was tried"
        if not ended.success:
            run.message += "; not yet within the tolerance"

    def error_of(self, shares):
        study, runner, run = self.study, self.runner, self.run
        values = [begin + float(share) * (end - begin)
                  for share, begin, end in zip(shares, study.search_from, study.search_to)]
        texts = tuple(f"{value * runner.unit:.12g}" for value in values)
        if texts in self.trials:
            return self.trials[texts][0]
        run.cost, error = float("inf"), WITHOUT_RESULT
        run.state, run.message = runner.execute([f"{entry} = {text}" for entry, text in zip(study.search_entries, texts)])
        if run.state == "measured" and runner.is_within_bounds() and runner.read_values():
            error = study.error_of(run.values, study.references)
        else:
            run.message = run.message or runner.last[1]
        self.trials[texts] = error, run.state, run.message
        if error < (self.best[0] if self.best else WITHOUT_RESULT):
            self.best = error, values, run.values, run.columns, run.cost
            for path, kept in self.kept():
                if kept.is_dir():
                    shutil.rmtree(kept)
                path.rename(kept)
        return error

    def kept(self):
        """Where the run with the least error is, and its screen, and where they wait while others are made."""
        output = self.runner.output
        return [(path, Path(f"{path}.least")) for path in (output, Path(f"{output}.txt"))]

    def write_trials(self):
        with open(f"{self.runner.output}.trials.csv", "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow([*self.study.search_entries, self.study.error_name, "state", "message"])
            for texts, (error, state, message) in self.trials.items():
                writer.writerow([*texts, f"{error:.10g}" if error < WITHOUT_RESULT else "", state, message])
