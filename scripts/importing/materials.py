# SPDX-License-Identifier: LGPL-2.1-or-later
"""Materials of LS-DYNA as sections of a parameter file."""

from .deck import KeywordError

NAMES = {"MAT_001": "ELASTIC", "MAT_003": "PLASTIC_KINEMATIC", "MAT_015": "JOHNSON_COOK",
         "MAT_024": "PIECEWISE_LINEAR_PLASTICITY"}

# Densities of solids differ by less: foams and heavy metals.
LARGEST_RATIO_OF_DENSITIES = 1000
NO_FAILURE = 1e10  # a strain


def kind_of(name):
    """The number of a model, "MAT_001", of one of its two names; None for other keywords."""
    for number, word in NAMES.items():
        if name in (number, "MAT_" + word):
            return number
    return None


def plastic_curve(points, place):
    """Flow stresses over plastic strains from zero on; constant before the first point, as in LS-DYNA."""
    before = [point for point in points if point[0] < 0]
    points = [point for point in points if point[0] >= 0]
    if before and points and points[0][0] > 0:
        (e, s), (next_e, next_s) = before[-1], points[0]
        points.insert(0, (0, s - e * (next_s - s) / (next_e - e)))
    elif points and points[0][0] > 0:
        points.insert(0, (0, points[0][1]))
    if not points or min(stress for _, stress in points) <= 0:
        raise KeywordError(f"{place}: a curve of hardening needs flow stresses larger than zero over plastic strains "
                           "from zero on.")
    return points


class Material:
    """A material: the lines of its section, and remarks about what is left out."""

    def __init__(self, record, curves):
        self.record = record
        self.line = record.section.line
        self.number = record.integer("MID")
        self.density = record.number("RO")
        self.title = record.title
        self.kind = kind_of(record.name)
        self.failure_strain = None
        self.has_damage = False
        self.equation = []     # lines of the equation of state
        self.remarks = []
        self.flow = []
        if self.kind == "MAT_015":
            self.read_johnson_cook(record)
        else:
            self.modulus = record.number("E")
            self.poisson = record.number("PR")
        for name, value in (("density", self.density), ("Young's modulus", self.modulus)):
            self.refuse_zero(name, value)
        if self.kind == "MAT_003":
            self.read_plastic_kinematic(record)
        elif self.kind == "MAT_024":
            self.read_piecewise_linear(record, curves)

    def refuse_zero(self, name, value):
        if value <= 0:
            raise KeywordError(f"{self.line.place}: the {name} of material {self.number} is {value:g}. "
                               "Allowed is a number larger than zero.")

    def hardening(self, yield_stress, tangent):
        """Linear hardening of a tangent modulus of the uniaxial curve."""
        self.refuse_zero("yield stress (SIGY)", yield_stress)
        slope = self.modulus * tangent / (self.modulus - tangent) if tangent < self.modulus else 0
        return ["set Flow stress = linear hardening", "subsection linear hardening",
                f"  set Yield stress      = {yield_stress:.10g}",
                f"  set Hardening modulus = {slope:.10g}", "end"]

    def read_plastic_kinematic(self, record):
        self.flow = self.hardening(record.number("SIGY"), record.number("ETAN"))
        if record.number("BETA") < 1:
            self.remarks.append("BETA < 1, kinematic hardening: hardening is isotropic here.")
        if record.number("SRC") > 0:
            record.number("SRP")
            self.remarks.append("SRC, SRP: the rate dependence of Cowper and Symonds is left out.")
        self.read_failure_strain("FS")

    def read_failure_strain(self, name):
        """Programs write a large number for none."""
        if 0 < self.record.number(name) < NO_FAILURE:
            self.failure_strain = self.record.number(name)

    def read_piecewise_linear(self, record, curves):
        number = record.integer("LCSS")
        points = [(record.number(f"EPS{k}"), record.number(f"ES{k}")) for k in range(1, 9)] if not number else []
        points = [point for point in points if point[1] != 0]
        if number in curves:
            points = curves[number].points
        elif number:
            self.remarks.append(f"LCSS = {number} is no *DEFINE_CURVE of this file: SIGY and ETAN are taken.")
        if points:
            first = points[0][0]
            place = curves[number].line.place if number else self.line.place
            points = plastic_curve(points, place)
            if first > 0:
                self.remarks.append(f"The curve of hardening begins at the strain {first:g}: it is constant before.")
        if len(points) > 1:
            self.flow = ["set Flow stress = tabular", "subsection tabular",
                         "  set Plastic strains = " + ", ".join(f"{e:.10g}" for e, _ in points),
                         "  set Flow stresses   = " + ", ".join(f"{s:.10g}" for _, s in points), "end"]
        elif points:
            self.flow = self.hardening(points[0][1], 0)
        else:
            if number and record.number("SIGY") <= 0:
                raise KeywordError(f"{self.line.place}: LCSS = {number} of material {self.number} is no *DEFINE_CURVE "
                                   "of this file, and there is no SIGY.")
            self.flow = self.hardening(record.number("SIGY"), record.number("ETAN"))
        if record.number("C") > 0 or record.integer("LCSR"):
            record.number("P")
            self.remarks.append("C, P, LCSR: the dependence on the strain rate is left out.")
        self.read_failure_strain("FAIL")

    def read_johnson_cook(self, record):
        shear, self.modulus = record.number("G"), record.number("E")
        self.poisson = record.number("PR")
        if self.modulus == 0:
            self.modulus = 2 * shear * (1 + self.poisson)
            self.remarks.append("E is 2 G (1 + PR); where PR is blank, set Poisson's ratio.")
        self.flow = ["set Flow stress                = johnson cook",
                     "# LS-DYNA turns all plastic work into heat.",
                     "set Taylor-Quinney coefficient = 1",
                     f"set Specific heat capacity     = {record.number('CP'):.10g}",
                     f"set Initial temperature        = {record.number('TR'):.10g}",
                     "subsection johnson cook"]
        names = (("Yield stress", "A"), ("Hardening coefficient", "B"), ("Hardening exponent", "N"),
                 ("Rate coefficient", "C"), ("Thermal exponent", "M"), ("Melting temperature", "TM"),
                 ("Reference temperature", "TR"), ("Reference rate", "EPSO"))
        self.flow += [f"  set {name:21} = {record.number(field):.10g}" for name, field in names]
        self.flow.append("end")
        self.read_damage(record)

    def read_damage(self, record):
        """D1 to D5 and EFMIN."""
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
        self.flow += ["set Damage = johnson cook damage", "subsection johnson cook damage"]
        self.flow += [f"  set D{k + 1} = {value:.10g}" for k, value in enumerate(values)]
        self.flow += [f"  set Reference rate          = {record.number('EPSO'):.10g}",
                      f"  set Melting temperature     = {record.number('TM'):.10g}",
                      f"  set Reference temperature   = {record.number('TR'):.10g}",
                      f"  set Smallest failure strain = {smallest:.10g}", "end"]

    def give_equation(self, record):
        """*EOS_GRUNEISEN."""
        names = (("Sound speed", "C"), ("Hugoniot slope", "S1"), ("Second Hugoniot coefficient", "S2"),
                 ("Third Hugoniot coefficient", "S3"), ("Gruneisen coefficient", "GAMAO"),
                 ("Gruneisen correction", "A"))
        values = [(name, record.number(field)) for name, field in names]
        if self.kind == "MAT_001":
            self.remarks.append(f"The equation of state on {record.line.place} is left out: the model is elastic.")
            return
        self.equation = [f"# *{record.section.keyword} on {record.section.line.place}",
                         "set Equation of state = mie gruneisen", "subsection mie gruneisen"]
        self.equation += [f"  set {name:27} = {value:.10g}" for name, value in values]
        self.equation.append("end")
        if record.number("E0") or record.number("V0") not in (0, 1):
            self.remarks.append("E0, V0: the initial state of the equation of state is left out.")

    def lines(self, name):
        model = "elastic" if self.kind == "MAT_001" else "j2 plasticity"
        head = "" if not self.title else f": {self.title}"
        if self.kind == "MAT_015" and not self.equation:
            self.remarks.append("There is no *EOS_GRUNEISEN of its parts: pressure is linear elastic.")
        section = self.record.section
        yield f"# *{section.keyword} on {section.line.place}{head}"
        for remark in self.remarks:
            yield "# " + remark
        yield f"subsection Material: {name}"
        yield f"  set Model = {model}"
        yield f"  subsection {model}"
        yield f"    set Density         = {self.density:.10g}"
        yield f"    set Young's modulus = {self.modulus:.10g}"
        yield f"    set Poisson's ratio = {self.poisson:.10g}"
        for line in self.flow + self.equation:
            yield "    " + line
        yield "  end"
        yield "end"


def refuse_mixed_units(materials):
    """Densities and moduli of solids in one system of units are of the same magnitude."""
    ordered = sorted(materials, key=lambda material: material.density)
    if len(ordered) > 1 and ordered[-1].density > LARGEST_RATIO_OF_DENSITIES * ordered[0].density:
        low, high = ordered[0], ordered[-1]
        raise KeywordError(
            f"{high.line.place}: the density of material {high.number} is {high.density:g}, and that of "
            f"material {low.number} ({low.line.place}) is {low.density:g}: these are not in the same units. "
            f"Allowed is a factor of up to {LARGEST_RATIO_OF_DENSITIES}; write all materials in the units "
            "of the mesh.")


def unit_labels(materials):
    """The likely units by the density of metals, as a comment; None where it tells nothing."""
    systems = (("mass: kg, length: m, time: s", 1), ("mass: t, length: mm, time: s", 1e-12),
               ("mass: kg, length: mm, time: ms", 1e-9), ("mass: g, length: mm, time: ms", 1e-6),
               ("mass: g, length: cm, time: us", 1e-3))
    for labels, factor in systems:
        if materials and all(500 <= material.density / factor <= 23000 for material in materials):
            return labels
    return None
