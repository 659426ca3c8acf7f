# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command line of scripts that read a described parameter file."""

import argparse
import sys
from pathlib import Path

from .parameter_file import ParameterFile


def parser_of(program, *further_flags):
    parser = argparse.ArgumentParser(prog=program, add_help=False, allow_abbrev=False)
    parser.add_argument("file", type=Path)
    for option in ("--validate", "--print-parameters", *further_flags):
        parser.add_argument(option, action="store_true")
    parser.add_argument("--set", action="append", default=[])
    return parser


def settings_of(arguments, kind):
    """The file with what --set overrides, as that `kind` of DescribedFile. --print-parameters prints
    it, and nothing else is done."""
    file = ParameterFile(arguments.file)
    for assignment in arguments.set:
        file.override(assignment)
    settings = kind(file)
    if arguments.print_parameters:
        print(settings.listing(documents=True), end="")
        sys.exit()
    return settings
