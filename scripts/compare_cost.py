#!/usr/bin/env python3

# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a run costs with one build of the program, against another build.

    compare_cost.py [--pairs N] PROGRAM OTHER_PROGRAM FILE.prm [options of the program]

Runs both in turn, changing which is first, and prints the ratio of their user times: the median of
the pairs, the quarter and three quarter points, and the ratio of the smallest times. Where the time
goes to something else than steps, choose a longer run. On a machine that others use, look at the
spread before the median.

What a scene of mechanics pays for heat that it does not have: one-point elements and particles, 29189
nodes,

    compare_cost.py build/bin/tombolo OTHER/build/bin/tombolo parameter_files/elastic_wave/fe.prm \\
      --set "Mesh/box/Cells = 100, 16, 16" --set "Time step/Fixed = 0.01" --set "End time = 10" \\
      --set "Output/Times = 5" --set "Output/Write solution = false"

and with particles.prm and an end time of 2.
"""

import os
import statistics
import subprocess
import sys
import tempfile


def user_seconds(command):
    """User time of a run, of all its threads."""
    with tempfile.TemporaryDirectory(prefix="tombolo_cost_") as directory:
        process = subprocess.Popen(command + ["--quiet", "--set", "Output directory = " + directory],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            sys.exit("%s ended with %d" % (" ".join(command), process.returncode))
    return usage.ru_utime


def main(arguments):
    n_pairs = 10
    if arguments[:1] == ["--pairs"]:
        n_pairs = int(arguments[1])
        arguments = arguments[2:]
    if len(arguments) < 3 or arguments[0].startswith("-"):
        sys.exit(__doc__)
    programs, options = arguments[:2], arguments[2:]
    seconds = []
    for pair in range(n_pairs):
        times = [0., 0.]
        for which in (0, 1) if pair % 2 == 0 else (1, 0):
            times[which] = user_seconds([programs[which]] + options)
        seconds.append(times)
        print("pair %d: %.3f s, %.3f s, ratio %.4f" % (pair + 1, times[0], times[1],
                                                       times[0] / times[1]), flush=True)
    ratios = sorted(first / second for first, second in seconds)
    quarters = statistics.quantiles(ratios, n=4) if n_pairs > 1 else [ratios[0]] * 3
    print("ratio: median %.4f, quarters %.4f to %.4f, of the smallest times %.4f" %
          (statistics.median(ratios), quarters[0], quarters[2],
           min(times[0] for times in seconds) / min(times[1] for times in seconds)))


if __name__ == "__main__":
    main(sys.argv[1:])
