# SPDX-License-Identifier: LGPL-2.1-or-later
"""usage: import_keyword FILE.k [FILE.prm]"""

import sys
from pathlib import Path

from .deck import Deck, KeywordError
from .scene import Scene


def main(arguments):
    if not 1 <= len(arguments) <= 2 or arguments[0].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    source = Path(arguments[0])
    target = Path(arguments[1]) if len(arguments) > 1 else source.with_suffix(".prm")
    try:
        if source.suffix.lower() not in (".k", ".key", ".dyn"):
            raise KeywordError("the name does not end in .k, .key or .dyn.")
        scene = Scene(Deck(source), target)
        for path, content in scene.files().items():
            path.write_text(content, encoding="utf-8")
    except KeywordError as error:
        print(f"import_keyword: {source}: {error}", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"import_keyword: {error.filename}: {error.strerror}", file=sys.stderr)
        return 1
    for path in scene.files():
        print(f"import_keyword: wrote {path}")
    for line in scene.report.summary():
        print(f"import_keyword: {line}")
    return 0


sys.exit(main(sys.argv[1:]))
