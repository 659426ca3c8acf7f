# SPDX-License-Identifier: LGPL-2.1-or-later
"""The contents of the file of a reflection study."""

import itertools
import math
from dataclasses import dataclass, field, replace

from tombolo.described_file import MANDATORY, DescribedFile, ListOf
from .case import ReflectionCase

PAIRS = ("FE-FE", "FE-particles", "particles-FE", "particles-particles", "particles-same particles")
ENTRIES = {
    "Title": ("", None, "A title for tables and pictures."),
    "Output directory": (
        "output/reflection_study", None,
        "Where the study leaves its results; made if it does not exist."),
    "Groups": (
        MANDATORY, None,
        "Names of the groups of cases, each with a section `Group: NAME`. The cases of a group are "
        "the product of its lists."),
    "Plugin libraries": (
        "", None, "Shared objects with further elements, loaded before all else is read."),
}
GROUP_ENTRIES = {
    "Title": ("", None, "What the group shows."),
    "Pairs": (
        MANDATORY, ListOf(PAIRS),
        "What the wave comes from and what it meets. Particles and particles are two parts that "
        "share nodes; `same particles` are of the same part, and all see each other."),
    "Elements": (
        "fully integrated hexahedron", ListOf(),
        "Formulations of the sides called FE, of degree 1."),
    "Spacing ratios": (
        "1", ListOf(),
        "Spacing of the right side over that of the left, numbers or fractions such as 1/3."),
    "Spacing along the interface": (
        "1", (float, 0.1, 10), "Of both sides, over the coarser one across the interface."),
    "Dilations": ("1.8", ListOf(), "Support half width of the particles over their spacing."),
    "Kernel": ("", None, "The particles' kernel; empty is their default."),
    "Smoothings": ("paper", ListOf(), "The particles' smoothing, as in a part's section."),
    "Bridges": ("paper", ListOf(("paper", "trace")), "How elements and particles share nodes."),
    "Filter powers": ("0", ListOf(), "p of the lattice filter; 0 is no filter."),
    "Filter strengths": ("0.5", ListOf(), "beta of the lattice filter."),
    "Filter interval": ("3", (int, 1, 1000), "The filter is applied every so many steps."),
    "Poisson's ratios": ("0", ListOf(), "Of the material on both sides."),
    "Waves": ("P", ListOf(("P", "S")), "Types of the incident wave."),
    "Angles": (
        "0", ListOf(), "Between the direction of the wave and the normal. Units: degrees."),
    "Wavelengths": ("20", ListOf(), "Of the incident wave, over the coarser spacing."),
    "Cycles": (
        "8", (float, 8, 100), "Wavelengths in the Hann burst, counted along the normal."),
    "Step factor": (
        "0.9", (float, 0.01, 1), "The time step is this fraction of the stable one."),
    "Reference": (
        "", None,
        "Reflections to print beside those computed, in the order of the cases: the lists from the "
        "first in this section, Pairs, to the last, Wavelengths, which changes fastest; `-` where "
        "there is none. Units: %."),
}


@dataclass
class Row:
    """A case with its row in the table."""
    case: ReflectionCase
    ratio: str  # as it was given
    degrees: float
    reference: float = math.nan  # the value of a publication, in %
    result: object = None
    seconds: float = 0


@dataclass
class Group:
    name: str
    title: str
    rows: list = field(default_factory=list)


class ReflectionSettings(DescribedFile):
    """Reads all groups. Throws InputError."""
    entries, kind, names, entries_of_each = ENTRIES, "Group", "Groups", GROUP_ENTRIES

    def __init__(self, file):
        super().__init__(file)
        self.title, self.output = self.get("Title"), self.get("Output directory")
        self.groups = [self.read_group(name) for name in self.list_of("Groups")]
        if not self.groups:
            self.fail("Groups", "a study needs at least one group of cases")

    def n_cases(self):
        return sum(len(group.rows) for group in self.groups)

    def numbers_within(self, entry, low, high):
        values = [self.number(entry, text) for text in self.list_of(entry)]
        for text, value in zip(self.list_of(entry), values):
            if not low <= value <= high:
                self.fail(entry, f"{text} is outside of what is allowed, {low:g} to {high:g}")
        return values

    def ratios(self, entry):
        """As they were given, "1/3" or "0.5", each with its value."""
        ratios = []
        for text in self.list_of(entry):
            numerator, slash, denominator = text.partition("/")
            divisor = self.number(entry, denominator) if slash else 1
            value = self.number(entry, numerator) / divisor if divisor else math.inf
            if not 0.1 <= value <= 10:
                self.fail(entry, f"{text} is outside of what is allowed, 1/10 to 10")
            ratios.append((text, value))
        return ratios

    def read_group(self, name):
        within = f"Group: {name}/"

        def get(entry):
            return self.get(within + entry)

        def names(entry):
            return self.list_of(within + entry)

        def numbers(entry, low, high):
            return self.numbers_within(within + entry, low, high)

        common = ReflectionCase(
            kernel=get("Kernel"), row_spacing=float(get("Spacing along the interface")),
            cycles=float(get("Cycles")), step_factor=float(get("Step factor")),
            filter_interval=int(get("Filter interval")),
            plugin_libraries=self.get("Plugin libraries"))
        powers = numbers("Filter powers", 0, 16)
        if any(power != math.floor(power) for power in powers):
            self.fail(within + "Filter powers", "a power is a whole number")

        group = Group(name, get("Title"))
        for (pair, element, (ratio, spacing_ratio), dilation, smoothing, bridge, power, strength,
             poissons_ratio, wave, angle, wavelength) in itertools.product(
                 names("Pairs"), names("Elements"), self.ratios(within + "Spacing ratios"),
                 numbers("Dilations", 1, 4), names("Smoothings"), names("Bridges"), powers,
                 numbers("Filter strengths", 0, 10), numbers("Poisson's ratios", -0.9, 0.499),
                 names("Waves"), numbers("Angles", 0, 80), numbers("Wavelengths", 4, 1000)):
            left, _, right = pair.partition("-")
            group.rows.append(Row(replace(
                common, left=left, right=right.removeprefix("same "),
                is_one_part=right.startswith("same "), element=element,
                spacing_ratio=spacing_ratio, dilation=dilation, smoothing=smoothing,
                bridge=bridge, filter_power=int(power), filter_strength=strength,
                poissons_ratio=poissons_ratio, wave=wave, angle=math.radians(angle),
                wavelength=wavelength), ratio, angle))

        references = names("Reference")
        if references and len(references) != len(group.rows):
            self.fail(within + "Reference", f"there are {len(references)} values for the "
                      f"{len(group.rows)} cases of the group")
        for row, text in zip(group.rows, references):
            if text != "-":
                row.reference = self.number(within + "Reference", text)
        return group
