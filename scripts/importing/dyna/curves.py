# SPDX-License-Identifier: LGPL-2.1-or-later
"""*DEFINE_CURVE, *DEFINE_TABLE and *DEFINE_TABLE_2D."""


class Curve:
    def __init__(self, section, report):
        self.record, lines = section.head()
        self.line = section.line
        self.number = self.record.integer("LCID")
        scale_x, scale_y = self.record.number("SFA") or 1, self.record.number("SFO") or 1
        offset_x, offset_y = self.record.number("OFFA"), self.record.number("OFFO")
        self.points = []
        for line in lines:
            if line.text.strip():
                point = section.values(line, 20)
                self.points.append((scale_x * (point[0] + offset_x), scale_y * (point[1] + offset_y)))
                if any(point[2:]):
                    report.count(line.place, f"a card of *{section.keyword} has more than two numbers.")

    def check_times(self):
        """Points of a function of time."""
        times = [time for time, _ in self.points]
        if len(times) < 2:
            self.line.fail(f"the curve {self.number} has {len(times)} points. A function of time needs two at least.")
        for before, after in zip(times, times[1:]):
            if after <= before:
                self.line.fail(f"the curve {self.number} falls from {before:g} to {after:g} in time. Allowed are times "
                               "that increase.")


class Used(dict):
    """Things by their numbers, which count as used once they were looked up."""

    def __init__(self, things=()):
        super().__init__(things)
        self.used = set()

    def __getitem__(self, number):
        self.used.add(number)
        return super().__getitem__(number)

    def define(self, number, thing, section):
        """Adds a thing; two of one number are refused."""
        if number in self:
            section.line.fail(f"*{section.keyword} has the number {number} of another one before it.")
        self[number] = thing

    def unused(self):
        return [(number, thing) for number, thing in self.items() if number not in self.used]


class Curves(Used):
    """All curves, and tables as their curves with what they belong to (a strain rate or a temperature)."""

    def __init__(self, deck, report):
        super().__init__()
        self.report, self.tables, self.of_time = report, {}, set()
        sections = deck.named("DEFINE_CURVE", "DEFINE_TABLE", "DEFINE_TABLE_2D")
        for section in sections:
            section.is_read = True
            if section.name == "DEFINE_CURVE":
                curve = Curve(section, report)
                self.define(curve.number, curve, section)
        for place, section in enumerate(sections):
            if section.name == "DEFINE_TABLE_2D":
                self.add_named_curves(section)
            elif section.name == "DEFINE_TABLE":
                self.add_table(section, [one for one in sections[place + 1:] if one.name == "DEFINE_CURVE"])

    def add_table(self, section, followers):
        """The curves of the values of a table follow it."""
        record, lines = section.head()
        factor, offset = record.number("SFA") or 1, record.number("OFFA")
        values = [factor * (section.values(line, 20)[0] + offset) for line in lines if line.text.strip()]
        if not values or len(followers) < len(values):
            section.line.fail(f"*DEFINE_TABLE has {len(values)} values, and {len(followers)} curves follow it.")
        numbers = [one.head()[0].integer("LCID") for one in followers[:len(values)]]
        self.tables[record.integer("TBID")] = sorted(zip(values, numbers))

    def add_named_curves(self, section):
        """Each value of a table stands beside the number of its curve."""
        record, lines = section.head()
        factor, offset = record.number("SFA") or 1, record.number("OFFA")
        pairs = []
        for line in lines:
            if line.text.strip():
                value, curve = section.values(line, 20)[:2]
                number = section.transform.number("F", int(curve))
                if number not in self:
                    line.fail(f"*{section.keyword} {record.integer('TBID')} names the curve {number}, which is not there.")
                pairs.append((factor * (value + offset), number))
        if not pairs:
            section.line.fail(f"*{section.keyword} has no values.")
        self.tables[record.integer("TBID")] = sorted(pairs)

    def along_time(self, number):
        """A curve as a function of time."""
        curve = self[number]
        curve.check_times()
        self.of_time.add(number)
        return curve

    def remark_early_ends(self, end):
        """Curves of time that end before the run, unless they end at zero."""
        for number in sorted(self.of_time):
            time, value = self[number].points[-1]
            if end and time < (1 - 1e-6) * end and value != 0:
                self.report.note(self[number].line.place, f"the curve {number} ends at the time {time:g}, and the run at {end:g}. "
                                 "Here it keeps its last value, and in LS-DYNA it is zero or goes on, by the version: add points.")
