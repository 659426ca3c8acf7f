# SPDX-License-Identifier: LGPL-2.1-or-later
import tempfile
from pathlib import Path


def violations(check, files):
    """What `check(root)` finds in a project of these files, by name."""
    with tempfile.TemporaryDirectory() as directory:
        root = Path(directory)
        for name, text in files.items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return check(root)[0]
