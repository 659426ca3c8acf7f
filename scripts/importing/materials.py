# SPDX-License-Identifier: LGPL-2.1-or-later
"""Materials of LS-DYNA as sections of a parameter file."""

from .deck import KeywordError

NAMES = {"MAT_001": "ELASTIC", "MAT_003": "PLASTIC_KINEMATIC", "MAT_015": "JOHNSON_COOK",
         "MAT_024": "PIECEWISE_LINEAR_PLASTICITY"}

# Densities of solids differ by less: foams and heavy metals.
LARGEST_RATIO_OF_DENSITIES = 1000


def kind_of(name):
    """The number of a model, "MAT_001", of one of its two names; None for other keywords."""
    for number, word in NAMES.items():
        if name in (number, "MAT_" + word):
            return number
    return None


class Material:
    """A material: the lines of its section, and remarks about what is left out."""

    def __init__(self, section, curves):
        title, section = section.title_and_rest()
        self.line = section.line
        self.number = section.integer(0, 0)
        self.density = section.number(0, 1)
        self.title = title
        self.kind = kind_of(section.name)
        self.failure_strain = None
        self.has_damage = False
        self.equation = []     # lines of the equation of state
        self.remarks = []
        self.flow = []
        self.section = section
        if self.kind == "MAT_015":
            self.read_johnson_cook(section)
        else:
            self.modulus = section.number(0, 2)
            self.poisson = section.number(0, 3)
            if self.kind == "MAT_003":
                self.read_plastic_kinematic(section)
            elif self.kind == "MAT_024":
                self.read_piecewise_linear(section, curves)
        for name, value in (("density", self.density), ("Young's modulus", self.modulus)):
            if value <= 0:
                raise KeywordError(f"line {self.line}: the {name} of material {self.number} is {value:g}. "
                                   "Allowed is a number larger than zero.")

    def hardening(self, yield_stress, tangent):
        """Linear hardening of a tangent modulus of the uniaxial curve."""
        slope = self.modulus * tangent / (self.modulus - tangent) if tangent < self.modulus else 0
        return ["set Flow stress = linear hardening", "subsection linear hardening",
                f"  set Yield stress      = {yield_stress:.10g}",
                f"  set Hardening modulus = {slope:.10g}", "end"]

    def read_plastic_kinematic(self, section):
        self.flow = self.hardening(section.number(0, 4), section.number(0, 5))
        if section.number(0, 6) < 1:
            self.remarks.append("BETA < 1, kinematic hardening: hardening is isotropic here.")
        if section.number(1, 0) > 0:
            self.remarks.append("SRC, SRP: the rate dependence of Cowper and Symonds is left out.")
        if section.number(1, 2) > 0:
            self.failure_strain = section.number(1, 2)

    def read_piecewise_linear(self, section, curves):
        curve = section.integer(1, 2)
        strains = [section.number(2, k) for k in range(8)]
        stresses = [section.number(3, k) for k in range(8)]
        points = [(e, s) for e, s in zip(strains, stresses) if s > 0]
        if curve in curves:
            points = [(e, s) for e, s in curves[curve] if e >= 0]
        elif curve:
            self.remarks.append(f"LCSS = {curve} is no *DEFINE_CURVE of this file: SIGY and ETAN are taken.")
            points = []
        if points and points[0][0] == 0 and len(points) > 1:
            self.flow = ["set Flow stress = tabular", "subsection tabular",
                         "  set Plastic strains = " + ", ".join(f"{e:.10g}" for e, _ in points),
                         "  set Flow stresses   = " + ", ".join(f"{s:.10g}" for _, s in points), "end"]
        else:
            self.flow = self.hardening(section.number(0, 4), section.number(0, 5))
        if section.number(1, 0) > 0 or section.integer(1, 3):
            self.remarks.append("C, P, LCSR: the dependence on the strain rate is left out.")
        if section.number(0, 6) > 0:
            self.failure_strain = section.number(0, 6)

    def read_johnson_cook(self, section):
        shear, self.modulus = section.number(0, 2), section.number(0, 3)
        self.poisson = section.number(0, 4)
        if self.modulus == 0:
            self.modulus = 2 * shear * (1 + self.poisson)
            self.remarks.append("E is 2 G (1 + PR); where PR is blank, set Poisson's ratio.")
        self.flow = ["set Flow stress                = johnson cook",
                     "# LS-DYNA turns all plastic work into heat.",
                     "set Taylor-Quinney coefficient = 1",
                     f"set Specific heat capacity     = {section.number(2, 0):.10g}",
                     f"set Initial temperature        = {section.number(1, 6):.10g}",
                     "subsection johnson cook"]
        names = ("Yield stress", "Hardening coefficient", "Hardening exponent", "Rate coefficient",
                 "Thermal exponent", "Melting temperature", "Reference temperature", "Reference rate")
        self.flow += [f"  set {name:21} = {section.number(1, k):.10g}" for k, name in enumerate(names)]
        self.flow.append("end")
        self.read_damage(section)

    def read_damage(self, section):
        """D1 to D5 and EFMIN."""
        values = [section.number(2, 4 + k) for k in range(4)] + [section.number(3, 0)]
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
        self.flow += [f"  set Reference rate          = {section.number(1, 7):.10g}",
                      f"  set Melting temperature     = {section.number(1, 5):.10g}",
                      f"  set Reference temperature   = {section.number(1, 6):.10g}",
                      f"  set Smallest failure strain = {section.number(3, 3) or 1e-6:.10g}", "end"]

    def give_equation(self, section):
        """*EOS_GRUNEISEN: EOSID C S1 S2 S3 GAMAO A E0, V0."""
        if self.kind == "MAT_001":
            self.remarks.append(f"The equation of state on line {section.line} is left out: the model is elastic.")
            return
        names = ("Sound speed", "Hugoniot slope", "Second Hugoniot coefficient", "Third Hugoniot coefficient",
                 "Gruneisen coefficient", "Gruneisen correction")
        self.equation = [f"# *{section.name} on line {section.line}", "set Equation of state = mie gruneisen",
                         "subsection mie gruneisen"]
        self.equation += [f"  set {name:27} = {section.number(0, 1 + k):.10g}" for k, name in enumerate(names)]
        self.equation.append("end")
        if section.number(0, 7) or section.number(1, 0) not in (0, 1):
            self.remarks.append("E0, V0: the initial state of the equation of state is left out.")

    def lines(self, name):
        model = "elastic" if self.kind == "MAT_001" else "j2 plasticity"
        head = "" if not self.title else f": {self.title}"
        if self.kind == "MAT_015" and not self.equation:
            self.remarks.append("There is no *EOS_GRUNEISEN of its parts: pressure is linear elastic.")
        yield f"# *{self.section.name} on line {self.line}{head}"
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
            f"line {high.line}: the density of material {high.number} is {high.density:g}, and that of "
            f"material {low.number} (line {low.line}) is {low.density:g}: these are not in the same units. "
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
