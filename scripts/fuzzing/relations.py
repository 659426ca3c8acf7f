# SPDX-License-Identifier: LGPL-2.1-or-later
"""Relations: what a scene and another one of the same motion have in common.

A relation changes how a scene is written (a view), or how it is run. All tables of both runs are transformed back to the
scene itself and compared, column by column.

Steps follow from estimates that depend on numbers, so that both are run with one given step, but in relations of units,
which change nothing but the exponents. Motions may amplify round-off: where both differ by more than `SAME`, the scene is run
twice more with velocities and temperatures changed by scene_runs.PERTURBATION at the start, and the relation may be off by
scene_runs.GROWTH times as much as these; beyond scene_runs.CHAOS chance decides.
"""

import collections
import math
import os
import random
import re
import time

from . import frames, related_scenes, scene_runs, scenes

# view: how the other scene is written; ranks: on how many it runs; is_resumed: whether it is the same one, resumed.
Relation = collections.namedtuple("Relation", "kind text view ranks is_resumed")
Result = collections.namedtuple("Result", "scene relation kind reason problem figures seconds")

KINDS = ("axes", "units", "decimal units", "moved", "flight", "numbering", "whole", "source", "ranks", "resume")
SAME = 1e-9
SAME_AT_REST = 1e-6
SAME_WITH_SPRINGS = 1e-3
# Far from the origin coordinates have fewer digits, which affects springs of contacts first.
SAME_ELSEWHERE = 1e-7
PERTURBATION_ELSEWHERE = 1e-9
TABLES = ("statistics", "conditions", "contact", "sections", "parts", "rigid_bodies", "probes")
# Columns that count what touches by round-off, or what an equation needs.
ROUND_OFF = re.compile(".*(nodes|area in contact|static iterations|static residual|thermal steps|smoothed kinetic energy)$")
COUNTS = re.compile(".*(cells|bonds|particles|fragments|refinements|refills|particles .*)$")
# Columns that depend on the velocity of the frame.
FLIGHT_COLUMNS = re.compile(".*(kinetic|work|total|power|eroded|heat of bodies|heat of tool|refinement loss|energy of rotation|"
                            "moment|torque).*|largest speed")
# The least of a quantity that counts, over that of waves with a strain of one.
FLOORS = {"energy": 1e-12, "momentum": 1e-7, "pressure": 1e-6}


def relation_of(scene, kind, seed):
    """A relation of this kind, or None where a scene has none. The seed chooses among several."""
    generator = random.Random("%s %d" % (kind, seed))
    dim = scene["dimension"]
    view = related_scenes.plain(scene)
    frame = view.frame
    writer = related_scenes.Writer(scene, view)

    def in_frame(text, **changes):
        return Relation(kind, text, view._replace(frame=frame._replace(**changes)), 1, False)
    if kind == "whole" and depends_on_directions(scene):
        return None
    if kind == "axes":
        ways = [axes for axes in frames.all_axes(dim)[1:] if not depends_on_directions(scene) or math.prod(axes[1]) > 0]
        order, signs = generator.choice(ways)
        text = ", ".join(("-" if sign < 0 else "") + "xyz"[axis] for axis, sign in zip(order, signs))
        return in_frame("axes %s" % text, order=order, signs=signs)
    if kind == "units":
        powers = [generator.randint(-20, 20) for _ in range(3)] + [generator.randint(-4, 4)]
        return in_frame("units 2^%s" % powers, units=tuple(2. ** power for power in powers))
    if kind == "decimal units":
        units = tuple(generator.choice([1., 1e3, 1e-3, 1e-6]) for _ in range(3)) + (generator.choice([1., 1e3, 1e-3]),)
        return in_frame("units %s" % (units,), units=units)
    if kind == "moved":
        shift = [generator.uniform(-2., 2.) * max(writer.extents()) for _ in range(dim)]
        return in_frame("moved by %s cells" % ["%.3g" % x for x in shift], shift=tuple(writer.length(x) for x in shift))
    if kind == "flight":
        boost = [0. if "xyz"[i] in scene["symmetry"] else generator.uniform(-0.01, 0.01) for i in range(dim)]
        # Mass that is added has the velocity of the body, and nodes without cells are at rest: both depend on the frame.
        gains = scene["scaling"] is not None and scene["scaling"]["target"] is not None
        if (scene["static"] or scene["damping"] and scene["damping"]["rate"] or scene["rigid"] or gains
                or scene["erosion"] is not None):
            return None
        return in_frame("in flight with %s" % ["%.3g" % v for v in boost], boost=tuple(writer.speed(v) for v in boost))
    if kind == "numbering":
        return Relation(kind, "another numbering", view._replace(numbering=seed), 1, False)
    if kind == "whole":
        # Functions of smoothed cells end at a plane.
        has_part = (scene["section"] or scene["rigid"] or (scene["bulk viscosity"] and scenes.uses_particles(scene))
                    or has_smoothed_cells(scene))
        return None if not scene["symmetry"] or has_part else Relation(
            kind, "the whole", view._replace(is_whole=True), 1, False)
    if kind == "source":
        return None if scene["disorder"] > 0. else Relation(
            kind, "boxes in place of a file", view._replace(source="box"), 1, False)
    if kind == "ranks":
        ranks = generator.choice([2, 3])
        return Relation(kind, "%d ranks" % ranks, view, ranks, False)
    return Relation(kind, "resumed", view, 1, True)


def depends_on_directions(scene):
    """Whether results depend on which axes are turned round: sub-cells of smoothed hexahedra are at every other corner,
    counted along axes that follow from positions, not from the order of a cell's nodes."""
    return scene["dimension"] == 3 and has_smoothed_cells(scene)


def has_smoothed_cells(scene):
    return scene["smoothed cells"] and scenes.ELEMENTS[1] in scenes.formulations_of(scene)


# Tables.

def without_counterpart(scene, relation, columns):
    """The columns that both runs have in common, of the run of the scene itself."""
    result = {name: column for name, column in columns.items()
              if name not in scene_runs.SHARES and not ROUND_OFF.fullmatch(name) and not name.startswith("relative error")}
    if relation.kind == "flight":
        result = {name: column for name, column in result.items() if not FLIGHT_COLUMNS.fullmatch(name)}
    if relation.kind == "whole":
        normal = tuple(" " + axis for axis in scene["symmetry"])
        result = {name: column for name, column in result.items() if not name.endswith(normal)
                  and not COUNTS.fullmatch(name) and not frames.TURNS.search(name.rpartition(" ")[0])}
    return result


def is_of_all(unit):
    """Whether a quantity is a sum over the bodies."""
    return unit.startswith("M") and not unit.startswith("M/")


def transformed_back(scene, relation, columns):
    columns = frames.transformed_back(relation.view.frame, columns)
    if relation.view.is_whole:
        share = 0.5 ** len(scene["symmetry"])
        columns = {name: (unit, [share * value for value in values] if is_of_all(unit) else values)
                   for name, (unit, values) in columns.items()}
    return columns


def tables_of(run):
    return {name: run.table(name + ".csv") for name in TABLES if os.path.exists(run.output(name + ".csv"))}


def scale_of(unit, largest, floors):
    """What a difference of a quantity counts beside; `largest` has the largest value of each unit."""
    own = max(largest[unit], floors.get(unit, 0.))
    if unit == "M L^2/T":
        return max(own, floors["reach"] * max(largest["M L/T"], floors["M L/T"]))
    if unit == "M L/T" and largest["L/T"] > 0.:
        return max(own, largest["M L^2/T^2"] / largest["L/T"])
    return own


def floors_of(scene, relation):
    """The least of each unit beside which differences count, and the reach of the scene."""
    writer = related_scenes.Writer(scene, related_scenes.plain(scene))
    reach, energy, momentum, pressure = scene_runs.scales_of(scene, None)
    frame = relation.view.frame
    far = 1. + max([abs(float(d)) for d in frame.shift or ()] + [0.]) / reach
    area = energy / pressure / reach if reach > 0. else 1.
    mass = scene_runs.scale_of_mass(scene)
    speed = FLOORS["momentum"] * momentum / mass + 1e-6 * max([abs(float(v)) for v in frame.boost or ()] + [0.])
    return {"reach": reach * far, "M L^2/T^2": FLOORS["energy"] * energy, "M L/T": mass * speed, "L/T": speed,
            "M/(L T^2)": FLOORS["pressure"] * pressure * far, "M L/T^2": FLOORS["pressure"] * pressure * far * area,
            "L": 1e-6 * reach * far, "1": 1e-6, "T": float(writer.time(1e-3)), "M L^2/T^3": 0.}


def difference_of(scene, relation, first, other):
    """The largest difference of two runs over its scale, and the column that has it."""
    if relation.kind == "flight" and {first.code, other.code} == {0, 2}:
        return 0., "none"  # the limit of the energy error is a share of an energy that depends on the frame
    if first.code != other.code:
        return math.inf, "exit code"
    if first.code != 0:
        return 0., "none"
    one, two = tables_of(first), tables_of(other)
    if set(one) != set(two):
        return math.inf, "tables"
    pairs = {}
    for table in one:
        columns = without_counterpart(scene, relation, one[table])
        others = transformed_back(scene, relation, two[table])
        if set(columns) - set(others):
            return math.inf, "%s: columns %s" % (table, sorted(set(columns) - set(others))[0])
        pairs.update({(table, name): (unit, values, others[name][1]) for name, (unit, values) in columns.items()})
    return largest_difference(pairs, floors_of(scene, relation))


def largest_difference(pairs, floors):
    largest = collections.defaultdict(float)
    for (_, name), (unit, values, others) in pairs.items():
        if unit != "1":
            largest[unit] = max(largest[unit], scene_runs.largest(values + others))
    result = 0., "none"
    for (table, name), (unit, values, others) in pairs.items():
        if len(values) != len(others):
            return math.inf, "%s: rows" % table
        if unit == "1":
            scale = max(scene_runs.largest(values + others), floors["1"])
        else:
            scale = scale_of(unit, largest, floors)
        for i, (a, b) in enumerate(zip(values, others)):
            if math.isnan(a) != math.isnan(b):
                return math.inf, "%s: %s, row %d: %g and %g" % (table, name, i, a, b)
            if not math.isnan(a) and abs(a - b) > result[0] * scale:
                result = (abs(a - b) / scale if scale > 0. else math.inf,
                          "%s: %s, row %d: %.17g and %.17g" % (table, name, i, a, b))
    return result


def crash_of(run, what):
    if run.code is None:
        return scene_runs.Problem("hang", "%s: it hangs" % what)
    return scene_runs.Problem("crash", "%s: it ends with %d" % (what, run.code))


class Judge(scene_runs.Judge):
    """Runs scenes and those that are related to them."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.kept = {}

    @staticmethod
    def files_of(scene, relation=None, fixed_step=None, perturbation=None):
        view = relation.view if relation is not None else related_scenes.plain(scene)
        if fixed_step is not None:
            fixed_step *= view.frame.units[2]
        return related_scenes.files_of(scene, view, perturbation, fixed_step)

    def run_scene(self, name, scene, relation=None, **changes):
        files = self.files_of(scene, relation, **changes)
        key = (name, tuple(sorted(files.items())))
        if relation is None and self.kept.get(name, (None,))[0] == key:
            return self.kept[name][1]
        run = self.run_files(name, files, relation.ranks if relation is not None else 1)
        if relation is None:
            self.kept[name] = key, run
        return run

    def related(self, scene, relation):
        """The result of a scene and a relation."""
        begin = time.monotonic()
        figures = {}
        first = self.run_scene("first", scene)
        kind = {0: "run", 1: "refused", 2: "stopped"}.get(first.code, "failed")
        problem = None
        if kind == "refused" and first.reason() == "":
            problem = scene_runs.Problem("refusal", "the scene itself is refused without a word")
        elif kind == "failed":
            problem = crash_of(first, "the scene itself")
        elif relation.is_resumed:
            if kind == "run":
                problem = self.problem_of_resumption(self.files_of(scene), first, 1, figures)
                self.kept.pop("first", None)
        else:
            problem = self.problem_of_relation(scene, relation, first, figures)
        return Result(scene, relation, "failed" if problem else kind, first.reason(), problem, figures,
                      time.monotonic() - begin)

    def problem_of_relation(self, scene, relation, first, figures):
        other = self.run_scene("other", scene, relation)
        if other.code not in (0, 1, 2):
            return crash_of(other, relation.text)
        if first.code == 1 or other.code == 1:
            return None if first.code == other.code and first.reason() == other.reason() else scene_runs.Problem(
                relation.kind, "%s: it ends with %d (%s), and the scene with %d (%s)" % (
                    relation.text, other.code, other.reason(), first.code, first.reason()))
        runs, changes = [first, other], {}
        difference, column = difference_of(scene, relation, *runs)
        has_own_steps = scene["static"] is not None
        if not has_own_steps and relation.kind not in ("units", "decimal units") or difference > self.same(scene, relation):
            if not has_own_steps:
                steps = [run.table()["time step"][1] for run in runs]
                steps[1] = [step / relation.view.frame.units[2] for step in steps[1]]
                # Outputs are met by equal steps, of which there may be one more.
                between = scene_runs.largest(first.table()["time"][1]) / scene["outputs"]
                allowed = (scene_runs.SAME_STEP + 1.5 * steps[0][0] / between) * steps[0][0]
                if relation.kind != "whole" and abs(steps[1][0] - steps[0][0]) > allowed:
                    return scene_runs.Problem(relation.kind, "%s: the first step is %g, and %g in the scene itself" % (
                        relation.text, steps[1][0], steps[0][0]))
                changes = {"fixed_step": 0.9 * min(steps[0] + steps[1])}
                runs = [self.run_scene("first fixed", scene, **changes),
                        self.run_scene("other fixed", scene, relation, **changes)]
                difference, column = difference_of(scene, relation, *runs)
        figures[relation.kind] = difference
        if difference <= self.same(scene, relation):
            return None
        # Elsewhere coordinates have fewer digits: a larger change than one of velocities.
        size = PERTURBATION_ELSEWHERE if relation.kind in ("moved", "flight") else scene_runs.PERTURBATION
        twins = [self.run_scene("twin at %g" % phase, scene, perturbation=(size, phase), **changes)
                 for phase in (0.4, 1.9)]
        growth = max([difference_of(scene, self.identity(scene), runs[0], twin)[0] for twin in twins if twin.code in (0, 2)],
                     default=0.)
        figures["growth"] = growth
        if growth > scene_runs.CHAOS or difference <= scene_runs.GROWTH * growth:
            return None
        return scene_runs.Problem(relation.kind, "%s: differs by %.2g in %s, where a change of the start by %g makes %.2g" % (
            relation.text, difference, column, size, growth))

    @staticmethod
    def identity(scene):
        return Relation("identity", "", related_scenes.plain(scene), 1, False)

    @staticmethod
    def same(scene, relation):
        if scene["static"] is not None:
            # A time of which springs of a contact are made has the tolerance of the estimate, whose start follows the
            # digits of positions; a power of two keeps these.
            has_springs = bool(scene["contacts"]) or scene["second body"] is not None
            keeps_digits = relation.kind in ("units", "ranks", "resume", "source")
            return SAME_WITH_SPRINGS if has_springs and not keeps_digits else SAME_AT_REST
        return SAME_ELSEWHERE if relation.kind in ("moved", "flight") else SAME


def shrunk(judge, scene, relation, problem, seed, tries=60, print_line=None):
    """The simplest scene found that fails in the same relation, and how."""
    position = n_in_vain = 0
    while tries > 0:
        candidates = list(related_scenes.simpler(scene))
        if n_in_vain >= len(candidates):
            break
        position %= len(candidates)
        candidate = candidates[position]
        other = relation_of(candidate, relation.kind, seed)
        n_in_vain += 1
        if other is not None:
            tries -= 1
            result = judge.related(candidate, other)
            if result.problem is not None and result.problem.kind == problem.kind:
                scene, relation, problem, n_in_vain = candidate, other, result.problem, 0
                if print_line is not None:
                    print_line("  simpler: %s" % problem.text)
                continue
        position += 1
    return scene, relation, problem
