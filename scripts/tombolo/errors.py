# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a user can correct, and hints at the nearest name."""

import difflib


class TomboloError(Exception):
    """Something that the user can correct: a sentence, printed without a trace."""


def nearest(name, known):
    """A hint at the nearest known name, or nothing."""
    found = difflib.get_close_matches(name.lower(), [one.lower() for one in known], 1, 0.6)
    return next((f' Did you mean "{one}"?' for one in known if found and one.lower() == found[0]), "")
