# SPDX-License-Identifier: LGPL-2.1-or-later
"""Trade studies: runs of a grid of choices, what they err by and what they cost."""
