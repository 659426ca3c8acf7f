# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes one HTML page of the output directory of a run; see scripts/report --help."""
