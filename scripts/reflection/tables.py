# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a reflection study prints and writes."""

import math

# Columns of reflection.csv: what is known of a row, and what came of it, in percent or as it is.
SETTINGS = {
    "left": lambda row: row.case.left, "right": lambda row: right_name(row.case), "element": lambda row: row.case.element,
    "spacing_ratio": lambda row: row.ratio, "spacing_along [h]": lambda row: row.case.row_spacing,
    "dilation": lambda row: row.case.dilation, "smoothing": lambda row: row.case.smoothing, "bridge": lambda row: row.case.bridge,
    "filter_power": lambda row: row.case.filter_power, "filter_strength": lambda row: row.case.filter_strength,
    "filter_interval": lambda row: row.case.filter_interval, "poissons_ratio": lambda row: row.case.poissons_ratio,
    "wave": lambda row: row.case.wave, "angle [degrees]": lambda row: row.degrees, "wavelength [h]": lambda row: row.case.wavelength,
}
PERCENTAGES = ("reflection", "converted", "total", "smoothed", "unsmoothed", "transmitted_energy", "exact", "reference",
               "phase_error", "fit_error", "remaining")
RESULTS = {"frequency [c/h]": "frequency", "group_velocity [c]": "group_velocity", "time_step [h/c]": "time_step", "steps": "n_steps",
           "columns": "n_columns"}


def right_name(case):
    return "same " * case.is_one_part + case.right


def percentage(row, name):
    return row.reference if name == "reference" else 100 * getattr(row.result, name)


def as_text(value):
    if isinstance(value, str):
        return value
    return f"{value:.8g}" if math.isfinite(value) else ""


def csv(groups):
    """The text of reflection.csv."""
    lines = [["group", *SETTINGS, *(f"{name} [%]" for name in PERCENTAGES), *RESULTS, "wall_time [s]"]]
    for group in groups:
        for row in group.rows:
            lines.append([group.name, *(value(row) for value in SETTINGS.values()), *(percentage(row, name) for name in PERCENTAGES),
                          *(getattr(row.result, name) for name in RESULTS.values()), row.seconds])
    return "".join(",".join(map(as_text, line)) + "\n" for line in lines)


def table(group):
    """What is printed of a group."""
    columns = {"reflection": "   |R| %", "converted": "  conv. %", "total": "  total %", "smoothed": "     v %",
               "unsmoothed": "  v_hat %"}
    for name, title in (("exact", "  exact %"), ("reference", "  reference %")):
        if any(math.isfinite(percentage(row, name)) for row in group.rows):
            columns[name] = title
    lines = ["", group.name + (f": {group.title}" if group.title else ""),
             "pair                      ratio  dilation smoothing   bridge filter    nu    wave angle  lambda/h" + "".join(columns.values())]
    for row in group.rows:
        case = row.case
        filter_name = f"{case.filter_power}, {case.filter_strength:g}" if case.filter_power else "-"
        line = (f"{case.left}-{right_name(case):<{25 - len(case.left)}}{row.ratio:<7}{case.dilation:<9g}{case.smoothing:<12}"
                f"{case.bridge:<7}{filter_name:<10}{case.poissons_ratio:<6g}{case.wave:<5}{row.degrees:>5g}{case.wavelength:>10g}")
        for name, title in columns.items():
            value = percentage(row, name)
            line += f"{value:.3f}".rjust(len(title)) if math.isfinite(value) else "-".rjust(len(title))
        lines.append(line)
    return "\n".join(lines) + "\n"


def calibration(groups):
    """How far reflections are from those that are known exactly, for summary.json."""
    errors = [abs(row.result.reflection / row.result.exact - 1) for group in groups for row in group.rows if row.result.exact > 0]
    return {"cases_with_exact_reflection": len(errors), "largest_relative_error_against_exact_reflection": max(errors)} if errors else {}
