# SPDX-License-Identifier: LGPL-2.1-or-later
"""Starts a program many times, each time in a child of one process that has it loaded already
(tests/fuzz/fork_server.c)."""

import collections
import os
import select
import signal
import subprocess
import time

# How a child ended: the exit code (negative: the signal), why it was stopped (None, "asked": SIGTERM
# as it stepped on and on, "set-up", "end", "hang"), its seconds of processor time.
Ending = collections.namedtuple("Ending", "code stopped seconds")

# MPI on one process alone, without the daemon and the network drivers that it would wait for.
ALONE = {"OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_pml": "ob1", "OMPI_MCA_btl": "self",
         "OMPI_MCA_osc": "sm,rdma", "OMPI_MCA_io": "romio321", "OMPI_MCA_coll": "basic,libnbc,self,inter",
         "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMP_NUM_THREADS": "1",
         "DEAL_II_NUM_THREADS": "1"}

TICK = os.sysconf("SC_CLK_TCK")


class Limits:
    """Seconds of processor time, bytes. `patience` is wall time without any processor time."""

    def __init__(self, scale=1., memory=0):
        self.set_up = 20. * scale  # until the run writes its log
        self.steps = 1. * scale  # then it is requested to end
        self.end = 10. * scale  # and must have ended
        self.patience = 30. * scale
        self.memory = memory  # beyond what the program uses by itself
        self.file_size = 300000000


class ForkServer:
    """A program in a process of its own; `directory` is for what MPI leaves lying about while it runs."""

    def __init__(self, program, library, directory):
        self.program = program
        requests, self.requests = os.pipe()
        self.answers, answers = os.pipe()
        environment = dict(os.environ, **ALONE, TMPDIR=directory, LD_PRELOAD=library,
                           TOMBOLO_FORK_SERVER="%d,%d" % (requests, answers))
        environment["ASAN_OPTIONS"] = "verify_asan_link_order=0:" + os.environ.get("ASAN_OPTIONS", "")
        self.process = subprocess.Popen([program], env=environment, pass_fds=(requests, answers),
                                        stdin=subprocess.DEVNULL, start_new_session=True)
        os.close(requests)
        os.close(answers)
        self.buffer = b""
        self.size = 0

    def close(self):
        os.close(self.requests)
        self.process.wait()
        os.close(self.answers)

    def _line(self, timeout):
        """A line of an answer, or None if it does not come in time."""
        while b"\n" not in self.buffer:
            if not select.select([self.answers], [], [], timeout)[0]:
                return None
            piece = os.read(self.answers, 4096)
            if not piece:
                raise RuntimeError("the process that starts %s has ended" % self.program)
            self.buffer += piece
        line, self.buffer = self.buffer.split(b"\n", 1)
        return line

    def run(self, directory, output, arguments, limits, steps_on):
        """Runs the program in a directory. steps_on() returns whether a run is beyond its set-up, so that
        SIGTERM must end it in good order."""
        # What is loaded is known once it serves; the first run has no limit.
        memory = self.size + limits.memory if self.size > 0 else 0
        fields = [directory, output, str(memory), str(limits.file_size), self.program] + arguments
        request = b"".join(os.fsencode(field) + b"\0" for field in fields)
        os.write(self.requests, b"%d\n" % len(request) + request)
        child = int(self._line(None))
        if self.size == 0:
            with open("/proc/%d/statm" % self.process.pid) as file:
                self.size = int(file.read().split()[0]) * os.sysconf("SC_PAGESIZE")
        stopped = None
        spent = stopped_at = last_spent = 0.
        last_change = time.monotonic()
        while True:
            line = self._line(0.05)
            if line is not None:
                return Ending(os.waitstatus_to_exitcode(int(line)), stopped, spent)
            spent = processor_seconds(child, spent)
            now = time.monotonic()
            if spent > last_spent:
                last_spent, last_change = spent, now
            if now - last_change > limits.patience:
                stopped = "hang"
            elif stopped is None and spent > limits.steps and steps_on():
                stopped, stopped_at = "asked", spent
                os.kill(child, signal.SIGTERM)
            elif stopped is None and spent > limits.set_up:
                stopped = "set-up"
            elif stopped == "asked" and spent > stopped_at + limits.end:
                stopped = "end"
            if stopped not in (None, "asked"):
                os.kill(child, signal.SIGKILL)


def processor_seconds(process, otherwise):
    try:
        with open("/proc/%d/stat" % process) as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / TICK
    except (OSError, IndexError):
        return otherwise
