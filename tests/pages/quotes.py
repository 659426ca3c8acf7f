# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a page quotes of its commands, and whether it is what they print.

In a tutorial each block of commands is run, and a block of code after it that is neither commands nor a piece of a
parameter file must be among what they print. Comments of a page state the rest, and are not shown where it is read:

    <!-- not run: WHY -->             above a block of commands
    <!-- numbers of: COMMANDS -->     above a block of any kind: the numbers that COMMANDS print are in it in their order
    <!-- prints: COMMANDS -->         above a block of code: its lines are among what COMMANDS print

`value DIRECTORY PATH[*FACTOR]...` of such a comment prints numbers of `summary.json`, PATH being names and indices between
slashes, or the last ones of columns of `statistics.csv`.
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(PROJECT / "scripts"), str(PROJECT / "tests" / "loaded")]

import loaded  # noqa: E402
import tombolo  # noqa: E402
from pages import text  # noqa: E402

MARK = re.compile(r"<!--\s*(not run|numbers of|prints):\s*(.*?)\s*-->", re.DOTALL)
COMMAND = re.compile(r"(scripts/|tombolo |awk |tail |gmsh |paraview |sudo )")
PARAMETERS = re.compile(r"\s*(set|subsection|include|end)\b")
NUMBER = r"[-+]?(?<![\w.])(?:\d{1,3}(?:,\d{3})+|\d+)(?:\.\d+)?(?:e[-+]?\d+)?(?!\w)"
# A number below that is a difference of equal ones.
ROUND_OFF = 1e-12

WRAPPERS = {
    "scripts/run": """ranks=
if [[ $1 == -n ]]; then ranks="mpirun --oversubscribe -n $2"; shift 2; fi
exec $ranks $TOMBOLO_START "$@"
""",
    "scripts/plot": 'exec "$PYTHON" -B -m plotting "$@"\n',
    "scripts/report": 'exec "$PYTHON" -B -m reporting "$@"\n',
    "scripts/reflection_study": 'exec "$PYTHON" -B -m reflection "$@"\n',
    "scripts/import": 'exec "$PYTHON" -B -m importing "$@"\n',
    "value": 'exec "$PYTHON" -B "$QUOTES" "$@"\n',
}


class Quote:
    """A block of a page and what must print it: kind is run, prints or numbers."""

    def __init__(self, kind, line, commands, quoted):
        self.kind, self.line, self.commands, self.quoted = kind, line, commands, quoted


def quotes_of(page, is_tutorial):
    """The quotes of the text of a page in their order."""
    quotes, mark, commands = [], None, ""
    marks = {page.count("\n", 0, found.end()) + 1: (found[1], found[2]) for found in MARK.finditer(page)}
    pending = sorted(marks)
    for block in joined(text.blocks_of(page)):
        while pending and pending[0] <= block.line:
            mark = marks[pending.pop(0)]
        kind, argument = mark or (None, "")
        mark = None
        lines = code_lines(block)
        if kind == "numbers of":
            quotes.append(Quote("numbers", block.line, argument, block.text))
        elif kind == "prints":
            quotes.append(Quote("prints", block.line, argument, "\n".join(lines)))
        elif block.kind == "code" and is_tutorial and lines:
            if COMMAND.match(lines[0].strip()):
                commands = "" if kind == "not run" else "\n".join(line.strip() for line in lines)
                if commands:
                    quotes.append(Quote("run", block.line, commands, ""))
            elif commands and not PARAMETERS.match(lines[0]):
                quotes.append(Quote("prints", block.line, commands, "\n".join(lines)))
            else:
                commands = ""
    return quotes


def joined(blocks):
    """The blocks with the lines of one block of indented code together."""
    result = []
    for block in blocks:
        last = result[-1] if result else None
        if last and block.kind == last.kind == "code" and block.line == last.line + last.text.count("\n") + 1:
            last.text += "\n" + block.text
        else:
            result.append(text.Block(block.kind, block.line, block.text))
    return result


def code_lines(block):
    return [line for line in block.text.split("\n") if line.strip() and not text.FENCE.match(line)]


def unit_of(number):
    """The worth of the last digit that a quoted number shows; 0 for a count."""
    mantissa, _, exponent = number.partition("e")
    _, point, decimals = mantissa.partition(".")
    return 10. ** (int(exponent or 0) - len(decimals)) if point or exponent else 0.


def value_of(number):
    return float(number.replace(",", ""))


def is_printed(quoted, printed):
    """Whether a number of a printed line is the quoted one: counts are, others differ by one in the last digit at most,
    and by 1e-9 where they show all digits."""
    a, b = value_of(quoted), value_of(printed)
    if max(abs(a), abs(b)) < ROUND_OFF:
        return True
    return abs(a - b) <= 1.01 * unit_of(quoted) + 1e-9 * abs(b) * bool(unit_of(quoted))


def is_rounded(quoted, printed):
    """Whether a quoted number is a number rounded to the digits that it shows."""
    a, b = value_of(quoted), value_of(printed)
    if max(abs(a), abs(b)) < ROUND_OFF:
        return True
    return abs(a - b) <= 0.5 * (unit_of(quoted) or 1.) + 1e-4 * abs(b)


def pattern_of(line):
    """An expression for lines of the same words as a quoted one, its numbers being groups; "..." is anything."""
    parts = re.split(rf"({NUMBER}|\.\.\.|\s+)", line.strip().rstrip(","))
    pattern = ""
    for part in parts:
        if re.fullmatch(NUMBER, part):
            pattern += f"({NUMBER})"
        elif part == "...":
            pattern += ".*"
        else:
            pattern += r"\s+" if part.isspace() else re.escape(part)
    return re.compile(pattern + ",?")


def wrong_lines(quoted, printed):
    """What of a quoted block is not among printed lines in this order."""
    wrong, lines, start = [], [line.strip() for line in printed.split("\n")], 0
    for line in quoted.split("\n"):
        pattern, numbers = pattern_of(line), re.findall(NUMBER, line)
        alike = [(i, pattern.fullmatch(lines[i])) for i in range(start, len(lines)) if pattern.fullmatch(lines[i])]
        same = [i for i, found in alike if all(map(is_printed, numbers, found.groups()))]
        if same:
            start = same[0] + 1
        else:
            wrong.append(f"quoted:  {line.strip()}\nprinted: " + (alike[0][1][0] if alike else "no such line"))
    return wrong


def wrong_numbers(quoted, printed):
    """Which of the printed numbers are missing in a quoted text in their order."""
    quoted_numbers, start, wrong = re.findall(NUMBER, quoted.replace("−", "-")), 0, []
    for number in re.findall(NUMBER, printed):
        same = [i for i in range(start, len(quoted_numbers)) if is_rounded(quoted_numbers[i], number)]
        if same:
            start = same[0] + 1
        else:
            wrong.append(f"printed {number}, which is not among {' '.join(quoted_numbers[start:])}")
    return wrong if re.search(NUMBER, printed) else ["no number was printed"]


class Shell:
    """Runs commands of a page in a directory of their own; the same ones once."""

    def __init__(self, directory, program, strip_operators=None):
        self.directory, self.printed = Path(directory), {}
        for name, script in WRAPPERS.items():
            path = self.directory / name
            path.parent.mkdir(exist_ok=True)
            path.write_text("#!/usr/bin/env bash\n" + script)
            path.chmod(0o755)
        for name in ("parameter_files", "tests"):
            (self.directory / name).symlink_to(PROJECT / name)
        self.environment = os.environ | {
            "TOMBOLO_START": " ".join(loaded.start_of(str(program))), "TOMBOLO_STRIP_OPERATORS": str(strip_operators or ""), "PYTHON": sys.executable,
            "QUOTES": __file__, "PYTHONPATH": str(PROJECT / "scripts"), "PATH": f"{directory}:{os.environ['PATH']}",
            "OMP_NUM_THREADS": "1"}

    def run(self, commands):
        """What commands print; RuntimeError where one of them fails."""
        if commands not in self.printed:
            ended = subprocess.run(["bash", "-euo", "pipefail", "-c", commands], cwd=self.directory, env=self.environment,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
            if ended.returncode:
                raise RuntimeError(f"{commands}\nended with {ended.returncode}:\n{ended.stdout[-2000:]}")
            self.printed[commands] = ended.stdout
        return self.printed[commands]


def wrong_quotes(page, quotes, shell):
    """What a page quotes and its commands do not print, with the lines of the page. Ends at a command that fails."""
    wrong = []
    for quote in quotes:
        try:
            printed = shell.run(quote.commands)
        except RuntimeError as error:
            return wrong + [f"{page}:{quote.line}: {error}"]
        check = {"run": lambda *_: [], "prints": wrong_lines, "numbers": wrong_numbers}[quote.kind]
        wrong += [f"{page}:{quote.line}: {one}" for one in check(quote.quoted, printed)]
    return wrong


def print_values(directory, *paths):
    summary = json.loads((Path(directory) / "summary.json").read_text("utf-8"))
    table = tombolo.Table(Path(directory) / "statistics.csv", arrays=False)
    for path in paths:
        name, _, factor = path.partition("*")
        found, names = summary, name.split("/")
        if names[0] in summary:
            for one in names:
                found = found[int(one) if isinstance(found, list) else one]
        else:
            found = table[name][-1]
        print(f"{float(found) * float(factor or 1):.12g}")


if __name__ == "__main__":
    print_values(*sys.argv[1:])
