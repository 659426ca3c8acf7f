# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a reflection study prints and writes."""

import math

# Columns of reflection.csv: what is known of a case, and what came of it, in percent or as it is.
SETTINGS = {
    "element": "element", "spacing_ratio": None, "spacing_along [h]": "row_spacing",
    "dilation": "dilation", "smoothing": "smoothing", "bridge": "bridge",
    "filter_power": "filter_power", "filter_strength": "filter_strength",
    "filter_interval": "filter_interval", "poissons_ratio": "poissons_ratio", "wave": "wave",
    "angle [degrees]": None, "wavelength [h]": "wavelength"}
PERCENTAGES = ("reflection", "converted", "total", "smoothed", "unsmoothed", "transmitted_energy",
               "exact", "reference", "phase_error", "fit_error", "remaining")
RESULTS = {"frequency [c/h]": "frequency", "group_velocity [c]": "group_velocity",
           "time_step [h/c]": "time_step", "steps": "n_steps", "columns": "n_columns"}


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
    lines = [["group", "left", "right", *SETTINGS, *(f"{name} [%]" for name in PERCENTAGES),
              *RESULTS, "wall_time [s]"]]
    for group in groups:
        for row in group.rows:
            as_given = {"spacing_ratio": row.ratio, "angle [degrees]": row.degrees}
            lines.append([
                group.name, row.case.left, right_name(row.case),
                *(getattr(row.case, name) if name else as_given[title]
                  for title, name in SETTINGS.items()),
                *(percentage(row, name) for name in PERCENTAGES),
                *(getattr(row.result, name) for name in RESULTS.values()), row.seconds])
    return "".join(",".join(map(as_text, line)) + "\n" for line in lines)


def table(group):
    """What is printed of a group."""
    columns = {"reflection": "   |R| %", "converted": "  conv. %", "total": "  total %",
               "smoothed": "     v %", "unsmoothed": "  v_hat %"}
    for name, title in (("exact", "  exact %"), ("reference", "  reference %")):
        if any(math.isfinite(percentage(row, name)) for row in group.rows):
            columns[name] = title
    lines = ["", group.name + (f": {group.title}" if group.title else ""),
             "pair                      ratio  dilation smoothing   bridge filter    nu    wave "
             "angle  lambda/h" + "".join(columns.values())]
    for row in group.rows:
        case, pair = row.case, f"{row.case.left}-{right_name(row.case)}"
        strength = f"{case.filter_power}, {case.filter_strength:g}" if case.filter_power else "-"
        line = (f"{pair:<26}{row.ratio:<7}{case.dilation:<9g}{case.smoothing:<12}{case.bridge:<7}"
                f"{strength:<10}{case.poissons_ratio:<6g}{case.wave:<5}{row.degrees:>5g}"
                f"{case.wavelength:>10g}")
        for name, title in columns.items():
            value = percentage(row, name)
            line += (f"{value:.3f}" if math.isfinite(value) else "-").rjust(len(title))
        lines.append(line)
    return "\n".join(lines) + "\n"


def calibration(groups):
    """How far reflections are from those that are known exactly, for summary.json."""
    results = [row.result for group in groups for row in group.rows if row.result.exact > 0]
    if not results:
        return {}
    return {"cases_with_exact_reflection": len(results),
            "largest_relative_error_against_exact_reflection":
                max(abs(one.reflection / one.exact - 1) for one in results)}
