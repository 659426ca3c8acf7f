# SPDX-License-Identifier: LGPL-2.1-or-later
"""*MAT_... and *EOS_... as sections of materials."""

from math import exp

from ..scene import (WITHOUT_SOFTENING, at_one_temperature, expansion_increments, linear_hardening, number, over_temperature,
                     plastic_curve, tabular, tabular_over)
from .cards import form_of

MODELS = ("MAT_001", "MAT_003", "MAT_004", "MAT_015", "MAT_020", "MAT_024", "MAT_098", "MAT_106")
NO_FAILURE = 1e10  # a strain
FAR = 10  # a strain beyond those that are reached
EOS = ("EOS_GRUNEISEN", "EOS_LINEAR_POLYNOMIAL")


class Material:
    """A material: entries of its section, and remarks about what is left out."""

    def __init__(self, record, curves):
        self.record, self.curves = record, curves
        self.line = record.section.line
        self.number = record.integer("MID")
        self.density = record.number("RO")
        self.kind = form_of(record.name)
        self.failure_strain, self.has_damage = None, False
        self.equation, self.remarks, self.flow, self.heat = {}, [], {}, {}
        self.is_linear = False  # the equation of state
        self.rows = []  # curves of hardening, by strain rate
        self.moduli = {}
        self.back_stress = 0  # the modulus of kinematic hardening
        self.start_of_tables = record.number("TREF")
        readers = {"MAT_003": self.read_plastic_kinematic, "MAT_004": self.read_over_temperature, "MAT_024": self.read_piecewise_linear,
                   "MAT_098": self.read_simplified_cook, "MAT_106": self.read_viscoplastic_thermal, "MAT_020": self.read_rigid}
        if self.kind == "MAT_015":
            self.read_johnson_cook()
        elif self.kind == "MAT_004":
            self.modulus, self.poisson = record.number("E1"), record.number("PR1")
        else:
            self.modulus, self.poisson = record.number("E"), record.number("PR")
        for name, value in (("density", self.density), ("Young's modulus", self.modulus)):
            self.refuse_zero(name, value)
        if self.kind in readers:
            readers[self.kind]()

    def refuse_zero(self, name, value):
        if value <= 0:
            self.line.fail(f"the {name} of material {self.number} is {value:g}. Allowed is a number larger than zero.")

    def hardening(self, yield_stress, tangent):
        """Linear hardening of a tangent modulus of the uniaxial curve."""
        self.refuse_zero("yield stress (SIGY)", yield_stress)
        return linear_hardening(yield_stress, self.slope(tangent))

    def slope(self, tangent):
        """Of the stress over the plastic strain."""
        self.check_tangent(tangent, self.modulus)
        return self.modulus * tangent / (self.modulus - tangent)

    def check_tangent(self, tangent, modulus):
        if not tangent < modulus:
            self.line.fail(f"ETAN of material {self.number} is {tangent:g}. Allowed is a tangent modulus below E = {modulus:g}.")

    def read_plastic_kinematic(self):
        record = self.record
        self.refuse_zero("yield stress (SIGY)", record.number("SIGY"))
        slope = self.slope(record.number("ETAN"))
        isotropic = min(max(record.number("BETA"), 0.0), 1.0)
        self.flow = linear_hardening(record.number("SIGY"), isotropic * slope)
        if isotropic < 1 and slope > 0:
            self.back_stress = (1 - isotropic) * slope
        self.read_rates("SRC", "SRP")
        self.read_failure_strain("FS")

    def read_rates(self, rate, exponent):
        """The factor of Cowper and Symonds."""
        reference, power = self.record.number(rate), self.record.number(exponent)
        if not reference > 0:
            return
        if power < 1:
            self.remarks.append(f"{exponent} = {power:g} is below 1: the dependence on the strain rate is left out.")
        elif "Strain rates" in self.flow[self.flow["Flow stress"]]:
            self.remarks.append(f"{rate}, {exponent}: the flow stress is a table over the strain rate; the factor of Cowper "
                                "and Symonds is left out.")
        else:
            self.flow[self.flow["Flow stress"]].update(
                {"Cowper-Symonds rate": number(reference), "Cowper-Symonds exponent": number(power)})
            self.remarks.append(f"{rate}, {exponent}: the strain rate is the plastic one.")

    def read_failure_strain(self, name):
        """Programs write a large number for none. One below zero means a subroutine of the user, and is not read."""
        if 0 < self.record.peek(name) < NO_FAILURE:
            self.failure_strain = self.record.peek(name)
        if self.record.peek(name) > 0:
            self.record.number(name)

    def curve_of_flow(self, number_of_curve):
        """Points of a curve, or of the first curve of a table over strain rates, of *MAT_106 over temperatures, of which
        self.rows has all."""
        curves = self.curves
        if number_of_curve in curves.tables:
            table = curves.tables[number_of_curve]
            if table[0][0] < 0 and self.kind != "MAT_106":  # then all are natural logarithms
                table = [(exp(rate), curve) for rate, curve in table]
                self.remarks.append(f"LCSS = {number_of_curve}: between its rates stresses are linear in the rate, not in its "
                                    "logarithm.")
            if len(table) > 1:
                if self.kind != "MAT_106" and self.record.number("VP") != 1:
                    self.remarks.append(f"LCSS = {number_of_curve} is a table over strain rates: they are plastic ones.")
                self.rows = [(rate, self.curve_of_flow(curve)) for rate, curve in table]
                return self.rows[0][1] if all(points for _, points in self.rows) else None
            number_of_curve = table[0][1]
        if number_of_curve not in curves:
            return None
        curve = curves[number_of_curve]
        points = plastic_curve(curve.points, curve.line.fail)
        if curve.points[0][0] > 0:
            self.remarks.append(f"The curve of hardening begins at the strain {curve.points[0][0]:g}: it is constant "
                                "before.")
        return self.with_last_slope(points)

    def with_last_slope(self, points):
        """Beyond its end a curve goes on with its last slope; one that falls stays."""
        (strain, stress), (last_strain, last) = points[-2:] if len(points) > 1 else 2 * points
        if last > stress and last_strain < FAR:
            points = [*points, (FAR, last + (FAR - last_strain) * (last - stress) / (last_strain - strain))]
        elif last < stress:
            self.remarks.append("The curve of hardening falls at its end: it is constant beyond.")
        return points

    def read_piecewise_linear(self):
        record = self.record
        lcss = record.integer("LCSS")
        points = []
        if lcss:
            points = self.curve_of_flow(lcss) or []
            if not points:
                self.remarks.append(f"LCSS = {lcss} is no *DEFINE_CURVE of this file: SIGY and ETAN are taken.")
                if record.number("SIGY") <= 0:
                    self.line.fail(f"LCSS = {lcss} of material {self.number} is no *DEFINE_CURVE of this file, and "
                                   "there is no SIGY.")
        else:
            points = [(record.number(f"EPS{k}"), record.number(f"ES{k}")) for k in range(1, 9)]
            points = [point for point in points if point[1] != 0]
            points = plastic_curve(points, self.line.fail) if points else []
        if len(points) > 1:
            self.flow = self.flow_of(points)
        elif points:
            self.flow = self.hardening(points[0][1], 0)
        else:
            self.flow = self.hardening(record.number("SIGY"), record.number("ETAN"))
        if record.integer("LCSR"):
            self.remarks.append("LCSR: the scale of the flow stress over the strain rate is left out.")
        self.read_rates("C", "P")
        self.read_failure_strain("FAIL")

    def flow_of(self, points):
        over = "Temperatures" if self.kind == "MAT_106" else "Strain rates"
        return tabular_over(over, self.rows) if self.rows else tabular(points)

    def read_over_temperature(self):
        """Up to eight temperatures, the first of constants that do not change."""
        record = self.record
        columns = [[record.number(name + str(k)) for name in ("T", "E", "PR", "ALPHA", "SIGY", "ETAN")] for k in range(1, 9)]
        n = next((k for k in range(1, 8) if columns[k][0] <= columns[k - 1][0]), 8)
        columns = columns[:n]
        self.start_of_tables = columns[0][0]
        for index, entry in ((1, "Young's modulus"), (2, "Poisson's ratio"), (3, "Thermal expansion")):
            if n > 1 and any(row[index] for row in columns):
                self.moduli[entry] = ", ".join(f"{number(row[0])}: {number(row[index])}" for row in columns)
            elif index == 3 and columns[0][3]:
                self.moduli[entry] = number(columns[0][3])
        if not any(row[4] for row in columns):
            return
        for _, modulus, _, _, stress, tangent in columns:
            self.refuse_zero("yield stress (SIGY)", stress)
            self.check_tangent(tangent, modulus)
        self.flow = {"Flow stress": "tabular", "tabular": {
            "Plastic strains": f"0, {FAR}", **({"Temperatures": ", ".join(number(row[0]) for row in columns)} if n > 1 else {}),
            "Flow stresses": "; ".join(f"{number(s)}, {number(s + FAR * e * t / (e - t))}" for _, e, _, _, s, t in columns)}}

    def read_rigid(self):
        """Without stress; motion is that of the part."""

    def read_viscoplastic_thermal(self):
        record = self.record
        points = self.curve_of_flow(record.integer("LCSS")) if record.integer("LCSS") else None
        stress = record.number("SIGY")
        if not points and record.number("QR1"):
            # Voce's saturation, as a table.
            terms = [(record.number(f"QR{k}"), record.number(f"CR{k}")) for k in (1, 2)]
            strains = (0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1)
            points = [(e, stress + sum(q * (1 - exp(-c * e)) for q, c in terms)) for e in strains]
        self.flow = self.flow_of(points) if points and len(points) > 1 else self.hardening(stress, 0)
        for field, entry in (("LCE", "Young's modulus"), ("LCPR", "Poisson's ratio"), ("LCALPH", "Thermal expansion")):
            points = self.points_over_temperature(field)
            if field == "LCALPH" and record.peek(field) < 0:
                points = expansion_increments(points, record.number("TREF"), self.line.fail)
            if points:
                self.moduli[entry] = over_temperature(points)
        if record.number("ALPHA") and "Thermal expansion" not in self.moduli:
            self.moduli["Thermal expansion"] = number(record.number("ALPHA"))
        points = self.points_over_temperature("LCSIGY")
        if points:
            self.scale_by_temperature(points)
        self.read_rates("C", "P")
        record.number("TREF")

    def points_over_temperature(self, field):
        """Of the curve that a field names; of LCALPH a number below zero names one as well."""
        curve = abs(self.record.integer(field)) if field == "LCALPH" else self.record.integer(field)
        if not curve:
            return []
        if curve not in self.curves:
            self.line.fail(f"{field} of material {self.number}: {curve} is no *DEFINE_CURVE of this file.")
        return self.curves[curve].points

    def scale_by_temperature(self, points):
        """Yield stresses over the temperature scale the table, unless it is over the temperature itself."""
        rows = self.flow.get("tabular") or {"Plastic strains": "0", "Flow stresses": number(points[0][1])}
        if "Temperatures" in rows:
            self.remarks.append("LCSIGY is left out: LCSS is a table over the temperature.")
            return
        stresses = [float(text) for text in rows["Flow stresses"].split(";")[0].split(",")]
        self.flow = {"Flow stress": "tabular", "tabular": {
            "Plastic strains": rows["Plastic strains"], "Temperatures": ", ".join(number(x) for x, _ in points),
            "Flow stresses": "; ".join(", ".join(number(s - stresses[0] + y) for s in stresses) for _, y in points)}}

    def read_johnson_cook(self):
        record = self.record
        shear, self.modulus = record.number("G"), record.number("E")
        self.poisson = record.number("PR")
        if self.modulus == 0:
            self.modulus = 2 * shear * (1 + self.poisson)
            self.remarks.append("E is 2 G (1 + PR); where PR is blank, set Poisson's ratio.")
        self.flow = {"Flow stress": "johnson cook",
                     "#heat": "LS-DYNA turns all plastic work into heat.",
                     "Taylor-Quinney coefficient": 1,
                     "Specific heat capacity": number(record.number("CP")),
                     "Initial temperature": number(record.number("TR")),
                     "johnson cook": self.constants_of_cook()}
        if not self.softens():
            self.remarks.append("TM is not above TR: there is no thermal softening.")
        if record.number("CP") == 0:
            self.remarks.append("CP = 0: plastic work does not heat.")
            for entry in ("#heat", "Taylor-Quinney coefficient", "Specific heat capacity"):
                del self.flow[entry]
        self.read_damage()

    def softens(self):
        """Whether a Johnson-Cook material does with the temperature."""
        return self.record.number("TM") > self.record.number("TR")

    def constants_of_cook(self):
        record = self.record
        cook = {name: number(record.number(field)) for name, field in (
            ("Yield stress", "A"), ("Hardening coefficient", "B"), ("Hardening exponent", "N"), ("Rate coefficient", "C"),
            ("Thermal exponent", "M"), ("Melting temperature", "TM"), ("Reference temperature", "TR"), ("Reference rate", "EPSO"))}
        if not self.softens():
            cook.update(WITHOUT_SOFTENING)
        if record.number("EPSO") == 0 and (record.number("C") == 0 or self.kind == "MAT_098"):
            cook["Reference rate"] = 1
        return cook

    def read_simplified_cook(self):
        self.flow = {"Flow stress": "johnson cook", "Initial temperature": 0, "johnson cook": self.constants_of_cook()}
        self.read_failure_strain("PSFAIL")

    def read_damage(self):
        """D1 to D5 and EFMIN."""
        record = self.record
        values = [record.number(f"D{k}") for k in range(1, 6)]
        smallest = record.number("EFMIN") or 1e-6
        if not any(values):
            return
        if values[0] + values[1] <= 0:
            self.remarks.append("D1 to D5: D1 + D2 is not positive, damage is left out.")
            return
        self.has_damage = True
        if values[2] > 0:
            self.remarks.append("D3 is above zero: it is taken as -D3, by which tension makes less ductile.")
        values[2] = -abs(values[2])
        self.flow["Damage"] = "johnson cook damage"
        self.flow["johnson cook damage"] = {
            **{f"D{k + 1}": number(value) for k, value in enumerate(values)},
            "Reference rate": number(record.number("EPSO")), "Melting temperature": number(record.number("TM")),
            "Reference temperature": number(record.number("TR")), "Smallest failure strain": number(smallest)}

    def give_equation(self, record):
        """The equation of state that a part names with this material."""
        if self.kind == "MAT_001":
            self.remarks.append(f"The equation of state on {record.line.place} is left out: the model is elastic.")
            return
        if self.back_stress:
            self.remarks.append(f"The equation of state on {record.line.place} is left out: kinematic hardening has none.")
            return
        if record.name != "EOS_GRUNEISEN" and form_of(record.name) == "EOS_LINEAR_POLYNOMIAL":
            self.give_polynomial(record)
            return
        names = (("Sound speed", "C"), ("Hugoniot slope", "S1"), ("Second Hugoniot coefficient", "S2"),
                 ("Third Hugoniot coefficient", "S3"), ("Gruneisen coefficient", "GAMAO"),
                 ("Gruneisen correction", "A"))
        self.equation = {"#eos": f"*{record.section.keyword} on {record.section.line.place}",
                         "Equation of state": "mie gruneisen",
                         "mie gruneisen": {name: number(record.number(field)) for name, field in names}}
        if record.number("E0") or record.number("V0") not in (0, 1):
            self.remarks.append("E0, V0: the initial state of the equation of state is left out.")

    def give_polynomial(self, record):
        """A linear one is that of the bulk modulus; others have no counterpart."""
        self.is_linear = True
        bulk = self.modulus / (3 * (1 - 2 * self.poisson))
        if abs(record.number("C1") - bulk) > 0.02 * bulk:
            self.remarks.append(f"*{record.section.keyword} on {record.section.line.place}: C1 = {record.number('C1'):g} is "
                                f"not taken, the bulk modulus is {bulk:g} by E and PR.")

    def entries(self):
        """Comments, and the entries of the section."""
        model = "elastic" if self.kind in ("MAT_001", "MAT_020") or not self.flow else \
            "chaboche" if self.back_stress else "j2 plasticity"
        title = f": {self.record.title}" if self.record.title else ""
        if self.kind == "MAT_015" and not self.equation and not self.is_linear:
            self.remarks.append("There is no *EOS_GRUNEISEN of its parts: pressure is linear elastic.")
        if not self.heat:
            self.moduli = at_one_temperature(self.moduli, self.start_of_tables, self.remarks)
        section = self.record.section
        comments = [f"*{section.keyword} on {section.line.place}{title}", *self.remarks]
        flow = dict(self.flow)
        if self.back_stress:
            flow["Back stress moduli"] = number(self.back_stress)
        if self.heat:
            flow.pop("Specific heat capacity", None)
            flow.pop("Initial temperature", None)
        constants = {"Density": number(self.density), "Young's modulus": number(self.modulus),
                     "Poisson's ratio": number(self.poisson), **self.moduli}
        if "Temperatures" in flow.get("tabular", {}) and not self.heat:
            flow["Initial temperature"] = number(self.start_of_tables)
        entries = {"Model": model, model: {**constants, **flow, **self.equation}}
        if self.heat:
            entries["Heat"] = self.heat
        return comments, entries
