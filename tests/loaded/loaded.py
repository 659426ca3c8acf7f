# SPDX-License-Identifier: LGPL-2.1-or-later
"""Starts a program whose libraries are loaded already: most of the time of a short run is theirs.

A process that has loaded the program (program_server.c) forks for each run, and
start_loaded.c replaces the program in a command, under mpirun, too. A run that is
killed, limited or traced from outside must be started directly.
"""

import atexit
import os
import shutil
import socket
import subprocess
import tempfile
import time

# MPI on one process without a daemon, and on one machine without drivers of networks. After ranks that
# end with an error mpirun waits a second before it kills what is left of them.
ALONE = {"OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_pml": "ob1", "OMPI_MCA_btl": "self"}
TOGETHER = {"OMPI_MCA_pml": "ob1", "OMPI_MCA_btl": "self,vader", "OMPI_MCA_odls_base_sigkill_timeout": "0"}


class Server:
    def __init__(self, program, library):
        self.directory = tempfile.mkdtemp(prefix="tombolo_loaded_")
        self.socket = os.path.join(self.directory, "socket")
        reading, self.writing = os.pipe()
        environment = dict(os.environ, LD_PRELOAD=library, TOMBOLO_PROGRAM_SERVER="%d,%s" % (reading, self.socket))
        environment["ASAN_OPTIONS"] = "verify_asan_link_order=0:" + os.environ.get("ASAN_OPTIONS", "")
        self.process = subprocess.Popen([program], env=environment, pass_fds=(reading,), stdin=subprocess.DEVNULL)
        os.close(reading)
        atexit.register(self.close)
        while not self.answers():
            if self.process.poll() is not None:
                raise RuntimeError("the process that has %s loaded has ended" % program)
            time.sleep(0.01)

    def answers(self):
        """Whether it listens; the socket is there a little sooner."""
        with socket.socket(socket.AF_UNIX) as connection:
            return connection.connect_ex(self.socket) == 0

    def close(self):
        os.close(self.writing)
        self.process.wait()
        shutil.rmtree(self.directory, True)


SERVERS = {}


def start_of(program):
    """The command that runs a program, as a list; the program itself where it was not built with these tests."""
    if program not in SERVERS:
        build = os.path.dirname(os.path.dirname(os.path.abspath(program)))
        start = os.path.join(build, "bin", "start_loaded")
        library = os.path.join(build, "lib", "libprogram_server.so")
        SERVERS[program] = [program]
        if os.path.exists(start) and os.path.exists(library):
            SERVERS[program] = [start, Server(program, library).socket]
    return SERVERS[program]


def environment(ranks):
    """The environment of a command that runs a program on so many ranks."""
    return dict(os.environ, **(ALONE if ranks == 1 else TOGETHER))
