# SPDX-License-Identifier: LGPL-2.1-or-later
"""*MATERIAL and the keywords below it as sections of materials."""

from ..scene import (WITHOUT_SOFTENING, at_one_temperature, expansion_increments, interpolated, linear_hardening, number,
                     over_temperature, plastic_curve, tabular_over)
from .deck import key
from .hardening import KinematicHardening

# Of the time of a step in which heat crosses a body, where steps are steady.
STEADY_SHARE = 1e-4


def at_temperatures(pairs):
    """One number, or pairs of temperature and value; each is a value and a temperature."""
    if len(pairs) == 1:
        return number(pairs[0][0])
    return ", ".join(f"{number(temperature)}: {number(value)}" for value, temperature in sorted(
        pairs, key=lambda pair: pair[1]))


class Material:
    """Entries of a material: constants, those of the flow stress, and those of heat."""

    def __init__(self, section, name):
        self.line, self.name = section.line, name
        self.density, self.constants, self.flow, self.damage, self.equation = None, {}, {}, {}, {}
        self.heat, self.eta, self.remarks = {}, None, []
        self.rate = self.power_law = None
        self.curves_by_rate = {}  # of *PLASTIC
        self.kinematic = None
        self.temperature_dependent = False
        self.readers = {"DENSITY": self.read_density, "ELASTIC": self.read_elastic, "PLASTIC": self.read_plastic,
                        "CYCLIC HARDENING": self.read_cyclic,
                        "RATE DEPENDENT": self.read_rate, "EXPANSION": self.read_expansion,
                        "CONDUCTIVITY": self.read_conductivity, "SPECIFIC HEAT": self.read_specific_heat,
                        "INELASTIC HEAT FRACTION": self.read_heat_fraction, "DAMAGE INITIATION": self.read_damage,
                        "EOS": self.read_equation}

    def refuse_zero(self, section, what, value):
        if value <= 0:
            section.line.fail(f'the {what} of material "{self.name}" is {value:g}. Allowed is a number larger than zero.')

    def value_with_temperature(self, section, n_values=1):
        """Rows of values and a temperature."""
        section.get("DEPENDENCIES")
        rows = section.rows()
        if not rows:
            section.line.fail(f"*{section.name} has no data.")
        result = [([row.number(k) for k in range(n_values)], row.number(n_values)) for row in rows]
        self.temperature_dependent = self.temperature_dependent or len(result) > 1
        return result

    def read_density(self, section):
        rows = self.value_with_temperature(section)
        self.density = rows[0][0][0]
        self.refuse_zero(section, "density", self.density)
        if len(rows) > 1:
            self.remarks.append("The density is that of the first temperature.")

    def read_elastic(self, section):
        kind = key(section.get("TYPE", "ISOTROPIC")) or "ISOTROPIC"
        if not kind.startswith("ISO"):
            section.line.fail(f"*ELASTIC with TYPE={kind} is not possible: elasticity is isotropic here.")
        rows = self.value_with_temperature(section, 2)
        self.refuse_zero(section, "Young's modulus", min(values[0] for values, _ in rows))
        self.constants["Young's modulus"] = at_temperatures([(values[0], t) for values, t in rows])
        self.constants["Poisson's ratio"] = at_temperatures([(values[1], t) for values, t in rows])

    def read_plastic(self, section):
        hardening = key(section.get("HARDENING", "ISOTROPIC"))
        rows = section.rows()
        if hardening.replace("-", " ") == "JOHNSON COOK":
            names = ("Yield stress", "Hardening coefficient", "Hardening exponent", "Thermal exponent",
                     "Melting temperature", "Reference temperature")
            cook = {name: number(rows[0].number(k)) for k, name in enumerate(names)} if rows else {}
            if rows and not rows[0].number(4) > rows[0].number(5):
                self.remarks.append(f"*PLASTIC ({section.line.place}): without a melting temperature there is no thermal "
                                    "softening.")
                cook.update(WITHOUT_SOFTENING)
            self.flow = {"Flow stress": "johnson cook", "johnson cook": cook}
            self.temperature_dependent = True
            return
        if hardening not in ("ISOTROPIC", "KINEMATIC", "COMBINED"):
            section.line.fail(f"*PLASTIC with HARDENING={hardening} is not possible here.")
        if hardening != "ISOTROPIC":
            self.kinematic = KinematicHardening.of_plastic(section, self.remarks)
            if self.kinematic:
                return
        curves = {}
        for row in rows:
            curves.setdefault(row.number(2), []).append((row.number(1), row.number(0)))
        if not curves:
            section.line.fail("*PLASTIC has no data.")
        curves = {t: plastic_curve(points, section.line.fail) for t, points in sorted(curves.items())}
        self.curves_by_rate[section.number("RATE", 0.0)] = curves
        if len(self.curves_by_rate) > 1:
            self.take_curves_by_rate()
            return
        if len(curves) == 1:
            points = list(curves.values())[0]
            if len(points) == 1:
                self.flow = linear_hardening(points[0][1], 0)
                return
        strains = sorted({strain for points in curves.values() for strain, _ in points})
        strains = strains if len(strains) > 1 else [0.0, 1.0]
        table = {"Plastic strains": ", ".join(map(number, strains))}
        if len(curves) > 1:
            self.temperature_dependent = True
            table["Temperatures"] = ", ".join(map(number, curves))
        table["Flow stresses"] = "; ".join(", ".join(number(interpolated(points, strain)) for strain in strains)
                                           for points in curves.values())
        self.flow = {"Flow stress": "tabular", "tabular": table}

    def take_curves_by_rate(self):
        """Each *PLASTIC has a curve of one strain rate."""
        rows = sorted(self.curves_by_rate.items())
        if any(len(curves) > 1 for _, curves in rows):
            self.line.fail(f'the material "{self.name}" has *PLASTIC over the strain rate (RATE) and over the temperature. '
                           "Allowed is one of them.")
        self.flow = tabular_over("Strain rates", [(rate, next(iter(curves.values()))) for rate, curves in rows])

    def read_cyclic(self, section):
        if self.kinematic:
            self.kinematic.read_cyclic(section)
            return
        self.remarks.append(f"*CYCLIC HARDENING ({section.line.place}) is for HARDENING=COMBINED with "
                            "DATA TYPE=PARAMETERS, and is left out.")
        section.is_read = False

    def read_rate(self, section):
        kind = key(section.get("TYPE"))
        row = section.rows()[0] if section.rows() else None
        if kind.replace("-", " ") == "JOHNSON COOK" and row is not None:
            self.rate = row.number(0), row.number(1)
        elif kind in ("", "POWER LAW") and row is not None and row.number(0) > 0 and row.number(1) >= 1:
            self.power_law = {"Cowper-Symonds rate": number(row.number(0)), "Cowper-Symonds exponent": number(row.number(1))}
        else:
            self.remarks.append(f"*RATE DEPENDENT ({section.line.place}): there is no such dependence on the strain rate "
                                "here, and it is left out.")
            for row in section.rows():
                row.numbers()

    def read_expansion(self, section):
        kind = key(section.get("TYPE", "ISO"))
        if not kind.startswith("ISO"):
            section.line.fail(f"*EXPANSION with TYPE={kind} is not possible: expansion is isotropic here.")
        points = sorted((t, values[0]) for values, t in self.value_with_temperature(section))
        points = expansion_increments(points, section.number("ZERO", 0.0), section.line.fail)
        self.constants["Thermal expansion"] = number(points[0][1]) if len(points) == 1 else over_temperature(points)

    def read_conductivity(self, section):
        kind = key(section.get("TYPE", "ISO"))
        if not kind.startswith("ISO"):
            section.line.fail(f"*CONDUCTIVITY with TYPE={kind} is not possible: conductivity is isotropic here.")
        self.heat["Conductivity"] = at_temperatures([(values[0], t) for values, t in self.value_with_temperature(section)])

    def read_specific_heat(self, section):
        self.heat["Specific heat capacity"] = at_temperatures(
            [(values[0], t) for values, t in self.value_with_temperature(section)])

    def read_heat_fraction(self, section):
        rows = section.rows()
        self.eta = rows[0].number(0, 0.9) if rows else 0.9

    def read_damage(self, section):
        """Abaqus has exp(-d3 triaxiality)."""
        if key(section.get("CRITERION")).replace("-", " ") != "JOHNSON COOK" or not section.rows():
            self.remarks.append(f"*DAMAGE INITIATION ({section.line.place}): only CRITERION=JOHNSON COOK is possible; it is "
                                "left out.")
            section.is_read = False
            return
        d1, d2, d3, d4, d5, melting, transition, rate = (section.rows()[0].number(k) for k in range(8))
        self.damage = {"Damage": "johnson cook damage", "johnson cook damage": {
            "D1": number(d1), "D2": number(d2), "D3": number(-d3), "D4": number(d4), "D5": number(d5),
            "Reference rate": number(rate or 1), "Melting temperature": number(melting),
            "Reference temperature": number(transition)}}

    def read_equation(self, section):
        if key(section.get("TYPE")).replace("-", "") != "USUP" or not section.rows():
            self.remarks.append(f"*EOS ({section.line.place}): only TYPE=USUP is possible; it is left out.")
            section.is_read = False
            return
        row = section.rows()[0]
        self.equation = {"Equation of state": "mie gruneisen", "mie gruneisen": {
            "Sound speed": number(row.number(0)), "Hugoniot slope": number(row.number(1)),
            "Gruneisen coefficient": number(row.number(2))}}

    def take_steady_heat(self, time, extent):
        """A capacity for which a body of this extent comes to rest within each step of heat."""
        conductivity = float(self.heat.get("Conductivity", "1").split(",")[0].split(":")[-1])
        self.density = self.density or 1.0
        capacity = STEADY_SHARE * conductivity * time / extent**2 / self.density
        self.heat["Specific heat capacity"] = number(float(f"{capacity:.3g}"))
        self.remarks.append("Steps of heat are steady: a small heat capacity lets each of them end at rest.")

    def conduct_alone(self):
        """Without what is of mechanics."""
        if self.constants or self.flow:
            self.remarks.append("All steps are *HEAT TRANSFER: what the material has for mechanics is not used.")
        self.constants, self.flow, self.kinematic = {}, {}, None

    def complete(self, has_heat, is_adiabatic, initial_temperature, is_at_rest):
        """Comments, and the entries of the section."""
        if self.density is None and is_at_rest:
            self.density = 1.0
            self.remarks.append("There is no *DENSITY; a body at rest does not feel it.")
        if self.density is None:
            self.line.fail(f'the material "{self.name}" has no *DENSITY (--mesh makes the mesh alone).')
        if "Young's modulus" not in self.constants and not (has_heat and not self.flow):
            self.line.fail(f'the material "{self.name}" has no *ELASTIC (--mesh makes the mesh alone).')
        density = {"Density": number(self.density)}
        if self.kinematic:
            self.resolve_hardening(has_heat, initial_temperature)
        if not has_heat:
            self.constants = at_one_temperature(self.constants, initial_temperature, self.remarks)
        if "Young's modulus" not in self.constants:
            model, entries = "heat conductor", density
        elif self.kinematic:
            model, entries = "chaboche", {**density, **self.constants, **self.flow, **self.heating(has_heat, is_adiabatic)}
        elif self.flow:
            model, entries = "j2 plasticity", {**density, **self.constants, **self.completed_flow(
                has_heat, is_adiabatic, initial_temperature)}
        else:
            model, entries = "elastic", {**density, **self.constants}
        result = {"Model": model, model: entries}
        if has_heat:
            result["Heat"] = {"Specific heat capacity": self.heat.get("Specific heat capacity", "1"),
                              "Conductivity": self.heat.get("Conductivity", "0"),
                              "Initial temperature": number(initial_temperature)}
            missing = [name for name in ("Specific heat capacity", "Conductivity") if name not in self.heat]
            if missing[:1] == ["Specific heat capacity"]:
                self.line.fail(f'the material "{self.name}" has no *SPECIFIC HEAT, which a step with heat needs.')
        elif self.heat:
            self.remarks.append("No step has heat: " + " and ".join(name.lower() for name in sorted(self.heat)) + (
                " are" if len(self.heat) > 1 else " is") + " not used." if not is_adiabatic else
                "The step is adiabatic: the conductivity, if there is one, is not used.")
        return [f"*MATERIAL on {self.line.place}", *self.remarks], result

    def resolve_hardening(self, has_heat, temperature):
        """Kinematic hardening as the flow stress of its model, or of that of isotropic hardening."""
        kinematic = self.kinematic
        if not kinematic.is_kinematic():
            self.kinematic, self.flow = None, kinematic.flow(has_heat, temperature)
        elif self.damage or self.equation:
            lacks = "*DAMAGE INITIATION" if self.damage else "*EOS"
            self.remarks.append(f"{lacks} goes with isotropic hardening alone: hardening is isotropic here.")
            self.kinematic, self.flow = None, kinematic.isotropic(temperature)
        else:
            self.flow = kinematic.entries(has_heat, temperature)
        if self.kinematic and (self.rate or self.power_law):
            self.remarks.append("*RATE DEPENDENT is left out: kinematic hardening has none.")

    def heating(self, has_heat, is_adiabatic):
        """How much of the plastic work heats."""
        if self.eta is not None and not has_heat:
            self.remarks.append("Plastic work does not heat: " + (
                "ADIABATIC is for isotropic hardening alone." if is_adiabatic else "no step has heat or is ADIABATIC."))
        return {"Taylor-Quinney coefficient": number(self.eta)} if self.eta is not None and has_heat else {}

    def completed_flow(self, has_heat, is_adiabatic, initial_temperature):
        flow = {**self.flow, **self.damage, **self.equation}
        if "johnson cook" in flow:
            rate, reference = self.rate or (0, 1)
            flow["johnson cook"] = {**flow["johnson cook"], "Rate coefficient": number(rate),
                                    "Reference rate": number(reference)}
        elif self.rate:
            self.remarks.append("*RATE DEPENDENT without HARDENING=JOHNSON COOK is left out.")
        if self.power_law and "Strain rates" not in flow.get(flow["Flow stress"], {}) and "johnson cook" not in flow:
            flow[flow["Flow stress"]] = {**flow[flow["Flow stress"]], **self.power_law}
        elif self.power_law:
            self.remarks.append("*RATE DEPENDENT, TYPE=POWER LAW is left out: the flow stress depends on the strain rate already.")
        heats = self.eta is not None and (has_heat or is_adiabatic)
        if self.eta is not None and not heats:
            self.remarks.append("Plastic work does not heat: no step has heat or is ADIABATIC.")
        if heats:
            flow["Taylor-Quinney coefficient"] = number(self.eta)
        if not has_heat and (heats or self.temperature_dependent or self.damage):
            flow["Initial temperature"] = number(initial_temperature)
            if heats:
                flow["Specific heat capacity"] = self.heat.get("Specific heat capacity", "1").split(":")[-1].strip()
        return flow


def read_materials(deck):
    """Materials by their keys."""
    materials, current = {}, None
    for section in deck.sections:
        if section.name == "MATERIAL":
            section.is_read = True
            name = section.name_in("NAME")
            if key(name) in materials:
                section.line.fail(f'There are two of *MATERIAL called "{name}".')
            current = materials[key(name)] = Material(section, name)
        elif current and section.name in current.readers:
            section.is_read = True
            current.readers[section.name](section)
        elif section.name in ("STEP", "SOLID SECTION", "PART", "BOUNDARY"):
            current = None
    return materials
