# SPDX-License-Identifier: LGPL-2.1-or-later
"""A plug-in from outside: a project of its own finds an installed Tombolo, builds it and runs it.

usage: check.py PREFIX SOURCE DIRECTORY MPIEXEC CMAKE, of a script that makes a Project
"""

import csv
import os
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "loaded"))
import loaded


class Project:
    def __init__(self, *plugins):
        prefix, self.source, self.directory, self.mpiexec, cmake = sys.argv[1:6]
        build, binary = f"{self.directory}/build", os.environ["TOMBOLO_BINARY_DIR"]
        for command in ([cmake, "-S", self.source, "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}"],
                        [cmake, "--build", build]):
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        server = loaded.Server(f"{prefix}/bin/tombolo", f"{binary}/lib/libprogram_server.so")
        self.start = [f"{binary}/bin/start_loaded", server.socket, "--set", "Plugin libraries = "
                      + ", ".join(f"{build}/lib{plugin}.so" for plugin in plugins)]
        self.problems = []

    def run(self, name, file, *settings, ranks=1, options=(), succeeds=True):
        """Runs a scene into the directory of this name; what the program printed."""
        command = [*self.start, "--overwrite", *options]
        for setting in (f"Output directory = {self.directory}/{name}", *settings):
            command += ["--set", setting]
        launcher = [self.mpiexec, "-n", str(ranks)] if ranks > 1 else []
        result = subprocess.run(launcher + command + [f"{self.source}/{file}"], text=True, check=False,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                env=loaded.environment(ranks))
        if (result.returncode == 0) != succeeds:
            sys.exit(f"{name} ended with {result.returncode}:\n{result.stdout}")
        return result.stdout

    def path(self, name, *names):
        return Path(self.directory, name, *names)

    def rows(self, name, table="statistics.csv"):
        """The rows of a table over time, without the units in the names of columns."""
        with open(self.path(name, table), newline="", encoding="utf-8") as file:
            return [{head.split(" [")[0]: float(value) for head, value in row.items() if value}
                    for row in csv.DictReader(file)]

    def expect(self, is_true, text):
        if not is_true:
            self.problems.append(text)

    def end(self):
        for problem in self.problems:
            print(problem)
        sys.exit(1 if self.problems else 0)
