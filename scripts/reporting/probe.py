# SPDX-License-Identifier: LGPL-2.1-or-later
"""Reading in a child process first: VTK can end the process on a damaged file."""

import os

MARK = b"."


def fatal_items(items, read):
    """The items whose reading ends the process. Errors that `read` raises are left to the caller, which
    reads these items again."""
    items, fatal, first = list(items), set(), 0
    while first < len(items):
        n_read = n_read_by_child(items[first:], read)
        if first + n_read >= len(items):
            break
        fatal.add(items[first + n_read])
        first += n_read + 1
    return fatal


def n_read_by_child(items, read):
    """How many items a child reads before it ends."""
    to_read, to_write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.close(to_read)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # the caller reports the output of a process that dies
            for item in items:
                try:
                    read(item)
                except Exception:  # whatever it is, the process goes on
                    pass
                os.write(to_write, MARK)
        finally:
            os._exit(0)
    os.close(to_write)
    count = 0
    while part := os.read(to_read, 4096):
        count += len(part)
    os.close(to_read)
    os.waitpid(child, 0)
    return count
