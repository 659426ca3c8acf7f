# SPDX-License-Identifier: LGPL-2.1-or-later
"""The picture of scripts/benchmark --solutions: error over time, with the front of what is best for its time."""

from .style import pyplot, save
from .trade import COLOURS, MARKERS


def draw_solutions(solutions, path):
    """A line for each model on one rank, a point for each size, which is written beside it."""
    rows = [row for row in solutions["rows"] if row["ranks"] == 1]
    front = sorted((row for row in rows if row["on_front"]), key=lambda row: row["seconds"])
    figure, axis = pyplot.subplots(layout="constrained", figsize=(7.6, 3.8))
    least = solutions["levels"][-1]
    best = [100 * max(row["error"], least) for row in front]
    axis.axhspan(0, 100 * least, color="#eeeeee", zorder=0)
    axis.text(0.02, 0.03, "grey: not told apart by the reference", transform=axis.transAxes, fontsize=7)
    axis.step([*(row["seconds"] for row in front), max(row["seconds"] for row in rows)], [*best, best[-1]],
              where="post", color="#222222", linewidth=4, alpha=0.18, label="best for its time")
    for index, model in enumerate(dict.fromkeys(row["model"] for row in rows)):
        own = [row for row in rows if row["model"] == model]
        axis.plot([row["seconds"] for row in own], [100 * row["error"] for row in own], label=model, markersize=5,
                  color=COLOURS[index % len(COLOURS)], marker=MARKERS[index % len(MARKERS)])
        for row in own:
            axis.annotate(row["size"], (row["seconds"], 100 * row["error"]), xytext=(4, 3),
                          textcoords="offset points", fontsize=6, color=COLOURS[index % len(COLOURS)])
    axis.set_xscale("log")
    axis.set_yscale("log")
    for scale in (axis.xaxis, axis.yaxis):
        scale.set_major_formatter(lambda value, _: f"{value:g}")
        scale.set_minor_formatter(lambda value, _: f"{value:g}" if f"{value:e}"[0] in "25" else "")
    axis.set_xlabel("user time [s], one core")
    axis.set_ylabel("error [%]")
    axis.set_title(solutions["title"])
    axis.legend(fontsize=7, loc="center left", bbox_to_anchor=(1, 0.5))
    return save(figure, path)
