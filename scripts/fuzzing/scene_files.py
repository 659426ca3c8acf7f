# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes a scene (scenes.py) as a parameter file."""

import math

from . import scenes

SPEED_OF_LIGHTEST = 4.2  # of longitudinal waves at Poisson's ratio 0.49, over sqrt(E/rho)


class Writer:
    """The text of one scene. Sizes are those of scenes.py until `number` writes them."""

    def __init__(self, scene, perturbation=None, fixed_step=None):
        self.scene = scene
        self.fixed_step = fixed_step
        self.perturbation = perturbation
        self.dim = scene["dimension"]
        self.axes = "xyz"[:self.dim]
        self.lines = []
        self.depth = 0
        self.files = {}
        self.lower, self.upper = self.extent()

    # Text.

    def number(self, value, length=0, mass=0, time=0, temperature=0):
        """A number in the units of the scene, whose temperatures are in one unit always."""
        unit = self.scene["units"]
        return "%.15g" % (value * 10. ** (length * unit[0] + mass * unit[1] + time * unit[2]))

    def length(self, value):
        return self.number(value, 1)

    def speed(self, value):
        """That of the process: slower where the process needs longer."""
        return self.number(value / self.time_factor(), 1, 0, -1)

    def time_factor(self):
        return 1. if self.scene["scaling"] is None else self.scene["scaling"]["time"]

    def pressure(self, value):
        return self.number(value, -1, 1, -2)

    def time(self, value):
        return self.number(value, 0, 0, 1)

    def temperature(self, value):
        return self.number(value, temperature=1)

    def set(self, name, value):
        self.lines.append("%sset %s = %s" % ("  " * self.depth, name, value))

    def begin(self, name):
        self.lines.append("%ssubsection %s" % ("  " * self.depth, name))
        self.depth += 1

    def end(self):
        self.depth -= 1
        self.lines.append("%send" % ("  " * self.depth))

    def section(self, name, entries):
        if entries:
            self.begin(name)
            for entry, value in entries.items():
                self.set(entry, value)
            self.end()

    # Geometry.

    def sizes(self):
        return [n * h for n, h in zip(self.scene["cells"], self.scene["spacing"])][:self.dim]

    def radius(self):
        return 0.5 * (self.core_cells() + 2 * self.rings()) * self.scene["spacing"][0]

    def core_cells(self):
        return 2 if self.scene["symmetry"] else min(self.scene["cells"][0], 2)

    def rings(self):
        return min(self.scene["cells"][1], 2)

    def extent(self):
        """The corners of the smallest box around the body."""
        mesh = self.scene["mesh"]
        if mesh == "box":
            sizes = self.sizes()
            lower = [self.scene["offset"] * max(sizes)] * self.dim
            upper = [x + size for x, size in zip(lower, sizes)]
            if self.scene["rotation"] == 0.:
                return lower, upper
            angle = math.radians(self.scene["rotation"])
            corners = [(math.cos(angle) * x - math.sin(angle) * y, math.sin(angle) * x + math.cos(angle) * y)
                       for x in (lower[0], upper[0]) for y in (lower[1], upper[1])]
            return ([min(corner[i] for corner in corners) for i in range(2)] + lower[2:],
                    [max(corner[i] for corner in corners) for i in range(2)] + upper[2:])
        if mesh == "spherical shell":
            return [0.] * 3, [self.outer_radius()] * 3
        radius = self.radius()
        lower = [0. if axis in self.scene["symmetry"] else -radius for axis in "xy"]
        return lower + [0.] * (self.dim - 2), [radius] * 2 + ([self.sizes()[2]] if self.dim == 3 else [])

    def outer_radius(self):
        return 4. * self.scene["spacing"][0] + self.scene["cells"][2] * self.scene["spacing"][2]

    def extents(self):
        return [upper - lower for lower, upper in zip(self.lower, self.upper)]

    def smallest_spacing(self):
        scene = self.scene
        return min(scene["spacing"][:self.dim]) * (1. - scene["disorder"]) * (
            0.5 if scene["mesh"] != "box" else 1.) * (0.5 if scene["refined"] is not None else 1.)

    def duration(self):
        """That needs about as many steps as the scene has."""
        scene = self.scene
        poisson = scene["poisson"]
        speed = math.sqrt((1. - poisson) / ((1. + poisson) * (1. - 2. * poisson)))
        if scene["second material"] is not None:
            stiffness, density = scene["second material"]
            speed *= max(1., math.sqrt(stiffness / density))
        step = 0.6 * scene["safety factor"] * self.smallest_spacing() / speed / scene["degree"] ** 2
        if scene["scaling"] is not None:
            step *= self.time_factor() * math.sqrt(scene["scaling"]["mass"])
        return scene["steps"] * step

    # Sections.

    def text(self):
        scene = self.scene
        thermal = scene["heat"] is not None
        conditions = ["symmetry %s" % axis for axis in scene["symmetry"]] + \
                     ["%s %d" % (condition["type"], i) for i, condition in enumerate(scene["conditions"])]
        self.set("Title", "Scene %d" % scene["seed"])
        self.set("Dimension", self.dim)
        parts = self.parts()
        self.set("Parts", ", ".join(parts))
        self.set("Materials", "first" if scene["second material"] is None else "first, second")
        if conditions:
            self.set("Conditions", ", ".join(conditions))
        if scene["contacts"]:
            self.set("Contacts", ", ".join("tool %d" % i for i in range(len(scene["contacts"]))))
        start = self.start()
        if start:
            self.set("Initial conditions", "start")
        self.set("End time", self.time(self.duration()))
        self.set("Output directory", "output")
        self.mesh()
        for name, (cells, formulation, material) in parts.items():
            self.part(name, cells, formulation, material)
        self.material("first", scene["model"], [1., 1.])
        if scene["second material"] is not None:
            self.material("second", scene["second model"], scene["second material"])
        for i, contact in enumerate(scene["contacts"]):
            self.contact("tool %d" % i, contact)
        for axis in scene["symmetry"]:
            self.section("Condition: symmetry %s" % axis, {
                "Type": "symmetry", "Boundary": axis + " min" if scene["mesh"] == "box" else "symmetry " + axis})
        for name, condition in zip(conditions[len(scene["symmetry"]):], scene["conditions"]):
            self.condition(name, condition)
        self.section("Initial condition: start", start)
        self.section("Coupling", {"Bridge": scene["bridge"]})
        if thermal:
            self.heat()
        if scene["filter"]:
            self.set("Plugin libraries", "liblattice_filter.so")
            self.section("Lattice filter", scene["filter"])
        if scene["scaling"] is not None:
            self.scaling()
        if self.fixed_step is not None:
            self.begin("Time step")
            self.set("Fixed", "%.17g" % self.fixed_step)
        else:
            self.begin("Time step")
            self.set("Safety factor", scene["safety factor"])
            self.set("Check interval", scene["check interval"])
        self.section("Subcycling", {"Largest ratio": scene["largest ratio"]} if scene["largest ratio"] > 1 else {})
        self.end()
        self.output()
        self.section("Checkpoint", {"Step interval": scene["checkpoint"], "Keep": 1000})
        return "\n".join(self.lines) + "\n"

    def output(self):
        scene = self.scene
        self.begin("Output")
        self.set("Number", scene["outputs"])
        self.set("Write solution", str(scene["pictures"]).lower())
        self.section("visualization", {"Precision": "double"} if scene["pictures"] else {})
        if scene["probe"]:
            self.section("probes", {"Locations": "corner: " + ", ".join(map(self.length, self.upper))})
        self.end()

    def mesh(self):
        scene = self.scene
        self.begin("Mesh")
        self.set("Type", scene["mesh"])
        if scene["refined"] is not None:
            axis = scene["refined"]["axis"]
            self.set("Refine where", "%s < %s" % ("xyz"[axis], self.coordinate(axis, scene["refined"]["share"])))
        self.begin(scene["mesh"])
        cells = scene["cells"]
        if scene["mesh"] == "box":
            sizes = self.sizes()
            lower = scene["offset"] * max(sizes)
            self.set("Lower corner", ", ".join(self.length(lower) for _ in sizes))
            self.set("Upper corner", ", ".join(self.length(lower + size) for size in sizes))
            self.set("Cells", ", ".join(map(str, cells[:self.dim])))
            if scene["disorder"] > 0.:
                self.set("Disorder", scene["disorder"])
                self.set("Surface nodes", scene["surface"])
                self.set("Seed", scene["seed"])
            if scene["rotation"] != 0.:
                self.set("Rotation", scene["rotation"])
        elif scene["mesh"] == "spherical shell":
            self.set("Inner radius", self.length(4. * scene["spacing"][0]))
            self.set("Outer radius", self.length(self.outer_radius()))
            self.set("Cells along edge", 2 if cells[0] < 4 else 4)
            self.set("Cells through thickness", min(cells[2], 4))
        else:
            self.set("Radius", self.length(self.radius()))
            self.set("Core cells", self.core_cells())
            self.set("Rings", self.rings())
            if self.dim == 3:
                is_disc = scene["mesh"] == "disc"
                self.set("Thickness" if is_disc else "Length", self.length(self.sizes()[2]))
                self.set("Cells through thickness" if is_disc else "Cells along axis", cells[2])
            if scene["symmetry"]:
                self.set("Symmetry planes", ", ".join(scene["symmetry"]))
        self.end()
        self.adaptive()
        self.end()

    def adaptive(self):
        adaptive = self.scene["adaptive"]
        if adaptive is None:
            return

        def value(size):
            return size if adaptive["criterion"] == "plastic strain" else self.number(size, -2, 1, -2)
        self.begin("Adaptive refinement")
        self.set("Criterion", adaptive["criterion"])
        self.set("Refine above", value(adaptive["above"]))
        if adaptive["below"] is not None:
            self.set("Coarsen below", value(adaptive["below"] * adaptive["above"]))
        self.set("Levels", adaptive["levels"])
        self.set("Layers", adaptive["layers"])
        self.set("Steps between checks", adaptive["interval"])
        self.end()

    def coordinate(self, axis, share):
        """The coordinate of an axis at a share of the extent, off the nodes of regular meshes."""
        return self.length(self.lower[axis] + (share + 1e-4) * (self.upper[axis] - self.lower[axis]))

    def parts(self):
        """Cells, formulation and material of each part."""
        scene = self.scene
        first, second = scene["formulations"]
        other = "first" if scene["second material"] is None else "second"
        parts = {
            "one": lambda: {"a": ["all", first, "first"]},
            "halves": lambda: {"a": ["x < " + self.coordinate(0, 0.5), first, "first"], "b": ["otherwise", second, other]},
            "core": lambda: {"a": ["x < %s && y < %s" % (self.coordinate(0, 0.55), self.coordinate(1, 0.7)), first, "first"],
                             "b": ["otherwise", second, other]},
            "layer": lambda: {"a": ["x > %s && x < %s" % (self.coordinate(0, 0.33), self.coordinate(0, 0.67)), first, "first"],
                              "b": ["otherwise", second, other]}}[scene["layout"]]()
        if scene["conversion"] is not None:
            for name, (_, formulation, material) in list(parts.items()):
                if formulation != scenes.PARTICLES:
                    parts["from " + name] = ["from " + name, scenes.PARTICLES, material]
                    break
        return parts

    def part(self, name, cells, formulation, material):
        scene = self.scene
        self.begin("Part: " + name)
        self.set("Cells", cells)
        name_in_file = scenes.name_of(scene, formulation)
        self.set("Formulation", name_in_file)
        self.set("Material", material)
        self.begin(name_in_file)
        if scene["bulk viscosity"] is not None:
            self.set("Linear bulk viscosity", scene["bulk viscosity"][0])
            self.set("Quadratic bulk viscosity", scene["bulk viscosity"][1])
        if name_in_file == scenes.SMOOTHED_PARTICLES:
            self.smoothed_particles(material)
        elif name_in_file == scenes.SMOOTHED_CELLS:
            self.set("Dilation", scene["convex dilation"])
            if scene["refill"] is not None:
                self.set("Refill stretch", scene["refill"]["stretch"])
                self.set("Refill surface", scene["refill"]["surface"])
                self.set("Steps between refill checks", scene["refill"]["interval"])
        elif formulation == scenes.PARTICLES:
            self.particles(material)
        else:
            if formulation == "lagrange hexahedron":
                self.set("Degree", scene["degree"])
            if scene["erosion"] is not None and self.flows(material):
                self.set("Erosion strain", scene["erosion"])
        if formulation != scenes.PARTICLES:
            self.conversion(name, material)
        self.end()
        self.end()

    def conversion(self, name, material):
        conversion = self.scene["conversion"]
        if conversion is None or "from " + name not in self.parts():
            return
        by = conversion["by"] if self.flows(material) or conversion["by"] != "strain" else "time step"
        self.set("Conversion " + by, {
            "strain": conversion["strain"], "scaled Jacobian": 0.97,
            "time step": self.time(0.9 * self.smallest_spacing())}[by])
        self.set("Conversion layers", conversion["layers"])
        self.set("Steps between conversions", conversion["interval"])

    def flows(self, material):
        return self.scene["model" if material == "first" else "second model"] in scenes.PLASTIC

    def particles(self, material):
        scene = self.scene
        self.set("Kernel", scene["kernel"])
        self.set("Dilation", scene["dilation"])
        self.set("Smoothing", scene["smoothing"])
        self.set("Configuration", scene["configuration"])
        if scene["configuration"] == "updated Lagrangian":
            self.set(*scene["rebuild"])
        self.set("Shape functions", scene["shape functions"])
        if scene["rounded rows"] and scene["configuration"] != "current":
            self.set("Row precision", "single")
        if scenes.can_share_dilatation(scene):
            uses_cells = scene["dilatation of cells"] and not scene["filter"]
            self.set("Dilatation", "of cells" if uses_cells else "of particles")
        self.bonds(material)

    def smoothed_particles(self, material):
        scene = self.scene
        self.set("Kernel", scene["radial kernel"])
        self.set("Smoothing length", scene["smoothing length"])
        self.set("Gradient", scene["radial gradient"])
        self.set("Configuration", scene["configuration"])
        if scene["configuration"] == "updated Lagrangian":
            self.set(*scene["rebuild"])
        for name in scene["pair terms"]:
            self.set(name, "true")
        self.bonds(material)

    def bonds(self, material):
        scene = self.scene
        bonds = scene["bonds"]
        if bonds is not None:
            criterion = bonds["criterion"]
            if criterion == "effective plastic strain" and not self.flows(material):
                criterion = "shear strain"
            self.set("Bond failure", criterion)
            self.set("Steps between bond checks", bonds["interval"])
            limit = self.pressure(bonds["limit"]) if criterion == "principal stress" else bonds["limit"]
            self.section(criterion, {"Limit": limit, "Stretch": bonds["stretch"], "Combination": bonds["combination"]})
            if scene["self-contact"]:
                self.set("Self-contact", "true")

    def material(self, name, model, factors):
        scene = self.scene
        stiffness, density = factors
        self.begin("Material: " + name)
        self.set("Model", model)
        self.begin(model)
        self.set("Density", self.number(density, -3, 1))
        self.set("Young's modulus", "0: %s, %s: %s" % (
            self.pressure(stiffness), self.temperature(2000), self.pressure(0.5 * stiffness))
                 if scene["softening modulus"] and scene["heat"] is not None else self.pressure(stiffness))
        self.set("Poisson's ratio", scene["poisson"])
        if scene["heat"] is not None:
            self.set("Thermal expansion", self.number(scene["expansion"], temperature=-1))
        if model in scenes.PLASTIC:
            self.flow_stress(stiffness, keeps_temperature=model == "j2 plasticity")
        if model == "chaboche":
            moduli, rates = zip(*scene["back stress"])
            self.set("Back stress moduli", ", ".join(self.pressure(c * scene["yield"] * stiffness) for c in moduli))
            self.set("Recovery rates", ", ".join(map(str, rates)))
        self.end()
        if scene["heat"] is not None:
            heat = scene["heat"]
            conductivity = self.number(heat["diffusivity"] * heat["capacity"] * density, 1, 1, -3, -1)
            capacity = self.number(heat["capacity"], 2, 0, -2, -1)
            if heat["table"]:
                capacity = "0: %s, %s: %s" % (capacity, self.temperature(1000),
                                              self.number(1.5 * heat["capacity"], 2, 0, -2, -1))
            self.section("Heat", {"Specific heat capacity": capacity, "Conductivity": conductivity,
                                  "Initial temperature": self.temperature(300)})
        self.end()

    def flow_stress(self, stiffness, keeps_temperature):
        scene = self.scene
        flow, yields = scene["flow stress"], scene["yield"] * stiffness
        heats = scene["taylor quinney"] > 0. and keeps_temperature
        if flow == "johnson cook" and scene["heat"] is None and not keeps_temperature:
            flow = "linear hardening"
        self.set("Flow stress", flow)
        if scene["taylor quinney"] > 0.:
            self.set("Taylor-Quinney coefficient", scene["taylor quinney"])
        if scene["heat"] is None and heats:
            self.set("Specific heat capacity", self.number(1e-4, 2, 0, -2, -1))
        if scene["heat"] is None and (heats or flow == "johnson cook"):
            self.set("Initial temperature", self.temperature(300))
        hardening = scene["hardening"] * yields
        if flow == "linear hardening":
            self.section(flow, {"Yield stress": self.pressure(yields), "Hardening modulus": self.pressure(hardening)})
        elif flow == "tabular":
            rows = [[yields, yields + 0.1 * hardening, yields + 0.5 * hardening]]
            entries = {"Plastic strains": "0, 0.1, 1"}
            if scene["heat"] is not None or heats:
                rows.append([0.2 * value for value in rows[0]])
                entries["Temperatures"] = ", ".join(map(self.temperature, (300, 900)))
            entries["Flow stresses"] = "; ".join(", ".join(map(self.pressure, row)) for row in rows)
            self.section(flow, entries)
        else:
            self.section(flow, {"Yield stress": self.pressure(yields),
                                "Hardening coefficient": self.pressure(hardening), "Hardening exponent": 0.3, "Rate coefficient": 0.02,
                                "Reference rate": self.number(1e-4, 0, 0, -1), "Thermal exponent": 1,
                                "Melting temperature": self.temperature(1000),
                                "Reference temperature": self.temperature(298)})

    def heat(self):
        heat = self.scene["heat"]
        self.begin("Heat")
        if any(condition["type"] == "radiation" for condition in self.scene["conditions"]):
            self.set("Absolute zero", 0)
        self.set("Time integration", heat["integration"])
        if heat["integration"] == "explicit":
            self.section("explicit", {"Safety factor": 0.9})
        else:
            step = self.time(heat["step"] * self.duration() / self.scene["steps"])
            self.section(heat["integration"], {"Step": step, "Tolerance": "1e-13"})  # ranks agree to about it
        self.end()

    def scaling(self):
        scaling = self.scene["scaling"]
        entries = {}
        if scaling["mass"] != 1:
            entries["Mass factor"] = scaling["mass"]
        if scaling["time"] != 1:
            entries["Process time factor"] = scaling["time"]
        if scaling["target"] is not None:
            entries["Target time step"] = self.time(
                scaling["target"] * self.duration() / self.scene["steps"] / (0.2 * self.scene["safety factor"]))
            entries["Interval"] = scaling["interval"]
        self.section("Scaling", entries)

    def contact(self, name, contact):
        up = self.dim - 1
        extent = self.extents()
        surface = contact["surface"]
        is_floor = surface == "floor"
        middle = [0.5 * (lower + upper) for lower, upper in zip(self.lower, self.upper)]
        gap = contact["gap"] + (1e-6 if surface not in ("floor", "plate") else 0.)
        height = self.lower[up] - gap if is_floor else self.upper[up] + gap
        point = middle[:up] + [height]
        width = 0.3 * max(extent)
        self.begin("Contact: " + name)
        kind = {"floor": "plane", "plate": "plane", "faces": "polyline" if self.dim == 2 else "triangles"}.get(
            surface, surface)
        self.set("Surface", kind)
        self.set("Stiffness", contact["stiffness"])
        self.set("Damping", contact["damping"])
        if contact["friction"] > 0.:
            self.set("Friction", contact["friction"])
        if self.scene["heat"] is not None and contact["conductance"] > 0.:
            capacity = self.scene["heat"]["capacity"]
            self.set("Conductance", self.number(contact["conductance"] * capacity, 0, 1, -3, -1))
            self.set("Tool temperature", self.temperature(500))
        self.begin(kind)
        if kind == "plane":
            self.set("Point", ", ".join(map(self.length, point)))
            self.set("Normal", ", ".join(["0"] * up + ["1" if is_floor else "-1"]))
        else:
            if surface == "sphere":
                point[up] += width
                self.set("Radius", self.length(width))
            elif surface == "drill":
                self.section_of_drill(width)
            elif surface == "pin and shoulder":
                for entry, value in {"Pin diameter": 0.5, "Pin length": 0.5, "Shoulder diameter": 1.,
                                     "Shoulder length": 0.5}.items():
                    self.set(entry, self.length(value * width))
            elif surface == "profile":
                self.set("Corners", "; ".join("%s, %s" % (self.length(width * r), self.length(width * z))
                                              for r, z in ((0, 0), (0.5, 0), (1, 0.5), (1, 1), (0, 1))))
            else:
                self.set("File", self.tool_file(name.replace(" ", "_"), width))
            if contact["edge"] > 0. and surface != "sphere":
                self.set("Edge radius", self.length(contact["edge"] * 0.2 * width))
            self.set("Origin", ", ".join(map(self.length, point)))
            if kind != "polyline":
                self.set("Axis", ", ".join(["0"] * up + ["1"]))
        direction = 1. if is_floor else -1.
        if contact["move"] == "mass":
            self.set("Mass", self.number(contact["mass"], self.dim - 3, 1))
            self.set("Initial velocity", ", ".join(["0"] * up + [self.speed(direction * contact["speed"])]))
        elif contact["move"] != "rest":
            self.set("Displacement", "; ".join(["0"] * up + [self.speed(direction * contact["speed"]) + "*t"]))
            if contact["move"] == "turn" and kind != "plane":
                self.set("Angle", self.number(contact["speed"] / self.time_factor(), 0, 0, -1) + "*t")
        self.end()
        self.end()

    def section_of_drill(self, width):
        self.set("Diameter", self.length(width))
        self.set("Cone angle", 60)
        self.set("Length", self.length(2. * width))

    def tool_file(self, name, width):
        """A pyramid, or a triangle, on its tip."""
        w = self.length
        if self.dim == 2:
            self.files[name + ".csv"] = "0, 0\n%s, %s\n-%s, %s\n" % ((w(width),) * 4)
            return name + ".csv"
        corners = [(0, 0, 0), (1, 1, 1), (-1, 1, 1), (-1, -1, 1), (1, -1, 1)]
        faces = ["2 3 4 5", "1 3 2", "1 4 3", "1 5 4", "1 2 5"]
        self.files[name + ".obj"] = "".join("v %s\n" % " ".join(w(width * x) for x in corner) for corner in corners) + \
                                    "".join("f %s\n" % face for face in faces)
        return name + ".obj"

    def condition(self, name, condition):
        """At an end of the body; sources and forces on the mass everywhere."""
        scene = self.scene
        kind, size = condition["type"], condition["size"]
        axis = condition["axis"] % self.dim
        extent = self.upper[axis] - self.lower[axis]
        self.begin("Condition: " + name)
        self.set("Type", kind)
        if kind not in ("body force", "heat source", "gravity"):
            if scene["mesh"] == "box":
                self.set("Boundary", "%s %s" % (self.axes[axis], condition["end"]))
            else:
                bound = self.lower[axis] + (0.2 if condition["end"] == "min" else 0.8) * extent
                self.set("Where", "%s %s %s" % (self.axes[axis], "<" if condition["end"] == "min" else ">",
                                                self.length(bound)))
        duration = self.time(self.duration())
        in_time = {"1": "1", "t": "t/%s" % duration, "sin": "sin(6.28*t/%s)" % duration}[condition["in time"]]
        components = ["0"] * self.dim
        direction = condition["direction"] % self.dim

        def vector(value, rest="0"):
            return "; ".join("%s*%s" % (value, in_time) if i == direction else rest for i in range(len(components)))
        rest = "free" if condition["free"] else "0"
        if kind == "traction":
            self.set("Function", vector(self.pressure(size)))
            if condition["free"]:
                self.set("Area", "initial")
        elif kind == "body force":
            self.set("Function", vector(self.number(size, 1, 0, -2)))
        elif kind == "velocity":
            self.set("Function", vector(self.speed(size), rest))
        elif kind == "displacement":
            in_time = in_time if condition["in time"] != "1" else "0"
            self.set("Function", vector(self.length(10. * size), rest))
        elif kind == "temperature":
            self.set("Function", "%s + %s*%s" % (self.temperature(300), self.temperature(200), in_time))
        elif kind in ("heat flux", "heat source"):
            capacity = scene["heat"]["capacity"]
            length = 0 if kind == "heat flux" else -1
            self.set("Function", "%s*%s" % (self.number(100. * size * capacity, length, 1, -3), in_time))
        elif kind == "convection":
            self.set("Film coefficient", self.number(size * scene["heat"]["capacity"], 0, 1, -3, -1))
            self.set("Ambient temperature", self.temperature(400))
        elif kind == "radiation":
            self.set("Emissivity", "0.9")
            self.set("Ambient temperature", self.temperature(500))
            self.set("Stefan-Boltzmann constant", self.number(
                1e-8 * size * scene["heat"]["capacity"], 0, 1, -3, -4))
        self.end()

    def start(self):
        """The entries of the initial condition."""
        scene = self.scene
        entries = {}
        where = ["((%s-(%s))/%s)" % (axis, self.length(lower), self.length(upper - lower))
                 for axis, lower, upper in zip(self.axes, self.lower, self.upper)]
        up = self.dim - 1
        velocity = ["0"] * self.dim
        if scene["motion"] is not None:
            v = self.speed(scene["motion"]["speed"])
            velocity = {
                "flight": lambda: ["0"] * up + ["-" + v],
                "stretch": lambda: ["%s*%s" % (v, where[0])] + ["0"] * up,
                "spin": lambda: ["-%s*(%s-0.5)" % (v, where[1]), "%s*(%s-0.5)" % (v, where[0])] + ["0"] * (up - 1),
                "wave": lambda: ["%s*sin(6.28*%s)" % (v, where[0])] * self.dim,
                "apart": lambda: ["%s*tanh(8*(%s-0.5))" % (v, where[0])] + ["0"] * up}[scene["motion"]["kind"]]()
        temperature = "%s + %s*%s" % (self.temperature(300), self.temperature(200), where[0]) if scene["temperature"] else None
        if self.perturbation is not None:
            size, phase = self.perturbation
            noise = "*".join("sin(%g*%s+%g)" % (17.3 + 5 * i + phase, coordinate, phase)
                             for i, coordinate in enumerate(where))
            speed = size * max(1e-6, scene["motion"]["speed"] if scene["motion"] is not None else 0.)
            velocity = ["%s + %s*%s" % (component, self.speed(speed), noise) for component in velocity]
            if scene["heat"] is not None:
                temperature = "%s + %s*%s" % (temperature or self.temperature(300), self.temperature(300. * size), noise)
        if any(component != "0" for component in velocity):
            entries["Velocity"] = "; ".join(velocity)
        if scene["stress"] is not None:
            xx, xy = self.pressure(scene["stress"]), self.pressure(-0.5 * scene["stress"])
            entries["Stress"] = "; ".join([xx] + ["0"] * 4 + [xy])
        if temperature is not None:
            entries["Temperature"] = temperature
        return entries


def files_of(scene, perturbation=None, fixed_step=None):
    """The files of a scene by name, of which case.prm is the main one. A perturbation, its share and
    its phase, is added to velocities and temperatures at the start; a fixed step is in the units of the file."""
    writer = Writer(scene, perturbation, fixed_step)
    text = writer.text()
    return {"case.prm": text.encode(), **{name: content.encode() for name, content in writer.files.items()}}
