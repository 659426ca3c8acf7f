#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""usage: man_page.py PROGRAM: the page tombolo(1), in roff, from what the program says of its options and entries."""

import json
import re
import subprocess
import sys


def said(program, *arguments):
    return subprocess.run([program, *arguments], capture_output=True, text=True, check=True).stdout


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-").replace('"', "\\(dq")
    return "\n".join("\\&" + line if line[:1] in (".", "'") else line for line in text.splitlines())


def options_of(text):
    """[(option, what it does), ...] of --help."""
    found = []
    for line in text.splitlines()[1:]:
        if match := re.match(r"  (-\S.*?)(?:\s{2,}(\S.*))?$", line):
            found.append([match[1], match[2] or ""])
        elif found:
            found[-1][1] += " " + line.strip()
    return [(option, meaning.strip()) for option, meaning in found]


def entries_of(markdown):
    """[(section, [(entry, default, meaning), ...]), ...] of --print-parameters=markdown."""
    sections = [("", [])]
    for line in markdown.splitlines():
        if match := re.match(r"#{2,} `?(.*?)`?$", line):
            sections.append((match[1], []))
        elif (match := re.match(r"\| `([^`]+)` \| (.*?) \| .*? \| (.*) \|$", line)):
            sections[-1][1].append(match.groups())
    return [(name, entries) for name, entries in sections if entries]


def main():
    program = sys.argv[1]
    version = json.loads(said(program, "--version"))["tombolo"]
    print(f'.TH TOMBOLO 1 "" "Tombolo {version}" "User Commands"')
    print(".SH NAME\ntombolo \\- explicit finite elements coupled with a Lagrangian particle method")
    print(".SH SYNOPSIS\n.B tombolo\n[\\fIoptions\\fR] \\fIFILE.prm\\fR\n.br\n.B mpirun \\-n \\fIRANKS\\fB tombolo\n"
          "[\\fIoptions\\fR] \\fIFILE.prm\\fR")
    print(".SH DESCRIPTION\nRuns the scene of a parameter file and leaves results, tables and a log in its output directory.\n"
          "Scenes to begin with are in share/tombolo/parameter_files of the installation, pages in share/doc/tombolo.")
    print(".SH OPTIONS")
    for option, meaning in options_of(said(program, "--help")):
        print(f".TP\n.B {roff(option)}\n{roff(meaning)}")
    print(".SH ENTRIES OF A PARAMETER FILE\nIn parentheses the default. Sections of parts, materials, conditions and others that "
          "a file names are\nlisted by\n.B tombolo \\-\\-print\\-parameters FILE.prm\nand in the page parameters.md.")
    for section, entries in entries_of(said(program, "--print-parameters=markdown")):
        print(f".SS {roff(section)}")
        for entry, default, meaning in entries:
            default = f"({roff(default.strip('`'))}) " if default.strip() else ""
            print(f".TP\n.B {roff(entry)}\n{default}{roff(meaning.replace('`', ''))}")
    print(".SH SEE ALSO\n.BR tombolo\\-plot (1),\n.BR tombolo\\-report (1);\neach explains itself with \\-\\-help.")


if __name__ == "__main__":
    main()
