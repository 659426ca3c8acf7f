# SPDX-License-Identifier: LGPL-2.1-or-later
"""*CONTACT PAIR, *TIE and *CONTACT (of everything)."""

from itertools import combinations

from ..scene import NotUnderstood, number
from .conditions import HEAT_ALONE
from .deck import key

MOST_PAIRS = 45
# Of springs of contacts in motion that are called hard: a fifth of a cell on each side gives way as they do.
HARD = 10
STICKING = 10  # the largest coefficient of friction here


def interactions(deck):
    """Coefficients of friction of *SURFACE INTERACTION by name, and the kinds of their behaviour that are read."""
    result, kinds, current = {}, {}, None
    for section in deck.sections:
        if section.name == "SURFACE INTERACTION":
            section.is_read = True
            current = key(section.name_in("NAME"))
            result[current] = 0.0
        elif section.name == "FRICTION" and current is not None:
            rows = section.rows()
            result[current] = STICKING if section.has("ROUGH") else rows[0].number(0) if rows else 0.0
        elif section.name == "SURFACE BEHAVIOR" and current is not None and \
                key(section.get("PRESSURE-OVERCLOSURE")) in ("HARD", "TIED"):
            section.rows()
            kinds[current] = key(section.get("PRESSURE-OVERCLOSURE"))
        elif section.name in ("STEP", "CONTACT PAIR", "TIE", "MATERIAL"):
            current = None
    return result, kinds


class Contacts:
    def __init__(self, converter):
        self.converter, self.scene = converter, converter.scene
        self.friction, self.kinds = interactions(converter.deck)

    def behaviour_of(self, section, option="INTERACTION"):
        name = section.get(option)
        if not name:
            return {}
        if key(name) not in self.friction:
            section.line.fail(f'There is no *SURFACE INTERACTION "{name}".')
        value = self.friction[key(name)]
        if self.kinds.get(key(name)) == "TIED":
            return {"Type": "tied"}
        return {**({"Friction": number(value)} if value else {}), **self.stiffness_of(name)}

    def stiffness_of(self, name):
        """At rest springs are stiff already."""
        is_at_rest = any(step.is_static for step in self.converter.steps)
        return {"Stiffness": number(HARD)} if self.kinds.get(key(name)) == "HARD" and not is_at_rest else {}

    def pair(self, section):
        behaviour = {"Type": "tied"} if section.has("TIED") else self.behaviour_of(section)
        for option in ("TYPE", "SMALL SLIDING", "MECHANICAL CONSTRAINT", "CPSET", "ADJUST"):
            if option in ("SMALL SLIDING", "ADJUST") and option in section.options:
                continue
            section.get(option)
        for row in section.rows():
            self.add(row, behaviour)

    def tie(self, section):
        section.get("NAME")
        for option in ("CYCLIC SYMMETRY", "MULTISTAGE", "FLUID PERIODIC"):
            if option in section.options:
                raise NotUnderstood(f"{option} is not understood")
        if any(step.has_heat for step in self.converter.steps):
            self.converter.report.note(section.line.place, "*TIE: no heat goes from one side to the other here, unless the "
                                       "Body contact has a Conductance.")
        for row in section.rows():
            self.add(row, {"Type": "tied"})

    def add(self, row, extra):
        slave, master = (self.converter.surface_of(row.line, row.text(k)) for k in (0, 1))
        self.scene.add("Body contacts", "joint", {"Slave boundary": slave, "Master boundary": master, **extra},
                       row.line.place)

    def general(self, section):
        """*CONTACT with all exterior: each two parts that share no nodes."""
        parts = [part.name for part in self.scene.parts]
        following = self.converter.deck.sections[self.converter.deck.sections.index(section) + 1:]
        extra = {}
        for one in following:
            if one.name == "CONTACT INCLUSIONS":
                if not one.has("ALL EXTERIOR"):
                    raise NotUnderstood(f"*CONTACT INCLUSIONS without ALL EXTERIOR ({one.line.place}) is not understood")
                one.is_read = True
            elif one.name == "CONTACT PROPERTY ASSIGNMENT":
                for row in one.rows():
                    if any(row.fields[:2]):
                        continue  # of two surfaces alone
                    name = key(row.text(2))
                    if self.friction.get(name):
                        extra = {"Friction": number(self.friction[name])}
                    extra.update(self.stiffness_of(name))
            elif not one.name.startswith("CONTACT "):
                break
        section.rows()
        pairs = [pair for pair in combinations(parts, 2) if not self.scene.share_nodes(*pair)]
        rigid = set(self.converter.parts.rigid.values())
        pairs = [(other, one) if one in rigid else (one, other) for one, other in pairs if not {one, other} <= rigid]
        if not pairs or len(pairs) > MOST_PAIRS:
            raise NotUnderstood(f"it is among {len(parts)} parts, of which {len(pairs)} pairs share no nodes: write sections "
                                "\"Body contact: NAME\" for those that meet")
        for one, other in pairs:
            self.scene.add("Body contacts", "joint", {"Slave parts": one, "Master parts": other, **extra},
                           section.line.place)
        self.converter.report.note(section.line.place, "*CONTACT: a body that folds and meets itself is not seen.")

    def refuse(self, section):
        raise NotUnderstood(f"{HEAT_ALONE}, and bodies do not touch without mechanics here")

    def readers(self):
        readers = {"CONTACT PAIR": self.pair, "TIE": self.tie, "CONTACT": self.general}
        return readers if self.converter.has_mechanics else dict.fromkeys(readers, self.refuse)
