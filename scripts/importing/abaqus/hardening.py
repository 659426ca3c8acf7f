# SPDX-License-Identifier: LGPL-2.1-or-later
"""*PLASTIC with HARDENING=KINEMATIC and COMBINED, and *CYCLIC HARDENING: flow around a back stress."""

from math import exp

from ..scene import interpolated, linear_hardening, number, plastic_curve, tabular
from .deck import key

STRAINS = (0, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1)
NUMBERS_OF_LINE = 8
BENDS = (0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1, 1.2, 1.5, 1.8, 2.2, 2.6, 3, 3.5, 4, 5, 6, 8)


class KinematicHardening:
    """Constants over the temperature: yield stresses, moduli and recovery rates of the terms of the back stress, and
    curves of the yield stress over the plastic strain."""

    def __init__(self, remarks):
        self.remarks = remarks
        self.stresses, self.terms, self.curves = {}, {}, {}

    @classmethod
    def of_plastic(cls, section, remarks):
        """Nothing where the keyword has another kind of hardening or data; a remark says so."""
        kind = key(section.get("HARDENING"))
        result = cls(remarks)
        if kind == "KINEMATIC":
            return result if result.read_line(section) else None
        data = key(section.get("DATA TYPE") or section.get("DATATYPE") or "HALF CYCLE")
        if data == "PARAMETERS":
            result.read_parameters(section)
            return result
        remarks.append(f"HARDENING={kind}, DATA TYPE={data}: hardening is isotropic here (DATA TYPE=PARAMETERS is "
                       "kinematic).")
        return None

    def read_line(self, section):
        """Two points of the stress over the plastic strain at each temperature."""
        points = {}
        for row in section.rows():
            points.setdefault(row.number(2), []).append((row.number(1), row.number(0)))
        if any(len(of_one) > 2 for of_one in points.values()):
            self.remarks.append("HARDENING=KINEMATIC with more than two points of a temperature: hardening is isotropic here.")
            return False
        for temperature, of_one in sorted(points.items()):
            of_one = plastic_curve(of_one, section.line.fail)
            (_, first), (strain, last) = of_one[0], of_one[-1]
            slope = (last - first) / strain if strain > 0 else 0.0
            if slope < 0:
                section.line.fail("kinematic hardening needs stresses that do not fall.")
            self.stresses[temperature], self.terms[temperature] = first, [(slope, 0.0)]
        return bool(points)

    def read_parameters(self, section):
        """The yield stress, modulus and rate of each term, and the temperature, on as many lines as they need."""
        text = section.get("NUMBER BACKSTRESSES") or "1"
        n_terms = section.line.integer(text, "NUMBER BACKSTRESSES")
        n_lines = (2 * n_terms + 2 + NUMBERS_OF_LINE - 1) // NUMBERS_OF_LINE
        rows = section.rows()
        # The temperature may be left out, with the line that it would stand on.
        if n_terms < 1 or not rows or len(rows) < (2 * n_terms + NUMBERS_OF_LINE) // NUMBERS_OF_LINE:
            section.line.fail("DATA TYPE=PARAMETERS has a yield stress, and a modulus and a rate of each of NUMBER "
                              "BACKSTRESSES.")
        for k in range(0, len(rows), n_lines):
            values = []
            for row in rows[k:k + n_lines]:
                values += (row.numbers() + [0.0] * NUMBERS_OF_LINE)[:NUMBERS_OF_LINE]
            values += [0.0] * (2 * n_terms + 2)
            temperature = values[2 * n_terms + 1]
            terms = [(values[1 + 2 * i], values[2 + 2 * i]) for i in range(n_terms)]
            if not values[0] > 0 or any(modulus < 0 or rate < 0 for modulus, rate in terms):
                rows[k].line.fail("the yield stress is larger than zero, and moduli and rates are not below zero.")
            self.stresses[temperature], self.terms[temperature] = values[0], terms

    def read_cyclic(self, section):
        """Yield stresses over the plastic strain, or with PARAMETERS σ0 + Q (1 - exp(-b ε))."""
        points = {}
        if section.has("PARAMETERS"):
            for row in section.rows():
                stress, change, rate = (row.number(k) for k in range(3))
                points[row.number(3)] = [(e, stress + change * (1 - exp(-rate * e))) for e in strains_of(rate)]
        else:
            for row in section.rows():
                points.setdefault(row.number(2), []).append((row.number(1), row.number(0)))
        self.curves = {t: plastic_curve(of_one, section.line.fail) for t, of_one in sorted(points.items())}

    # What a scene has.

    def is_kinematic(self):
        return any(modulus > 0 for terms in self.terms.values() for modulus, _ in terms)

    def depends_on_temperature(self):
        return len(self.terms) > 1 or len(self.curves) > 1

    def entries(self, has_heat, temperature):
        """Entries of the flow stress and of the back stress. What is over the temperature is that of the start, but for
        yield stresses of scenes with heat."""
        if self.depends_on_temperature():
            what = "moduli and rates of the back stress are" if has_heat else "constants of the hardening are"
            self.remarks.append(f"The {what} those of the temperature {temperature:g}.")
        terms = [term for term in self.terms_at(temperature) if term[0] > 0]
        return {**self.flow(has_heat, temperature), "Back stress moduli": ", ".join(number(modulus) for modulus, _ in terms),
                "Recovery rates": ", ".join(number(rate) for _, rate in terms)}

    def terms_at(self, temperature):
        n_terms = len(next(iter(self.terms.values())))
        return [tuple(interpolated([(t, terms[k][i]) for t, terms in sorted(self.terms.items())], temperature)
                      for i in (0, 1)) for k in range(n_terms)]

    def flow(self, has_heat, temperature):
        curves = self.curves or {t: [(0.0, stress)] for t, stress in sorted(self.stresses.items())}
        strains = sorted({strain for points in curves.values() for strain, _ in points})
        if has_heat and len(curves) > 1:
            strains = strains if len(strains) > 1 else [0.0, 1.0]
            return {"Flow stress": "tabular", "tabular": {
                "Plastic strains": ", ".join(map(number, strains)), "Temperatures": ", ".join(map(number, curves)),
                "Flow stresses": "; ".join(", ".join(number(interpolated(points, strain)) for strain in strains)
                                           for points in curves.values())}}
        points = [(strain, interpolated([(t, interpolated(of_one, strain)) for t, of_one in curves.items()], temperature))
                  for strain in strains]
        return tabular(points) if len(points) > 1 else linear_hardening(points[0][1], 0)

    def isotropic(self, temperature):
        """The curve of one pull, for materials whose model has no back stress."""
        terms = self.terms_at(temperature)
        flow = self.flow(False, temperature)
        table = flow.get("tabular")
        known = [(0.0, float(flow["linear hardening"]["Yield stress"]))] if table is None else list(zip(
            *(map(float, table[name].split(",")) for name in ("Plastic strains", "Flow stresses"))))
        return tabular([(e, interpolated(known, e) + sum(
            modulus * e if not rate else modulus / rate * (1 - exp(-rate * e)) for modulus, rate in terms))
            for e in sorted({*STRAINS, *(strain for strain, _ in known)})])


def strains_of(rate):
    """Points of 1 - exp(-rate ε), whose chords are within 0.004 of it."""
    return [bend / rate for bend in BENDS] if rate > 0 else [0.0, 1.0]
