# SPDX-License-Identifier: LGPL-2.1-or-later
"""One wave at one interface, and the strip of the lattice around it."""

import math
from dataclasses import dataclass

# No operator couples nodes farther apart than this many reaches of the shape functions: the
# stiffness between the interpolations of the trace bridge, S(I + γT) and its adjoint.
REACHES_PER_OPERATOR = 4
# Mass and shape functions of a node differ from those of the lattice this close to an edge.
REACHES_OF_EDGES = 2


@dataclass(frozen=True)
class ReflectionCase:
    """The coarser of the two spacings across the interface is 1; the density and the speed of P
    waves are 1."""
    left: str = "FE"  # where the wave comes from: FE or particles
    right: str = "FE"
    is_one_part: bool = False  # particles on both sides with common supports
    element: str = "fully integrated hexahedron"
    spacing_ratio: float = 1  # spacing of the right side over that of the left
    row_spacing: float = 1  # along the interface, of both sides
    dilation: float = 1.8
    kernel: str = ""  # empty: the default
    smoothing: str = "paper"
    bridge: str = "paper"
    shape_functions: str = "moving least squares"
    poissons_ratio: float = 0
    step_factor: float = 0.9  # of the stable step of the strip, by its spectrum
    # v̂ ← v̂ - δ (I - ΦS)^power v̂ every few steps with δ = strength c Δt interval / h
    # (doc/method.md, section 9)
    filter_power: int = 0  # 0: no filter
    filter_strength: float = 0
    filter_interval: int = 1
    wave: str = "P"  # or S
    wavelength: float = 20  # over the coarser spacing
    angle: float = 0  # between the wave's direction and the normal, in radians
    cycles: float = 8  # wavelengths in the Hann burst, counted along the normal
    plugin_libraries: str = ""

    @property
    def left_spacing(self):
        return 1 / self.spacing_ratio if self.spacing_ratio > 1 else 1

    @property
    def right_spacing(self):
        return 1 if self.spacing_ratio > 1 else self.spacing_ratio

    def wave_speed(self):
        """In the continuum."""
        nu = self.poissons_ratio
        return 1 if self.wave == "P" else math.sqrt((1 - 2 * nu) / (2 - 2 * nu))

    def neighbour_reach(self):
        """How many columns the shape functions reach."""
        if self.left == self.right == "FE":
            return 1
        # Within one part a coarse particle's support covers fine ones.
        ratio = max(self.spacing_ratio, 1 / self.spacing_ratio) if self.is_one_part else 1
        return max(1, math.ceil(self.dilation * ratio - 1e-9) - 1)


class Strip:
    """A lattice of columns with the interface at x = 0, high enough that the row in the middle reaches
    neither of the edges, and wide enough that the outermost probed columns reach neither the ends nor
    the interface. Both are checked on every probe. Operators are probed in columns -n_probed ...
    n_probed of the middle row. Strips of equal scenes are equal."""

    def __init__(self, case):
        self.case = case
        neighbours = case.neighbour_reach()
        margin = (REACHES_PER_OPERATOR + REACHES_OF_EDGES) * neighbours
        self.reach = REACHES_PER_OPERATOR * neighbours  # of one operator
        # The two outermost probed columns reach no interface; they are compared with each other.
        self.n_probed = margin + 2
        self.n_columns = 2 * margin + 4  # cells on each side
        self.n_rows = 2 * margin + 2  # cells
        self.middle = self.n_rows // 2  # row of nodes
        self.scene = self.scene_text()

    def __eq__(self, other):
        return self.scene == other.scene

    def __hash__(self):
        return hash(self.scene)

    def scene_text(self):
        """The parameter file of the strip."""
        case = self.case
        left, right, height = case.left_spacing, case.right_spacing, case.row_spacing

        def corner(side, column, row):
            spacing = left if side < 0 else right
            return f"{side * column * spacing:.17g}, {row * height:.17g}"

        text = f"""set Dimension = 2
set Materials = m
set Plugin libraries = {case.plugin_libraries}
set Parts = {"both sides" if case.is_one_part else "left side, right side"}
subsection Mesh
  set Type = box
  subsection box
    set Lower corner = {corner(-1, self.n_columns, 0)}
    set Upper corner = {corner(1, self.n_columns, self.n_rows)}
    set Cells = {self.n_columns} to 0 | {self.n_columns}; {self.n_rows}
  end
end
subsection Material: m
  set Model = elastic
  subsection elastic
    set Density = 1
    set Young's modulus = {self.youngs_modulus():.17g}
    set Poisson's ratio = {case.poissons_ratio:.17g}
  end
end
subsection Coupling
  set Bridge = {case.bridge}
end
subsection Probe
  set Lower corner = {corner(-1, self.n_probed + 0.5, self.middle - 0.5)}
  set Upper corner = {corner(1, self.n_probed + 0.5, self.middle + 0.5)}
end
"""
        if case.is_one_part:
            return text + self.part("both sides", case.left, "all")
        return (text + self.part("left side", case.left, "x < 0")
                + self.part("right side", case.right, "otherwise"))

    def youngs_modulus(self):
        """That with which density and speed of P waves are 1."""
        nu = self.case.poissons_ratio
        return (1 + nu) * (1 - 2 * nu) / (1 - nu)

    def part(self, name, kind, cells):
        case = self.case
        if kind == "FE":
            formulation, entries = case.element, []
            # A column has two unknowns.
            if case.element == "lagrange hexahedron":
                entries = ["Degree = 1"]
        else:
            formulation = "momentum consistent particle"
            entries = [f"Dilation = {case.dilation:.17g}", f"Smoothing = {case.smoothing}",
                       f"Shape functions = {case.shape_functions}"]
            entries += [f"Kernel = {case.kernel}"] * bool(case.kernel)
        lines = [f"subsection Part: {name}", f"  set Cells = {cells}", "  set Material = m",
                 f"  set Formulation = {formulation}"]
        if entries:
            lines += [f"  subsection {formulation}", *(f"    set {one}" for one in entries),
                      "  end"]
        return "\n".join([*lines, "end\n"])


def exact_reflection(frequency, time_step, wave_speed, left_spacing, right_spacing):
    """|R| of elements with lumped mass under central differences at normal incidence, at a
    frequency: Ω = (2/Δt) sin(ωΔt/2), Z = √(1 - (Ω h / 2c)²), R = (Z₁ - Z₂)/(Z₁ + Z₂) for equal
    material on both sides."""
    omega = 2 / time_step * math.sin(0.5 * frequency * time_step)
    left, right = (math.sqrt(1 - (0.5 * omega * spacing / wave_speed)**2)
                   for spacing in (left_spacing, right_spacing))
    return abs((left - right) / (left + right))
