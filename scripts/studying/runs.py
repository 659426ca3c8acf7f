# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes the runs of a study, each once."""

import hashlib
import json
import math
import os
import re
import signal
import subprocess
import threading
import time
from dataclasses import dataclass, field
from fnmatch import translate
from pathlib import Path

from tombolo.parameter_file import InputError, ParameterFile
from .least import LeastError
from .quantities import NoValue
from .settings import BASE_FILE, OUTPUT_MARK

STATES = ("measured", "refused", "stopped", "no value", "timed out", "crashed")


class StudyInterrupted(Exception):
    """A signal; runs that have ended are kept."""


class StudyError(Exception):
    """The study cannot go on."""


@dataclass
class Run:
    """One choice of the factors, what it runs with, and what came of it."""
    choice: tuple
    label: str
    name: str
    base_file: str
    settings: list
    key: str = ""
    state: str = "no value"
    message: str = ""
    values: list = field(default_factory=list)
    columns: list = field(default_factory=list)
    cost: float = math.nan
    found: list = field(default_factory=list)
    n_executions: int = 0


def as_file_name(text):
    """The text without what file names should not have."""
    text = re.sub(r" +", "", text).replace(",", "+")
    return re.sub(r"[^A-Za-z0-9.=+-]", "_", text)[:150]


def digests_of_files(file, settings):
    """Those of meshes, tables and other files that entries name, by the whole value or a word of it, beside the parameter
    files or in the working directory."""
    values = [value for value, _ in file.entries.values()] + [setting.partition("=")[2].strip() for setting in settings]
    words = {word for value in values for word in (value, *re.split(r"[\s,;()]+", value)) if "." in word}
    directories = {"", *(os.path.dirname(where) for _, where in file.entries.values()), os.path.dirname(file.path)}
    for path in sorted({os.path.join(directory, word) for directory in directories for word in words}):
        if os.path.isfile(path):
            yield f"{path} {hashlib.sha256(Path(path).read_bytes()).hexdigest()}\n"


def make_runs(study):
    files, runs, names = {}, [], set()

    def file_of(path):
        if path not in files:
            files[path] = ParameterFile(path)
        return files[path]

    def entries_of(path, pattern):
        """Those that an entry with `*` for names means: of all sections of the file that match."""
        if "*" not in pattern:
            return [pattern]
        section, _, entry = pattern.rpartition("/")
        match = re.compile(translate(section).replace(".*", "[^/]*"))
        return sorted(f"{one}/{entry}" for one in file_of(path).sections if match.fullmatch(one))

    for choice in study.choices():
        chosen = [(factor, factor.values[value]) for factor, value in zip(study.factors, choice) if value is not None]
        base_file = next((texts[factor.entries.index(BASE_FILE)] for factor, (_, texts) in chosen if BASE_FILE in factor.entries),
                         study.base_file)
        settings = list(study.common_settings)
        for factor, (_, texts) in chosen:
            for pattern, text in zip(factor.entries, texts):
                if pattern == BASE_FILE or not text:
                    continue
                entries = entries_of(base_file, pattern)
                if not entries:
                    study.fail(f"Factor: {factor.name}/Entries", f'no section of {base_file} matches "{pattern}"')
                settings += [f"{entry} = {text}" for entry in entries]
        label = ", ".join(f"{factor.name} = {label}" for factor, (label, _) in chosen)
        name = as_file_name(label)
        while name in names:
            name += "_"
        names.add(name)
        run = Run(choice, label, name, base_file, settings)
        run.key = file_of(base_file).text + "".join(digests_of_files(file_of(base_file), settings))
        runs.append(run)
    return runs


def words_of(screen):
    """What the program prints after "Error: " or "The run stopped: ", on one line."""
    text = screen.read_text("utf-8", errors="replace") if screen.exists() else ""
    for mark in ("\nError: ", "\nThe run stopped: "):
        begin = text.rfind(mark)
        if begin >= 0:
            rest = text[begin + len(mark):]
            return " ".join(re.split("\nThe outputs written before|\n\n", rest)[0].split())
    return ""


class Runner:
    """Makes one run, or those of its search."""

    def __init__(self, executor, run):
        self.study, self.executor, self.one = executor.study, executor, run
        self.output = executor.directory / run.name
        self.unit, self.last = 1.0, ("measured", "")

    def measure(self):
        for _ in range(self.study.repetitions):
            self.one.state, self.one.message = self.execute([])
            if self.one.state != "measured" or not self.read_values():
                return

    def search_largest(self):
        study, one = self.study, self.one
        one.state, one.cost = "measured", 0.0
        if study.search_unit and not self.find_unit():
            return
        (smallest,), (largest,) = study.search_from, study.search_to
        if self.succeeds(largest):
            one.values, one.message = [largest], "succeeds at the largest value tried"
            return
        failing, succeeding, why = largest, smallest, self.last[1]
        if not self.succeeds(succeeding):
            one.state = "no value" if self.last[0] == "measured" else self.last[0]
            one.message = "fails at the smallest value tried: " + self.last[1]
            return
        while failing > (1 + study.search_tolerance) * succeeding:
            middle = math.sqrt(succeeding * failing)
            if self.succeeds(middle):
                succeeding = middle
            else:
                failing, why = middle, self.last[1]
        one.values, one.message = [succeeding], "beyond: " + why

    def search_least(self):
        if not self.study.search_unit or self.find_unit():
            LeastError(self).search()

    def execute(self, more_settings):
        """State and message."""
        study, one = self.study, self.one
        command = ["mpirun", "-n", str(study.ranks)] if study.ranks > 1 else []
        command += [self.executor.program, one.base_file, "--quiet", "--overwrite"]
        for setting in [*one.settings, *more_settings, f"Output directory = {self.output}"]:
            command += ["--set", setting]
        (self.output / "summary.json").unlink(missing_ok=True)
        screen = Path(f"{self.output}.txt")
        begin = time.monotonic()
        code = self.executor.end_of(command, screen)
        one.n_executions += 1
        if study.searches_largest:
            one.cost += time.monotonic() - begin
        if code is None:
            return "timed out", "it took longer than the time limit"
        if code < 0:
            return "crashed", f"signal {-code}"
        if code == 0:
            return "measured", ""
        words = words_of(screen)
        if not words or code > 2:
            return "crashed", f"exit code {code}" + (f": {words}" if words else "")
        return ("refused" if code == 1 else "stopped"), words

    def run_measurement(self):
        """Throws NoValue with what the program prints where it fails."""
        if not self.study.measurement:
            return
        screen = Path(f"{self.output}.measurement.txt")
        if self.executor.end_of([word.replace(OUTPUT_MARK, str(self.output)) for word in self.study.measurement], screen) != 0:
            lines = [line for line in screen.read_text("utf-8", errors="replace").splitlines() if line]
            raise NoValue("it could not be measured: " + (lines[-1] if lines else f"see {screen}"))

    def find_unit(self):
        """Executes the run as it is and reads the unit of the search from it."""
        self.one.state, self.one.message = self.execute([])
        if self.one.state == "measured":
            try:
                self.unit = self.study.search_unit.value(self.output)
            except NoValue as error:
                self.one.state, self.one.message = "no value", str(error)
        return self.one.state == "measured"

    def succeeds(self, value):
        self.last = self.execute([f"{self.study.search_entries[0]} = {value * self.unit:.12g}"])
        return self.last[0] == "measured" and self.is_within_bounds()

    def is_within_bounds(self):
        for bound, limit in zip(self.study.bounds, self.study.limits):
            try:
                found = bound.value(self.output)
            except NoValue as error:
                self.last = "no value", str(error)
                return False
            if not abs(found) <= limit:
                self.last = "measured", f"{bound.text} is {found:g}"
                return False
        return True

    def read_values(self):
        one = self.one
        try:
            self.run_measurement()
            one.values = [target.value(self.output) for target in self.study.targets]
            cost = self.study.cost.value(self.output)
        except NoValue as error:
            one.state, one.message = "no value", str(error)
            return False
        one.cost = min(one.cost, cost) if one.n_executions > 1 else cost
        one.columns = []
        for column in self.study.columns:
            try:
                one.columns.append(column.value(self.output))
            except NoValue:  # a run without cells has no time per cell
                one.columns.append(math.nan)
        return True


class Executor:
    """Makes the runs that have not been made before, as many at a time as the study has."""

    def __init__(self, study, program, directory, log):
        self.study, self.program, self.directory, self.log = study, program, directory, log
        self.is_interrupted, self.failure = threading.Event(), None
        self.lock = threading.Lock()

    def end_of(self, command, screen, has_limit=True):
        """The exit code of a program whose screen is written to a file, negative after a signal, None where it ran longer
        than the time limit. A program that is ended is ended with what it has started."""
        screen.unlink(missing_ok=True)  # what there was, not what a link leads to
        try:
            with open(screen, "xb") as file, subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file,
                                                              stderr=subprocess.STDOUT, start_new_session=True) as process:
                end = time.monotonic() + (has_limit and self.study.time_limit or math.inf)
                while process.poll() is None:
                    if self.is_interrupted.is_set() or time.monotonic() > end:
                        self.end(process)
                        if self.is_interrupted.is_set():
                            raise StudyInterrupted
                        return None
                    time.sleep(0.002)
                return process.returncode
        except OSError as error:
            raise StudyError(f"The program {command[0]} cannot be started with its output in {screen}: {error.strerror}.") from error

    @staticmethod
    def end(process):
        """A program that hangs may ignore SIGTERM; mpirun passes it on and ends its ranks."""
        for sent, patience in ((signal.SIGTERM, 2), (signal.SIGKILL, None)):
            try:
                os.killpg(process.pid, sent)
                process.wait(patience)
            except ProcessLookupError:
                break
            except subprocess.TimeoutExpired:
                continue

    def set_keys(self, runs):
        """What decides whether a run that was made before is the same: the program, all that it reads, what is measured."""
        file = self.directory / "program.txt"
        if self.end_of([self.program, "--version"], file, has_limit=False) != 0:
            raise StudyError(f"The program {self.program} does not tell its version: see {file}.")
        study = self.study
        measured = [study.ranks, study.repetitions, study.search_entries, study.measurement,
                    [target.key for target in [*study.targets, *study.columns, study.cost]]]
        if study.search_entries:
            measured += [study.search_from, study.search_to, study.search_tolerance, study.limits,
                         [bound.key for bound in [*study.bounds, *filter(None, [study.search_unit])]]]
        if study.searches_least:
            measured += [study.search_runs, study.references, study.combination]
        for run in runs:
            inputs = file.read_text("utf-8", errors="replace") + run.key + "\n".join(run.settings) + json.dumps(measured)
            run.key = hashlib.sha256(inputs.encode()).hexdigest()

    def record_of(self, run):
        return self.directory / f"{run.name}.json"

    def read_record(self, run):
        """Whether the run was made before. One that cannot be read is made again."""
        try:
            record = json.loads(self.record_of(run).read_text("utf-8"))
            if record["key"] != run.key or record["state"] not in STATES:
                return False
            run.state, run.message, run.n_executions = record["state"], record["message"], record["runs"]
            run.values, run.columns, run.found, (run.cost,) = (
                [math.nan if value is None else float(value) for value in values]
                for values in (record["values"], record["columns"], record["found"], [record["cost"]]))
            return True
        except (OSError, ValueError, KeyError, TypeError):
            return False

    def write_record(self, run):
        def finite(values):
            return [value if math.isfinite(value) else None for value in values]
        record = {"key": run.key, "label": run.label, "state": run.state, "message": run.message, "values": finite(run.values),
                  "columns": finite(run.columns), "found": finite(run.found), "cost": finite([run.cost])[0],
                  "runs": run.n_executions}
        part = self.record_of(run).with_suffix(".json.part")
        part.write_text(json.dumps(record, indent=2, ensure_ascii=False) + "\n", "utf-8")
        part.replace(self.record_of(run))

    def execute(self, runs, is_anew):
        self.directory.mkdir(parents=True, exist_ok=True)
        self.set_keys(runs)
        pending = [run for run in runs if is_anew or not self.read_record(run)]
        self.log(f"{len(runs)} runs, {len(runs) - len(pending)} of which have run before")
        left, n_done = iter(pending), 0

        def work():
            nonlocal n_done
            while not self.is_interrupted.is_set():
                with self.lock:
                    run = next(left, None)
                if run is None:
                    return
                try:
                    self.make(run)
                except Exception as error:  # pylint: disable=broad-except  handed to the thread that waits
                    with self.lock:
                        self.failure = self.failure or error
                    self.is_interrupted.set()
                    return
                with self.lock:
                    n_done += 1
                    self.log(f"[{n_done}/{len(pending)}] {line_of(run)}")

        threads = [threading.Thread(target=work) for _ in range(self.study.at_a_time)]
        for thread in threads:
            thread.start()
        for thread in threads:
            while thread.is_alive():
                # A signal that another thread receives does not wake this one, which alone handles it.
                thread.join(0.1)
        if self.failure:
            raise self.failure
        if self.is_interrupted.is_set():
            raise StudyInterrupted

    def make(self, run):
        run.n_executions = 0
        runner = Runner(self, run)
        if self.study.searches_least:
            runner.search_least()
        elif self.study.searches_largest:
            runner.search_largest()
        else:
            runner.measure()
        if run.state != "measured":
            run.values = []
        run.columns = run.columns or [math.nan] * len(self.study.columns)
        self.write_record(run)


def line_of(run):
    if run.state != "measured":
        return f"{run.label}: {run.state}: {run.message}"
    remark = f" ({run.message})" if run.message else ""
    return f"{run.label}: {', '.join('%.4g' % value for value in run.values)} at a cost of {run.cost:.4g}{remark}"
