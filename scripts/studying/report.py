# SPDX-License-Identifier: LGPL-2.1-or-later
"""Tables and sentences of a study."""

import csv
import io
import json
import math


def rounded(value, digits=4):
    return f"{value:.{digits}g}" if math.isfinite(value) else "–"


def ratio_text(ratio):
    """"× 1.6", "÷ 1.6" or "unchanged"."""
    size = max(ratio, 1 / ratio)
    if size < 1.005:
        return "unchanged"
    return ("× " if ratio > 1 else "÷ ") + f"{size:.{3 if size < 1.1 or size > 99 else 2}g}"


def ratios_text(what, ratios):
    """Geometric mean and range."""
    ratios = [ratio for ratio in ratios if ratio > 0 and math.isfinite(ratio)]
    if not ratios:
        return f"{what} –", 0
    text = f"{what} {ratio_text(math.exp(sum(map(math.log, ratios)) / len(ratios)))}"
    if len(ratios) > 1 and max(ratios) > 1.05 * min(ratios):
        text += f" ({ratio_text(min(ratios))} to {ratio_text(max(ratios))})"
    return text, len(ratios)


def over(value, other):
    return value / other if other else math.nan


class StudyReport:
    """Errors of the runs, the front of the best, and what the steps of the factors change."""

    def __init__(self, study, runs):
        self.study, self.runs = study, runs
        self.is_search = study.searches_largest
        self.reference = next((run for run in runs if run.choice == study.reference_run), None)
        self.errors = [self.error_of(run) for run in runs]
        self.front = []
        if not self.is_search:
            smallest = math.inf
            finite = [number for number, error in enumerate(self.errors) if math.isfinite(error)]
            for number in sorted(finite, key=lambda number: (runs[number].cost, self.errors[number])):
                if self.errors[number] < smallest:
                    self.front.append(number)
                    smallest = self.errors[number]

    def error_of(self, run):
        if not run.values:
            return math.nan
        if self.is_search:
            return run.values[0]
        references = self.study.references
        if self.reference:
            if self.reference is run or not self.reference.values:
                return math.nan
            references = self.reference.values
        return self.study.error_of(run.values, references)

    def label_of(self, run, factor):
        value = run.choice[factor]
        return "" if value is None else self.study.factors[factor].values[value][0]

    def found_of(self, run):
        """What the search for the least error found, NaN where it found nothing."""
        return run.found or [math.nan] * len(self.study.found_names())

    def steps_of(self, factor):
        # Runs that agree in all other factors, by the value of this one.
        families = {}
        for number, run in enumerate(self.runs):
            value = run.choice[factor]
            if value is not None and math.isfinite(self.errors[number]):
                others = run.choice[:factor] + (None,) + run.choice[factor + 1:]
                families.setdefault(others, {})[value] = number
        # What is compared: [(name, its value for each run), ...].
        compared = [(self.study.value_name() if self.is_search else "error", self.errors)]
        if not self.is_search:
            compared.append(("time", [run.cost for run in self.runs]))
        compared += [(name, [self.found_of(run)[index] for run in self.runs])
                     for index, name in enumerate(self.study.found_names())]
        steps = {}
        for _, family in sorted(families.items(), key=lambda item: [-1 if one is None else one for one in item[0]]):
            values = sorted(family)
            for before, after in zip(values, values[1:]):
                steps.setdefault((before, after), []).append((family[before], family[after]))
        labels, name = self.study.factors[factor].labels(), self.study.factors[factor].name
        for (before, after), pairs in sorted(steps.items()):
            texts, (count, *_) = zip(*(ratios_text(what, [over(values[other], values[one]) for one, other in pairs])
                                       for what, values in compared))
            yield f"{name} {labels[before]} → {labels[after]}: {', '.join(texts)}" + (f", {count} pairs." if count > 1 else ".")

    def failures_of(self, factor):
        for value, label in enumerate(self.study.factors[factor].labels()):
            states = [run.state for run in self.runs if run.choice[factor] == value]
            n_failed = sum(state != "measured" for state in states)
            if n_failed:
                yield f"{self.study.factors[factor].name} {label}: {n_failed} of {len(states)} runs without a result."

    def sentences(self):
        return [sentence for factor in range(len(self.study.factors))
                for sentence in (*self.steps_of(factor), *self.failures_of(factor))]

    def empty_columns(self):
        """Of the further values of the table, those that no measured run has."""
        measured = [run.columns for run in self.runs if run.state == "measured" and run.columns]
        return [column.text for number, column in enumerate(self.study.columns)
                if measured and all(math.isnan(columns[number]) for columns in measured)]

    def conclusions(self):
        lines = []
        if self.front:
            lines.append(f"The best for what they cost ({self.study.error_name} at {self.study.cost_name}):")
        lines += [f"  {rounded(self.errors[number])} at {rounded(self.runs[number].cost)}: {self.runs[number].label}"
                  for number in self.front]
        lines += ["Steps of the factors:"] + [f"  {sentence}" for sentence in self.sentences()]
        if self.study.at_a_time > 1:
            lines.append(f"Runs were made {self.study.at_a_time} at a time: what they cost is disturbed.")
        return "\n".join(lines) + "\n"

    def csv(self):
        study = self.study
        file = io.StringIO()
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["member", *(factor.name for factor in study.factors), "state", study.value_name(),
                         "wall time of all runs [s]" if self.is_search else study.cost_name, "on the front", *study.found_names(),
                         *(one.text for one in (*study.targets, *study.columns)), "runs", "message"])

        def number(value):
            return f"{value:.10g}" if math.isfinite(value) else ""

        for index, run in enumerate(self.runs):
            values = run.values if not self.is_search else []
            values = values + [math.nan] * (len(study.targets) - len(values))
            writer.writerow([run.name, *(self.label_of(run, factor) for factor in range(len(study.factors))), run.state,
                             number(self.errors[index]), number(run.cost), int(index in self.front),
                             *map(number, [*self.found_of(run), *values, *run.columns]), run.n_executions, run.message])
        return file.getvalue()

    def json(self):
        study = self.study

        def finite(value):
            return value if math.isfinite(value) else None

        return json.dumps({
            "title": study.title, "error_name": study.value_name(), "cost_name": study.cost_name,
            "picture": study.picture, "logarithmic_values": study.has_logarithmic_values,
            "knobs": [{"name": factor.name, "labels": factor.labels()} for factor in study.factors],
            "grids": [{"text": grid.text, "axes": [{"knob": factor, "values": values} for factor, values in grid.axes]}
                      for grid in study.grids],
            "members": [{"name": run.name, "choice": list(run.choice), "state": run.state, "error": finite(self.errors[index]),
                         "cost": finite(run.cost), "on_front": index in self.front, "message": run.message,
                         "found": dict(zip(study.found_names(), map(finite, self.found_of(run))))}
                        for index, run in enumerate(self.runs)],
            "sentences": self.sentences()}, indent=2, ensure_ascii=False) + "\n"

    def markdown(self):
        study = self.study
        heads = [*(factor.name for factor in study.factors), study.value_name(),
                 *(["remark"] if self.is_search else [study.cost_name, "front"]),
                 *study.found_names(), *(column.text for column in study.columns)]
        rows = [heads, ["---"] * len(heads)]
        for index, run in enumerate(self.runs):
            has_result = run.state == "measured"
            rows.append([*(self.label_of(run, factor) for factor in range(len(study.factors))),
                         rounded(self.errors[index]) if has_result else run.state,
                         *([run.message] if self.is_search else
                           [rounded(run.cost, 3) if has_result else run.message, "yes" if index in self.front else ""]),
                         *map(rounded, [*self.found_of(run), *run.columns])])
        table = "\n".join("| " + " | ".join(row) + " |" for row in rows)
        return f"# {study.title}\n\n{table}\n\n" + "".join(f"- {sentence}\n" for sentence in self.sentences())
