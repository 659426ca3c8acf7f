# SPDX-License-Identifier: LGPL-2.1-or-later
"""The output of a script, on the screen and in a file."""


class Log:
    """Prints lines, and writes them into `file` where that is set."""

    def __init__(self):
        self.file = None

    def __call__(self, text):
        print(text, flush=True)
        if self.file:
            self.file.write(text + "\n")
            self.file.flush()
