# SPDX-License-Identifier: LGPL-2.1-or-later
"""Random scenes: small bodies of any formulation, material and process, from a number each.

A scene is a dictionary of features, drawn by `drawn(seed)` from the seed alone. `files_of` writes it as
a parameter file, with the files of its tools. `legal` puts right what the program refuses, so that
features can be drawn, and dropped, independently of each other; `simpler` lists those that are.

Lengths are in cells, densities and Young's moduli in those of the first material, so that waves go a
cell in a unit of time; files are written in the units of the scene.
"""

import math
import random

ELEMENTS = ["hexahedron", "fully integrated hexahedron", "lagrange hexahedron"]
PARTICLES = "momentum consistent particle"
# What may replace particles, and fully integrated elements.
SMOOTHED_PARTICLES, SMOOTHED_CELLS = "smoothed particle", "smoothed cells"
PLASTIC = ["j2 plasticity", "chaboche"]
BACK_STRESSES = [[[1., 0.]], [[10., 30.], [0.3, 0.]]]  # moduli over the yield stress, rates of recovery
PAIR_TERMS = ["Artificial viscosity", "Artificial stress", "XSPH"]
MOST_CELLS = 160


def power(generator, low, high):
    """A number between powers of ten, with three digits."""
    return float("%.3g" % 10. ** generator.uniform(low, high))


def maybe(generator, chance):
    return generator.random() < chance


def unused(generator, n):
    """Draws one of n and drops it: a feature that scenes had and have no more, so that all else of them stays."""
    generator.randrange(n)


def drawn(seed):
    """The scene of a seed."""
    generator = random.Random(seed)
    choice = generator.choice
    scene = {"seed": seed, "dimension": choice([2, 2, 3]), "back stress": BACK_STRESSES[seed % 2]}
    scene.update(drawn_mesh(generator, scene["dimension"]))
    scene.update(drawn_body(generator))
    scene.update(drawn_particles(generator))
    scene.update(drawn_failure(generator))
    scene["bulk viscosity"] = choice([None, None, [0.06, 1.5], [0.5, 0.]])
    unused(generator, 3)
    scene["degree"] = choice([1, 1, 2, 3])
    scene["bridge"] = choice(["paper", "trace"])
    scene["filter"] = {"Power": choice([2, 4, 6]), "Strength": choice([0.1, 0.5]),
                       "Interval": choice([1, 3])} if maybe(generator, 0.1) else None
    scene["scaling"] = drawn_scaling(generator) if maybe(generator, 0.15) else None
    scene["heat"] = drawn_heat(generator) if maybe(generator, 0.3) else None
    scene["contacts"] = [drawn_contact(generator) for _ in range(choice([0, 0, 1, 1, 2]))]
    scene["conditions"] = [drawn_condition(generator) for _ in range(choice([0, 0, 1, 1, 2, 3]))]
    scene["symmetry"] = sorted(generator.sample("xyz", choice([1, 1, 2]))) if maybe(generator, 0.2) else []
    scene["motion"] = {"kind": choice(["flight", "flight", "stretch", "spin", "wave", "apart"]),
                       "speed": power(generator, -4, -0.8)} if maybe(generator, 0.85) else None
    scene["stress"] = power(generator, -5, -3) if maybe(generator, 0.1) else None
    scene["temperature"] = maybe(generator, 0.3)
    unused(generator, 4)
    scene["safety factor"] = choice([0.9, 0.9, 0.9, 0.5, 0.3])
    scene["steps"] = choice([10, 30, 60, 100, 200])
    scene["check interval"] = choice([20, 20, 1, 5])
    scene["units"] = drawn_units(generator)
    scene["outputs"] = choice([1, 3, 3, 7])
    scene["pictures"] = maybe(generator, 0.3)
    scene["probe"] = maybe(generator, 0.3)
    scene["checkpoint"] = choice([3, 7, 7, 20])
    scene["ranks"] = choice([1, 2, 2, 3])
    scene["resumed on"] = choice(["one", "all"])
    scene.update(drawn_smoothed(generator))
    scene["refill"] = {"stretch": choice([1.02, 1.1, 1.5]), "surface": choice(["held", "held", "sliding"]),
                       "interval": choice([20, 5, 1])} if maybe(generator, 0.5) else None
    scene["refined"] = {"axis": choice([0, 1, 1, 2]), "share": choice([0.5, 0.5, 0.7])} if maybe(generator, 0.4) else None
    scene["adaptive"] = drawn_adaptive(generator) if maybe(generator, 0.3) else None
    scene["largest ratio"] = choice([1, 1, 2, 4, 8])
    return legal(scene)


def drawn_smoothed(generator):
    """Smoothed particles and smoothed cells; drawn last, so that all else of a scene is as without them."""
    choice = generator.choice
    smoothed = {
            "smoothed particles": maybe(generator, 0.25), "smoothed cells": maybe(generator, 0.25),
            "smoothing length": choice([1.5, 1.5, 1.2, 1.8]), "radial kernel": choice(["hyperbolic spline", "cubic spline"]),
            "radial gradient": choice(["corrected", "corrected", "corrected", "paper"]),
            "pair terms": [name for name in PAIR_TERMS if maybe(generator, 0.3)]}
    unused(generator, 3)
    smoothed["convex dilation"] = choice([1.1, 1.1, 1.5])
    smoothed["dilatation of cells"] = choice([False, True, False, True])
    return smoothed


def drawn_adaptive(generator):
    """Cells that are divided and joined in the run."""
    choice = generator.choice
    return {"criterion": choice(["stress gradient", "stress gradient", "plastic strain"]), "above": power(generator, -5, -2),
            "below": choice([None, 0.5, 0.9]), "levels": choice([1, 1, 2]), "layers": choice([0, 1]),
            "interval": choice([20, 5, 3])}


def name_of(scene, formulation):
    """What replaces a formulation of the scene."""
    if formulation == PARTICLES and scene["smoothed particles"]:
        return SMOOTHED_PARTICLES
    if formulation == ELEMENTS[1] and scene["smoothed cells"]:
        return SMOOTHED_CELLS
    return formulation


def drawn_units(generator):
    """Powers of ten of the units of length, mass and time."""
    kind = generator.choice(["one", "one", "si", "si", "any", "extreme"])
    return {"one": [0, 0, 0], "si": [-3, -5, -6.7],
            "any": [generator.randint(-6, 6) for _ in range(3)],
            "extreme": [generator.randint(-15, 15) for _ in range(3)]}[kind]


def drawn_mesh(generator, dimension):
    choice = generator.choice
    most = 8 if dimension == 2 else 5
    cells = [choice([1, 1, 2, 3, 4, 5, 6, 8]) for _ in range(3)]
    cells = [min(n, most) for n in cells]
    if maybe(generator, 0.3):
        cells[generator.randrange(2)] = choice([8, 12, 20])
    while math.prod(cells[:dimension]) > MOST_CELLS:
        cells[cells.index(max(cells[:dimension]))] //= 2
    return {"mesh": choice(["box"] * 6 + ["disc", "cylinder", "spherical shell"]), "cells": cells,
            "spacing": [choice([1., 1., 1., 0.5, 2.5]) for _ in range(3)],
            "disorder": choice([0., 0., 0.1, 0.2, 0.3]), "surface": choice(["fixed", "slide"]),
            "rotation": choice([0., 0., 0., 17., 45.]), "offset": choice([0., 0., 0., -1., 1e4])}


def drawn_body(generator):
    """Parts and what they are made of."""
    choice = generator.choice
    all_formulations = ELEMENTS[:2] * 2 + ELEMENTS[2:] + [PARTICLES] * 5
    model = choice(["elastic", "j2 plasticity", "j2 plasticity", "chaboche"])
    return {"layout": choice(["one", "one", "halves", "halves", "core", "layer"]),
            "formulations": [choice(all_formulations), choice(all_formulations)],
            "model": model, "flow stress": choice(["linear hardening", "johnson cook", "tabular"]),
            "poisson": choice([0., 0.3, 0.3, 0.45, 0.49, -0.3]), "yield": power(generator, -4, -1),
            "hardening": choice([0., 0.1, 1.]), "taylor quinney": choice([0., 0., 0.9]),
            "expansion": choice([0., 0., 1e-5, 1e-3]), "softening modulus": maybe(generator, 0.15),
            "second material": choice([None, None, [1., 1.], [0.1, 1.], [100., 3.], [0.01, 0.1]]),
            "second model": choice(["elastic", "j2 plasticity"])}


def drawn_particles(generator):
    choice = generator.choice
    particles = {
            "kernel": choice(["cubic spline", "cubic spline", "quintic spline"]),
            "dilation": choice([1.8, 1.8, 1.3, 1.5, 2.1]),
            "smoothing": choice(["affine", "affine", "paper", "fe matched", "phase", "none", "1.3"]),
            "configuration": choice(["total Lagrangian", "total Lagrangian", "updated Lagrangian", "current"]),
            "rebuild": choice([["Rebuild interval", 7], ["Rebuild interval", 1], ["Rebuild deformation", 0.02]]),
            "shape functions": choice(["automatic", "moving least squares", "moving least squares"])}
    return dict(particles, **{"rounded rows": generator.randrange(4) == 0})


def drawn_failure(generator):
    choice = generator.choice
    criterion = choice(["effective plastic strain", "principal stress", "shear strain"])
    bonds = {"criterion": criterion, "limit": power(generator, -3, -0.5), "stretch": choice([1., 1.02]),
             "combination": choice(["both", "both", "either"]), "interval": choice([5, 1])}
    return {"bonds": bonds if maybe(generator, 0.25) else None, "self-contact": maybe(generator, 0.15),
            "erosion": power(generator, -3, 0) if maybe(generator, 0.15) else None,
            "conversion": {"by": choice(["strain", "scaled Jacobian", "time step"]),
                           "strain": power(generator, -3, -0.5), "layers": choice([0, 1, 2]),
                           "interval": choice([1, 5, 20])} if maybe(generator, 0.15) else None}


def drawn_scaling(generator):
    choice = generator.choice
    return {"mass": choice([1, 1, 4.]), "time": choice([1, 1, 2., 100.]), "target": choice([None, 1.1, 1.5]),
            "interval": choice([20, 3])}


def drawn_heat(generator):
    choice = generator.choice
    heat = {"capacity": power(generator, -5, -2), "diffusivity": choice([0., 0.01, 0.1, 1.]),
            "integration": choice(["explicit", "explicit", "backward Euler", "Crank-Nicolson"]),
            "step": choice([1., 5., 20.])}
    unused(generator, 3)
    return dict(heat, table=maybe(generator, 0.2))


def drawn_contact(generator):
    choice = generator.choice
    return {"surface": choice(["floor", "floor", "floor", "plate", "sphere", "drill", "pin and shoulder", "profile",
                               "faces"]),
            "gap": choice([0., 0.01, 0.1]), "friction": choice([0., 0., 0.1, 0.5]), "damping": choice([0.5, 0., 1.]),
            "stiffness": choice([0.37, 0.37, 0.1, 1.]), "move": choice(["rest", "speed", "turn", "mass"]),
            "speed": power(generator, -4, -1), "mass": power(generator, -2, 2),
            "conductance": choice([0., 0., 0.01]), "edge": choice([0., 0.2])}


def drawn_condition(generator):
    choice = generator.choice
    return {"type": choice(["traction", "body force", "velocity", "displacement", "clamp", "temperature",
                            "heat flux", "convection", "radiation", "adiabatic", "heat source"]),
            "axis": generator.randrange(3), "end": choice(["min", "max"]), "size": power(generator, -5, -2),
            "in time": choice(["1", "t", "sin"]), "free": maybe(generator, 0.4),
            "direction": generator.randrange(3)}


def can_share_dilatation(scene):
    """Whether the particles of the scene have cell averages."""
    return (scene["shape functions"] == "automatic" and scene["smoothing"] in ("affine", "none")
            and scene["configuration"] == "total Lagrangian" and scene["bridge"] == "paper" and scene["bonds"] is None
            and scene["conversion"] is None and scene["erosion"] is None)


def uses_particles(scene):
    return PARTICLES in formulations_of(scene) or scene["conversion"] is not None


def uses_elements(scene):
    return any(name != PARTICLES for name in formulations_of(scene))


def formulations_of(scene):
    return scene["formulations"][:1 if scene["layout"] == "one" else 2]


def is_refined_alike(scene):
    """Whether cells get smaller on both sides of a face between two parts."""
    axis = scene["refined"]["axis"]
    divided = {"one": [], "halves": [0], "layer": [0], "core": [0, 1]}[scene["layout"]]
    return axis < scene["dimension"] and axis not in divided and scene["cells"][axis] > 1


def is_refined_beside_particles(scene):
    """Whether small cells of the first part lie beside large ones of the second, one of them of particles."""
    names = [name_of(scene, formulation) for formulation in formulations_of(scene)]
    are_particles = [name in (PARTICLES, SMOOTHED_PARTICLES) for name in names]
    return (scene["layout"] == "halves" and scene["mesh"] == "box" and scene["cells"][0] % 2 == 0
            and scene["disorder"] <= 0.2 and scene["rotation"] == 0. and sorted(are_particles) == [False, True]
            and scene["conversion"] is None and scene["erosion"] is None and names[1] != SMOOTHED_CELLS)


def is_plastic(scene):
    return scene["model"] in PLASTIC


def legal(scene):
    """The scene without what the program refuses, or what nothing of it uses."""
    scene = dict(scene)
    is_plane = scene["dimension"] == 2
    if is_plane and scene["mesh"] in ("cylinder", "spherical shell"):
        scene["mesh"] = "disc"
    if scene["mesh"] != "box":
        scene.update(disorder=0., rotation=0., offset=0.)
    if scene["rotation"] != 0. or scene["mesh"] == "spherical shell":
        scene["symmetry"] = []
    scene["symmetry"] = [axis for axis in scene["symmetry"]
                         if axis in "xyz"[:scene["dimension"]] and (scene["mesh"] == "box" or axis != "z")]
    nx, ny = scene["cells"][:2]
    if scene["mesh"] == "box" and nx < {"one": 1, "halves": 2, "core": 2 if ny < 2 else 1, "layer": 3}[scene["layout"]]:
        scene["layout"] = "one"
    if scene["layout"] == "one":
        scene["second material"] = None
    if scene["mesh"] != "box" or scene["rotation"] != 0.:
        scene["probe"] = False
    if not uses_elements(scene):
        scene["conversion"] = scene["erosion"] = None
    if not is_plastic(scene):
        scene["erosion"] = None
        scene["taylor quinney"] = 0.
        if scene["conversion"] is not None and scene["conversion"]["by"] == "strain":
            scene["conversion"] = dict(scene["conversion"], by="scaled Jacobian")
        if scene["bonds"] is not None and scene["bonds"]["criterion"] == "effective plastic strain":
            scene["bonds"] = dict(scene["bonds"], criterion="shear strain")
    if scene["conversion"] is not None:
        scene["erosion"] = None
    if not uses_particles(scene):
        scene.update(bonds=None, filter=None)
    else:
        scene["degree"] = 1
    if "lagrange hexahedron" not in formulations_of(scene):
        scene["degree"] = 1
    elif scene["degree"] > 1:
        scene["formulations"] = ["lagrange hexahedron"] * 2
    if scene["smoothed cells"] and ELEMENTS[1] in formulations_of(scene):
        scene["erosion"] = None
    else:
        scene["refill"] = None
    if scene["refined"] is not None:
        if uses_particles(scene):
            scene["refined"] = {"axis": 0, "share": 0.5} if is_refined_beside_particles(scene) else None
        elif scene["erosion"] is not None or scene["degree"] > 1 or not is_refined_alike(scene):
            scene["refined"] = None
    if (uses_particles(scene) or scene["erosion"] is not None or scene["degree"] > 1 or scene["refill"] is not None
            or scene["scaling"] is not None or scene["layout"] != "one"):
        scene["adaptive"] = None
    elif scene["adaptive"] is not None and not is_plastic(scene):
        scene["adaptive"] = dict(scene["adaptive"], criterion="stress gradient")
    if (not uses_elements(scene) or scene["adaptive"] is not None or scene["bridge"] == "trace" or scene["smoothed cells"]):
        scene["largest ratio"] = 1
    if scene["smoothed particles"]:
        scene["filter"] = None
        if scene["configuration"] != "current":
            scene["radial gradient"] = "corrected"
            scene["pair terms"] = [name for name in scene["pair terms"] if name == PAIR_TERMS[0]]
    if scene["bonds"] is not None and scene["bonds"]["combination"] == "either":
        scene["bonds"] = dict(scene["bonds"], stretch=1.02)
    if scene["bonds"] is None:
        scene["self-contact"] = False
    if scene["heat"] is None:
        scene["temperature"] = False
        scene["conditions"] = [condition for condition in scene["conditions"] if not is_thermal(condition)]
    not_moves = (["turn"] if is_plane else []) + (["turn", "mass"] if scene["symmetry"] else [])
    scene["contacts"] = [dict(contact, move="speed") if contact["move"] in not_moves else contact
                         for contact in scene["contacts"]]
    scene["conditions"] = [
        condition for i, condition in enumerate(scene["conditions"])
        if not any(condition["type"] == other["type"] for other in scene["conditions"][:i])]
    if scene["symmetry"]:
        scene["motion"] = None if scene["motion"] is None else dict(
            scene["motion"], kind="flight" if "xyz"[scene["dimension"] - 1] not in scene["symmetry"] else "stretch")
    return scene


def is_thermal(condition):
    return condition["type"] in ("temperature", "heat flux", "convection", "radiation", "adiabatic", "heat source")


# Simpler values of a feature, the simplest first. Items of lists are dropped one by one besides.
SIMPLER = {
    "ranks": [1, 2], "units": [[0, 0, 0]], "contacts": [[]], "conditions": [[]], "symmetry": [[]], "heat": [None],
    "scaling": [None], "filter": [None], "bonds": [None], "self-contact": [False], "erosion": [None],
    "conversion": [None], "motion": [None], "stress": [None], "temperature": [False], "pictures": [False],
    "probe": [False], "mesh": ["box"], "disorder": [0.], "rotation": [0.], "offset": [0.], "surface": ["fixed"],
    "spacing": [[1., 1., 1.]], "dimension": [2], "layout": ["one", "halves"], "second material": [None, [1., 1.]],
    "model": ["elastic"], "flow stress": ["linear hardening"], "poisson": [0., 0.3], "hardening": [0.],
    "taylor quinney": [0.], "expansion": [0.], "softening modulus": [False], "kernel": ["cubic spline"],
    "dilation": [1.8], "dilatation of cells": [False], "smoothing": ["affine", "paper"], "configuration": ["total Lagrangian", "updated Lagrangian"],
    "shape functions": ["automatic"], "rounded rows": [False], "bulk viscosity": [None],
    "degree": [1], "bridge": ["paper"],
    "safety factor": [0.9], "check interval": [20], "outputs": [1, 3], "resumed on": ["one"],
    "steps": [10, 30, 60, 100], "smoothed particles": [False], "smoothed cells": [False], "pair terms": [[]],
    "radial gradient": ["corrected"], "smoothing length": [1.5], "refill": [None],
    "refined": [None], "adaptive": [None], "largest ratio": [1]}


def simpler(scene):
    """Scenes with one feature less each."""
    candidates = []
    for name, values in SIMPLER.items():
        n = values.index(scene[name]) if scene[name] in values else len(values)
        candidates += [dict(scene, **{name: value}) for value in values[:n]]
    for name in ("contacts", "conditions", "symmetry"):
        candidates += [dict(scene, **{name: scene[name][:i] + scene[name][i + 1:]}) for i in range(len(scene[name]))]
    for i, name in enumerate(formulations_of(scene)):
        for other in ELEMENTS[1::-1]:
            if name == other:
                break
            candidates.append(dict(scene, formulations=scene["formulations"][:i] + [other]
                                   + scene["formulations"][i + 1:]))
    for i in range(scene["dimension"]):
        for n in (1, 2, scene["cells"][i] // 2):
            if 0 < n < scene["cells"][i]:
                candidates.append(dict(scene, cells=scene["cells"][:i] + [n] + scene["cells"][i + 1:]))
    for name in ("scaling", "conversion"):
        simple = {"mass": 1, "time": 1, "target": None} if name == "scaling" else {"layers": 0}
        candidates += [dict(scene, **{name: dict(scene[name], **{key: value})})
                       for key, value in simple.items() if scene[name] is not None and scene[name][key] != value]
    for i, contact in enumerate(scene["contacts"]):
        for key, value in {"surface": "floor", "friction": 0., "move": "rest", "conductance": 0., "gap": 0.}.items():
            if contact[key] != value:
                candidates.append(dict(scene, contacts=scene["contacts"][:i] + [dict(contact, **{key: value})]
                                       + scene["contacts"][i + 1:]))
    seen = [scene]
    for candidate in map(legal, candidates):
        if candidate not in seen:
            seen.append(candidate)
            yield candidate
