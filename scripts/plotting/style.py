# SPDX-License-Identifier: LGPL-2.1-or-later
"""The style of all pictures."""

import matplotlib

matplotlib.use("Agg")

from matplotlib import pyplot  # noqa: E402  the backend has to be chosen first

ELEMENT_COLOUR = "#1f5f99"
PARTICLE_COLOUR = "#d1602a"
EXACT_COLOUR = "#222222"
INTERFACE_COLOUR = "#888888"

pyplot.rcParams.update({
    "figure.dpi": 130,
    "savefig.dpi": 130,
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-3, 4),
})


def panels(n_panels, n_columns, width, height, **options):
    """A figure with n_panels axes in rows of n_columns; the rest of the last row stays empty."""
    n_columns = min(n_columns, n_panels)
    n_rows = -(-n_panels // n_columns)
    figure, axes = pyplot.subplots(n_rows, n_columns, squeeze=False, layout="constrained",
                                   figsize=(width * n_columns, height * n_rows), **options)
    axes = list(axes.flat)
    for index, axis in enumerate(axes[n_panels:], start=n_panels):
        figure.delaxes(axis)
        # With shared coordinates the panel above is now the lowest of its column.
        axes[index - n_columns].tick_params(labelbottom=True)
    return figure, axes[:n_panels]


def legend_above(figure, labels):
    """One legend for all panels, in a strip of its own; labels: {text: handle}."""
    n_columns = max(1, min(len(labels), int(figure.get_figwidth() / 1.3)))
    strip = 0.25 * -(-len(labels) // n_columns) / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - strip))
    figure.legend(labels.values(), labels.keys(), loc="upper center", ncols=n_columns)


def save(figure, path):
    figure.savefig(path)
    pyplot.close(figure)
    return path


def number(value):
    return f"{value:.6g}"
