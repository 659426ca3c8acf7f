# SPDX-License-Identifier: LGPL-2.1-or-later
"""Tables of a run in HDF5: those that `Table format = hdf5` writes."""

from pathlib import Path

from .errors import TomboloError

FILE = "histories.h5"


def is_cut_short(file):
    """Whether a file is shorter than its superblock (version 2 or 3) states: HDF5 1.14 reads those of a run that writes, and
    does not come back."""
    with open(file, "rb") as stream:
        head = stream.read(48)
        size = stream.seek(0, 2)
    if head[:8] != b"\x89HDF\r\n\x1a\n" or len(head) < 48 or head[8] < 2:
        return False
    width = head[9]
    return size < int.from_bytes(head[12 + 2 * width:12 + 3 * width], "little")


def opened(file):
    try:
        import h5py  # only where it is needed
    except ImportError as error:
        raise TomboloError(f"to read {file} python3-h5py is needed, which scripts/setup installs") from error
    try:
        return h5py.File(file, "r")
    except OSError:
        if is_cut_short(file):
            raise TomboloError(f"{file} is damaged: it is cut short") from None
    try:  # of a run that was killed while it wrote rows, or that writes some just now
        return h5py.File(file, "r", libver="latest", swmr=True)
    except (OSError, ValueError) as error:
        raise TomboloError(f"{file} is damaged: {error}") from error


def has_table(path):
    """Whether a run has the table that `path` names as a file of comma-separated values, there or in HDF5."""
    path = Path(path)
    file = path.with_name(FILE)
    if path.exists() or path.suffix != ".csv" or not file.exists():
        return path.exists()
    with opened(file) as tables:
        return path.stem in tables


def read_table(path):
    """(names of columns, units, rows as lists) of the table in HDF5 that `path` names."""
    path = Path(path)
    try:
        with opened(path.with_name(FILE)) as tables:
            table = tables[path.stem]
            names, units = (list(table.attrs[key]) for key in ("columns", "units"))
            rows = table[:].tolist()
            while rows and rows[-1][0] != rows[-1][0]:  # without a time: not written to a full disk
                rows.pop()
            return names, ["" if unit == "1" else unit for unit in units], rows
    except (OSError, KeyError, ValueError) as error:
        raise TomboloError(f"{path.with_name(FILE)} is damaged: {error}") from error
