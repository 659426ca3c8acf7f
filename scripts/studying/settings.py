# SPDX-License-Identifier: LGPL-2.1-or-later
"""The contents of a study file."""

import itertools
import math
import os
import re
from dataclasses import dataclass, field
from pathlib import Path

from tombolo.described_file import MANDATORY, DescribedFile, is_number, parts_of
from tombolo.errors import nearest
from tombolo.parameter_file import InputError
from .curves import BEGINNING, Distance
from .quantities import Quantity

OUTPUT_MARK = "{output}"
BASE_FILE = "Base file"

ENTRIES = {
    "Title": ("", None, "A title for tables and pictures."),
    "Output directory": ("output/trade_study", None, "Where the study leaves its tables, and its runs in `members`; made if it "
                         "does not exist. Runs that are there already are not made again."),
    "Base file": (MANDATORY, None, "The parameter file whose entries are varied, relative to the study file."),
    "Common settings": ("", None, "`Section/Entry = value` for all runs, separated by ` | `."),
    "Factors": (MANDATORY, None, "Names of what is varied, each with a section `Factor: NAME`, separated by commas."),
    "Grids": ("", None, "Which values of factors meet: products of factors such as `spacing x dilation`, separated by commas. A "
              "factor that a product does not name is left as the parameter file has it; `model = particles x dilation` takes one "
              "value, `model = particles / coupled x dilation` two. Empty: the product of all factors."),
    "Program": ("", None, "The program that makes the runs; empty: that of this project or installation."),
    "Repetitions": ("1", (int, 1, 1000), "Each run is made so many times; the smallest cost counts."),
    "Runs at a time": ("1", (int, 1, 1000), "Runs that are made side by side. More than one disturbs the cost."),
    "Ranks": ("1", (int, 1, 100000), "MPI ranks of each run."),
    "Time limit": ("0", (float, 0, math.inf), "A run that takes longer is ended, and counts as failed. Zero: no limit. Units: "
                   "seconds of wall time."),
    "Measurement": ("", None, "A program that measures each run that has ended, relative to the study file, and its arguments, "
                    "separated by blanks; `{output}` stands for the output directory of the run. Numbers that it leaves there, in a "
                    "JSON file or a table, are quantities of interest as those of the run are. Empty: none."),
    "Picture": ("pareto", ("pareto", "lines", "map"), "What scripts/study draws: error over cost with the front of the best; the "
                "value over the first factor of each grid, one line for each choice of the others; or a map over the first two "
                "factors of each grid."),
    "Logarithmic values": ("true", ("true", "false"), "Whether lines and maps have a logarithmic scale of values."),
    "Error/Name": ("error", None, "What tables and pictures call it."),
    "Error/Quantities of interest": ("", None, "Values of a run that tell its error, separated by ` | `. A value is "
                                     "`FILE.json/KEY/KEY` (elements of arrays by number), or `FILE.csv/COLUMN` for the last row of "
                                     "a column of a table, `FILE.csv/COLUMN at TIME` for the row of a time, `largest of "
                                     "FILE.csv/COLUMN` or `mean of FILE.csv/COLUMN`, in the output directory of the run. `distance of "
                                     "FILE.csv/COLUMN from MEASURED.csv/COLUMN` compares a curve of the run, a column over the first "
                                     "one of its table, with a measured curve of a table relative to the study file: the root mean "
                                     "square of their difference over what both have of the abscissa, as a share of the range of the "
                                     "measured values."),
    "Error/References": ("", None, "What the values ought to be, separated by commas: the error is relative to it. `-`: the value "
                         "itself is the error."),
    "Error/Reference run": ("", None, "Instead of references, the run whose values are right, by its factors, for example `spacing "
                            "= 0.05, model = elements`."),
    "Error/Combination": ("mean", ("mean", "largest", "root mean square"), "How the errors of several values make one."),
    "Error/Cost": ("summary.json/wall_seconds", None, "The value that is the cost of a run."),
    "Error/Cost name": ("wall time [s]", None, "What tables and pictures call the cost."),
    "Error/Columns": ("", None, "Further values for the table, separated by ` | `."),
    "Search/Kind": ("largest", ("largest", "least"), "What is searched for each run: the largest value of an entry with which it "
                    "succeeds, by bisection, which is then what the study measures; or the values of entries that make its error "
                    "(section Error) least, by the simplex of Nelder and Mead, and this error is what the study measures. All values "
                    "tried for a run are in `members/RUN.trials.csv`, and its output directory has the run with the least error."),
    "Search/Entry": ("", None, "The entry whose values are tried; for `least` they may be several, joined by ` & `. Empty: no search."),
    "Search/Relative to": ("", None, "A value of a first run that leaves the entry alone, for example summary.json/time_step_max: "
                           "the values tried, and the one found, are multiples of it. Empty: they are values of the entry."),
    "Search/From": ("0.01", None, "The smallest value tried; for `least` one for each entry, joined by ` & `."),
    "Search/To": ("10", None, "The largest value tried; for `least` one for each entry, joined by ` & `."),
    "Search/Tolerance": ("0.01", (float, 1e-6, 1), "The search for the largest value ends where the smallest value that fails is "
                         "larger by this share than the largest that succeeds; that for the least error where the values of the "
                         "simplex differ by at most this share of what lies between From and To."),
    "Search/Largest number of runs": ("100", (int, 2, 100000), "The search for the least error ends after so many runs."),
    "Search/Quantities of interest": ("", None, "A run succeeds if it ends and these values are within their bounds, separated by "
                                      "` | `; empty: if it ends."),
    "Search/At most": ("", None, "Bounds of the magnitudes of the values, separated by commas."),
}
FACTOR_ENTRIES = {
    "Entries": (MANDATORY, None, "The entry of the parameter file that this factor sets, as `Section/Entry`; several that are set "
                "together are joined by ` & `. `*` stands for any name: the entry is set in all sections that the parameter file "
                "has. `Base file` is the parameter file itself."),
    "Values": (MANDATORY, None, "What the entry is set to, separated by ` | `; with several entries each value has as many texts, "
               "joined by ` & `. `1 to 3 in 5` are five equidistant numbers, `1 to 1000 in 4 geometric` four with equal ratios. An "
               "empty text leaves the entry as it is."),
    "Labels": ("", None, "What tables and pictures call the values, separated by ` | `; empty: the first text of each value."),
}
FORMER_NAMES = {"Knobs": "Factors", "Members at a time": "Runs at a time", "Error/Measures": "Error/Quantities of interest",
                "Search/Measures": "Search/Quantities of interest", "Error/Reference member": "Error/Reference run"}


def values_of(text, separator):
    """The parts between single separators: `||` and `&&` are of expressions."""
    mark = re.escape(separator)
    return [part.strip() for part in re.split(f"(?<!{mark}){mark}(?!{mark})", text)]


@dataclass
class Factor:
    """What is varied: [(label, texts of the entries), ...]."""
    name: str
    entries: list
    values: list

    def labels(self):
        return [label for label, _ in self.values]


@dataclass
class Grid:
    """A product of factors: [(factor, [value, ...]), ...] by number."""
    text: str
    axes: list = field(default_factory=list)


class StudySettings(DescribedFile):
    """Reads everything. Throws InputError."""
    entries, kind, names, entries_of_each = ENTRIES, "Factor", "Factors", FACTOR_ENTRIES

    def __init__(self, file):
        self.directory, self.notes = file.path.parent, []
        self.accept_former_names(file)
        super().__init__(file)
        self.title = self.get("Title")
        self.output = Path(self.get("Output directory"))
        self.base_file = self.resolved("Base file", self.get("Base file"))
        self.common_settings = parts_of(self.get("Common settings"), " | ") if self.get("Common settings") else []
        for setting in self.common_settings:
            if "=" not in setting:
                self.fail("Common settings", f'"{setting}" is not `Section/Entry = value`')
        self.program = self.get("Program")
        self.repetitions, self.at_a_time, self.ranks = (int(self.get(name)) for name in ("Repetitions", "Runs at a time", "Ranks"))
        self.time_limit = float(self.get("Time limit"))
        self.picture, self.has_logarithmic_values = self.get("Picture"), self.get("Logarithmic values") == "true"
        self.search_entries = parts_of(self.get("Search/Entry"), " & ") if self.get("Search/Entry") else []
        self.searches_least = self.get("Search/Kind") == "least"
        self.searches_largest = bool(self.search_entries) and not self.searches_least
        self.read_measurement()
        self.factors = [self.read_factor(name) for name in self.list_of("Factors")]
        if not self.factors:
            self.fail("Factors", "a study varies at least one factor")
        products = self.list_of("Grids") or [" x ".join(factor.name for factor in self.factors)]
        self.grids = [self.read_grid(product) for product in products]
        self.read_error()
        self.read_search()
        if self.picture == "map":
            for grid in self.grids:
                if len(grid.axes) < 2:
                    self.fail("Picture", f'a map needs two factors, but the grid "{grid.text}" has one')

    # Entries

    def accept_former_names(self, file):
        for path, entry in list(file.entries.items()):
            name = FORMER_NAMES.get(path, path)
            section, slash, rest = name.partition("/")
            if section.startswith("Knob: "):
                name = "Factor: " + section.removeprefix("Knob: ") + slash + rest
            if name == path:
                continue
            del file.entries[path]
            file.entries.setdefault(name, entry)
            if path in FORMER_NAMES:
                self.notes.append(f'{entry[1]}: entry "{path}" is now called "{name.rpartition("/")[2]}".')

    def resolved(self, entry, name):
        path = Path(os.path.normpath(self.directory / name))
        if not path.is_file():
            self.fail(entry, f"there is no file {path}")
        return str(path)

    def quantities(self, entry):
        text = self.get(entry)
        return [self.quantity(entry, part) for part in parts_of(text, "|")] if text else []

    def quantity(self, entry, text):
        try:
            return Distance(text, self.directory) if text.startswith(BEGINNING) else Quantity(text)
        except ValueError as error:
            self.fail(entry, str(error))

    def index_of(self, entry, names, wanted, kind):
        if wanted not in names:
            self.fail(entry, f'"{wanted}" is no {kind}; allowed is {", ".join(names)}.' + nearest(wanted, names))
        return names.index(wanted)

    # What is varied

    def read_factor(self, name):
        path = f"Factor: {name}/"
        entries = parts_of(self.get(path + "Entries"), " & ")
        if any(not entry or entries.count(entry) > 1 for entry in entries):
            self.fail(path + "Entries", "an entry is missing, or named twice")
        values = []
        for text in values_of(self.get(path + "Values"), "|"):
            numbers = self.range_of(path + "Values", text)
            if numbers and len(entries) > 1:
                self.fail(path + "Values", f"a range has one number a value, but the factor sets {len(entries)} entries")
            values += [(number, [number]) for number in numbers]
            if numbers:
                continue
            texts = [text] if len(entries) == 1 else values_of(text, "&")
            if len(texts) != len(entries):
                self.fail(path + "Values", f'the value "{text}" has {len(texts)} texts for {len(entries)} entries; they are '
                          "joined by &")
            values.append((texts[0], texts))
        has_labels = bool(self.get(path + "Labels"))
        if has_labels:
            labels = values_of(self.get(path + "Labels"), "|")
            if len(labels) != len(values):
                self.fail(path + "Labels", f"there are {len(labels)} labels for {len(values)} values")
            values = [(label, texts) for label, (_, texts) in zip(labels, values)]
        labels = [label for label, _ in values]
        for label in labels:
            if not label:
                self.fail(path + "Labels", "a value has no label: an empty text needs one")
            if labels.count(label) > 1:
                self.fail(path + ("Labels" if has_labels else "Values"), f'two values are called "{label}"; give them labels')
        if BASE_FILE in entries:
            at = entries.index(BASE_FILE)
            for _, texts in values:
                texts[at] = self.resolved(path + "Values", texts[at])
        return Factor(name, entries, values)

    def range_of(self, entry, text):
        """The numbers of "1 to 3 in 5" and of "1 to 100 in 3 geometric"; none if the text is no range."""
        match = re.fullmatch(r"(\S+)\s+to\s+(\S+)\s+in\s+(\S+)(\s+geometric)?", text)
        if not match:
            return []
        if not (is_number(match[1]) and is_number(match[2]) and re.fullmatch(r"[+-]?\d+", match[3])):
            self.fail(entry, "a range is `FROM to TO in COUNT`, with numbers")
        first, last, count = float(match[1]), float(match[2]), int(match[3])
        if not 2 <= count <= 1000:
            self.fail(entry, f"a range has 2 to 1000 values, not {count}")
        if match[4] and not (first > 0 and last > 0):
            self.fail(entry, "the ends of a geometric range are positive")
        shares = [number / (count - 1) for number in range(count)]
        return ["%.6g" % (first * (last / first)**share if match[4] else first + (last - first) * share) for share in shares]

    def factor_number(self, entry, name):
        return self.index_of(entry, [factor.name for factor in self.factors], name, "factor")

    def value_number(self, entry, factor, label):
        return self.index_of(entry, self.factors[factor].labels(), label, f"value of the factor {self.factors[factor].name}")

    def read_grid(self, text):
        grid = Grid(text)
        for term in parts_of(text, " x "):
            name, equals, labels = (part.strip() for part in term.partition("="))
            factor = self.factor_number("Grids", name)
            if any(factor == known for known, _ in grid.axes):
                self.fail("Grids", f'"{text}" names the factor {name} twice')
            grid.axes.append((factor, [self.value_number("Grids", factor, label) for label in parts_of(labels, " / ")] if equals
                              else list(range(len(self.factors[factor].values)))))
        return grid

    def choices(self):
        """The choices of all grids, each once: for every factor the number of its value, or None."""
        found = {}
        for grid in self.grids:
            for values in itertools.product(*(values for _, values in grid.axes)):
                choice = [None] * len(self.factors)
                for (factor, _), value in zip(grid.axes, values):
                    choice[factor] = value
                found[tuple(choice)] = True
        return list(found)

    # What is measured

    def read_measurement(self):
        self.measurement = self.get("Measurement").split()
        if not self.measurement:
            return
        self.measurement[0] = str(Path(self.resolved("Measurement", self.measurement[0])).absolute())
        if not os.access(self.measurement[0], os.X_OK):
            self.fail("Measurement", f"{self.measurement[0]} is no program that may be run")
        if OUTPUT_MARK not in self.get("Measurement"):
            self.fail("Measurement", f"the program is not told where the run is; expected is {OUTPUT_MARK} among its arguments")
        if self.searches_largest:
            self.fail("Measurement", "a search measures what the runs alone leave behind")

    def read_error(self):
        section = "Error/"
        self.error_name, self.combination = self.get(section + "Name"), self.get(section + "Combination")
        self.targets = self.quantities(section + "Quantities of interest")
        references = self.list_of(section + "References")
        if references and len(references) != len(self.targets):
            self.fail(section + "References", f"there are {len(references)} references for {len(self.targets)} quantities")
        self.references = [None if text == "-" else self.number(section + "References", text)
                           for text in references or ["-"] * len(self.targets)]
        if 0 in self.references:
            self.fail(section + "References", "an error relative to zero is undefined; `-` makes the value itself the error")
        self.reference_run = None
        chosen = self.list_of(section + "Reference run")
        if chosen:
            choice = [None] * len(self.factors)
            for text in chosen:
                name, equals, label = (part.strip() for part in text.partition("="))
                if not equals:
                    self.fail(section + "Reference run", f'"{text}" is not `FACTOR = VALUE`')
                factor = self.factor_number(section + "Reference run", name)
                choice[factor] = self.value_number(section + "Reference run", factor, label)
            self.reference_run = tuple(choice)
            if self.reference_run not in self.choices():
                self.fail(section + "Reference run", "no grid has this run")
        self.cost, self.cost_name = self.quantity(section + "Cost", self.get(section + "Cost")), self.get(section + "Cost name")
        self.columns = self.quantities(section + "Columns")

    def read_search(self):
        section = "Search/"
        if not self.search_entries:
            if self.searches_least:
                self.fail(section + "Entry", "the search for the least error needs entries whose values it tries")
            if not self.targets:
                self.fail("Error/Quantities of interest", "a study measures something: values of its runs here, or the largest "
                          "value of an entry by the section Search")
            return
        if self.searches_largest and len(self.search_entries) > 1:
            self.fail(section + "Entry", "the largest value is searched of one entry; allowed are several with `Kind = least`")
        if any(not entry or self.search_entries.count(entry) > 1 for entry in self.search_entries):
            self.fail(section + "Entry", "an entry is missing, or named twice")
        unit = self.get(section + "Relative to")
        self.search_unit = self.quantity(section + "Relative to", unit) if unit else None
        self.search_tolerance, self.search_runs = float(self.get(section + "Tolerance")), int(self.get(section + "Largest number of runs"))
        self.search_from, self.search_to = (self.read_search_ends(section + name) for name in ("From", "To"))
        if not all(first < last for first, last in zip(self.search_from, self.search_to)):
            self.fail(section + "To", "the largest value tried is not larger than the smallest")
        self.bounds = self.quantities(section + "Quantities of interest")
        limits = self.list_of(section + "At most")
        if len(limits) != len(self.bounds):
            self.fail(section + "At most", f"there are {len(limits)} bounds for {len(self.bounds)} quantities")
        self.limits = [self.number(section + "At most", limit) for limit in limits]
        if self.targets and self.searches_largest:
            self.fail("Error/Quantities of interest", "with a search the value that was found is what the study measures")
        if self.searches_least and not self.targets:
            self.fail("Error/Quantities of interest", "the search for the least error needs values of a run that tell it")
        if self.searches_least and self.reference_run:
            self.fail("Error/Reference run", "the search for the least error knows what the values ought to be before it begins; "
                      "give References")

    def read_search_ends(self, entry):
        texts = parts_of(self.get(entry), " & ")
        if self.searches_least and entry not in self.file.entries:
            self.fail(entry, "the search for the least error needs the ends between which it tries values")
        if len(texts) != len(self.search_entries):
            self.fail(entry, f"there are {len(texts)} values for {len(self.search_entries)} entries; they are joined by &")
        numbers = [self.number(entry, text) for text in texts]
        if self.searches_largest and not numbers[0] >= 1e-300:
            self.fail(entry, "allowed is a number from 1e-300 to inf")
        return numbers

    def value_name(self):
        """What the study measures."""
        return self.search_entries[0] if self.searches_largest else self.error_name

    def found_names(self):
        """What the search for the least error finds, by the names of the entries alone where these differ."""
        names = [entry.rpartition("/")[2] for entry in self.search_entries] if self.searches_least else []
        return names if len(set(names)) == len(names) else self.search_entries

    def error_of(self, values, references):
        errors = [abs(value) if right is None else abs((value - right) / right) if right else math.nan
                  for value, right in zip(values, references)]
        return {"mean": sum(errors) / len(errors), "largest": max(errors),
                "root mean square": math.sqrt(sum(error**2 for error in errors) / len(errors))}[self.combination]
