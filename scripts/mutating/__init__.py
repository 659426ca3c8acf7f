# SPDX-License-Identifier: LGPL-2.1-or-later
"""Mistakes that tests must detect.

    mutants      the list, and a source with its mistakes in it
    copies       the copy of the project that has all mistakes, each asleep
    runs         the tests of a mistake that is awake
"""
