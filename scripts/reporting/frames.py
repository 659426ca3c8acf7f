# SPDX-License-Identifier: LGPL-2.1-or-later
"""The frames of the 3-D view: positions in 16 bits, colours in 8 bits, as base64."""

import base64

import matplotlib
import numpy

from . import units
from .bodies import evenly

MAXIMUM_FRAMES = 41
MAXIMUM_BYTES = 9_000_000  # before base64, which adds a third
PARTICLE_BYTES = 12  # of the position and the shape
# Bodies fly out of the box of the view; this many of its sizes beyond it, they are left out.
REACH = 1.0
LINE_WIDTH = 0.005  # of tools in two dimensions, of the size of the bodies


def packed(values, kind):
    return base64.b64encode(numpy.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")


def colour_stops(name, count=17):
    """Colours of a map from low to high, as hexadecimal numbers."""
    colours = matplotlib.colormaps[name](numpy.linspace(0, 1, count))[:, :3]
    return ["#%02x%02x%02x" % tuple(int(round(255 * part)) for part in colour) for colour in colours]


def coloured(values, one):
    """0 for what is no number, 1 to 255 from the low to the high end of the range."""
    span = (one.high - one.low) or 1.0
    levels = 1 + numpy.clip(numpy.nan_to_num((values - one.low) / span, nan=0.0), 0, 1) * 254
    return numpy.where(numpy.isfinite(values), levels.round(), 0)


def bytes_of(shot, n_fields):
    return (len(shot.points) * 6 + len(shot.faces) * (16 + n_fields) + len(shot.centres) * (PARTICLE_BYTES + n_fields)
            + len(shot.forces) * 12 + len(shot.tool_faces) * 24)


class Quantiser:
    """Positions in the box of the view and its surroundings as whole numbers from 0 to 65535."""

    def __init__(self, bodies, shots):
        low, high = bodies.box
        size = numpy.maximum(high - low, 0.05 * bodies.size)
        low, high = low - REACH * size, high + REACH * size
        points = [shot.all_points() for shot in shots]
        points += [end for shot in shots for end in bodies.arrows(shot)]
        points += [shot.tool_points for shot in shots]
        everything = numpy.vstack([part for part in points if len(part)])
        everything = everything[numpy.isfinite(everything).all(axis=1)]
        self.low = numpy.maximum(low, everything.min(axis=0))
        self.high = numpy.minimum(high, everything.max(axis=0))
        self.span = numpy.maximum(self.high - self.low, 1e-9 * bodies.size)

    def inside(self, points):
        margin = 1e-6 * self.span
        return ((points >= self.low - margin) & (points <= self.high + margin)).all(axis=1)

    def of(self, points):
        return numpy.clip(numpy.nan_to_num((points - self.low) / self.span) * 65535, 0, 65535).round()


def thinned(shot, n_kept):
    """Every k-th particle, larger, so that at most n_kept are left."""
    step = -(-len(shot.centres) // max(n_kept, 1))
    if step <= 1:
        return
    shot.centres, shot.shapes = shot.centres[::step], shot.shapes[::step] * step**(1 / 3)
    shot.particle_values = {name: values[::step] for name, values in shot.particle_values.items()}
    shot.particle_step = step


def ribbons(lines, width):
    """Triangles (2n, 3, 3) of the lines (n, 2, 3) of tools in two dimensions."""
    begin, end = lines[:, 0], lines[:, 1]
    along = end - begin
    length = numpy.maximum(numpy.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    side = width / 2 * numpy.cross([0, 0, 1], along / length)
    return numpy.stack([begin + side, begin - side, end - side, begin + side, end - side, end + side], axis=1).reshape(-1, 3, 3)


class Packer:
    """Makes the frames one after the other; what is as in the frame before refers to it."""

    def __init__(self, bodies, quantiser):
        self.bodies, self.quantiser = bodies, quantiser
        self.earlier = {}
        self.n_lost = 0

    def once(self, frame, number, key, text):
        """Puts the text under the key, or the number of the frame that has the same."""
        if self.earlier.get(key, (None, None))[0] == text:
            frame[key] = self.earlier[key][1]
        else:
            frame[key] = text
            self.earlier[key] = (text, number)

    def frame(self, number, shot):
        quantiser, fields = self.quantiser, self.bodies.fields
        kept_faces = quantiser.inside(shot.points)[shot.faces].all(axis=1) if len(shot.faces) else numpy.zeros(0, bool)
        kept = quantiser.inside(shot.centres)
        self.n_lost += int((~kept).sum() + (~kept_faces).sum())
        frame = {"time": self.bodies.time_text(shot.time), "positions": packed(quantiser.of(shot.points), "<u2"),
                 "faceValues": packed(self.values(shot.face_values, kept_faces), "u1"),
                 "particles": packed(quantiser.of(shot.centres[kept]), "<u2"),
                 "particleValues": packed(self.values(shot.particle_values, kept), "u1")}
        self.once(frame, number, "faces", packed(shot.faces[kept_faces], "<u4"))
        shapes = shot.shapes[kept]
        largest = float(numpy.abs(shapes).max()) if kept.any() else 1.0
        frame["radius"] = largest
        entries = numpy.stack([shapes[:, [0, 1, 2], [0, 1, 2]], shapes[:, [1, 2, 0], [2, 0, 1]]])
        self.once(frame, number, "shapes", packed((entries / largest * 127).round(), "i1"))
        tails, tips = self.bodies.arrows(shot)
        frame["arrows"] = packed(quantiser.of(numpy.hstack([tails, tips]).reshape(-1, 3)), "<u2")
        triangles = shot.tool_points[shot.tool_faces] if len(shot.tool_faces) else numpy.zeros((0, 3, 3))
        if triangles.shape[1] == 2:
            seen = quantiser.inside(triangles.reshape(-1, 3)).reshape(-1, 2).any(axis=1)
            triangles = ribbons(triangles[seen], LINE_WIDTH * self.bodies.size)
        self.once(frame, number, "tools", packed(quantiser.of(triangles.reshape(-1, 3)), "<u2"))
        return frame

    def values(self, values, kept):
        rows = [coloured(values[one.text][kept], one) if one.text in values else numpy.zeros(int(kept.sum()))
                for one in self.bodies.fields]
        return numpy.concatenate(rows) if rows else numpy.zeros(0)


def view_times(bodies, note):
    """The outputs that the view shows, so that its frames stay within the bytes that there are."""
    last = next((shot for time in reversed(bodies.times) if (shot := bodies.snapshot(time))), None)
    if last is None:
        return []
    size = bytes_of(last, len(bodies.fields))
    count = min(MAXIMUM_FRAMES, MAXIMUM_BYTES // max(size, 1))
    if count < min(4, len(bodies.times)):
        bodies.particles_kept = max(1000, MAXIMUM_BYTES // 4 // (PARTICLE_BYTES + len(bodies.fields)) // 2)
        without = size - max(0, len(last.centres) - bodies.particles_kept) * (PARTICLE_BYTES + len(bodies.fields))
        count = max(1, min(4, MAXIMUM_BYTES // max(without, 1)))
        if without > 2 * MAXIMUM_BYTES:
            note("warning", f"The body has too many faces for the 3-D view ({len(last.faces)}); pictures show it.")
            return []
    return evenly(bodies.times, count)


def make_view(bodies, times, note):
    """What the view needs, for the page: its box, fields and frames. None where there is nothing."""
    shots = [shot for time in times if (shot := bodies.snapshot(time))]
    if not shots or not bodies.fields:
        return None
    if getattr(bodies, "particles_kept", None):
        for shot in shots:
            thinned(shot, bodies.particles_kept)
    packer = Packer(bodies, Quantiser(bodies, shots))
    frames = [packer.frame(number, shot) for number, shot in enumerate(shots)]
    length = units.scale_for(bodies.size, bodies.run.results.units.label("L"))
    low, span = packer.quantiser.low * length.factor, packer.quantiser.span * length.factor
    for frame in frames:
        frame["radius"] *= length.factor
    if packer.n_lost:
        note("note", f"{packer.n_lost} particles or faces, summed over the frames of the 3-D view, are far away from the "
             "bodies and are left out of it.")
    if shots[-1].particle_step > 1:
        note("note", f"The 3-D view shows one of {shots[-1].particle_step} particles, enlarged.")
    return {"low": low.tolist(), "span": span.tolist(), "unit": length.label, "flat": bool(bodies.is_flat),
            "frame": [(end * length.factor).tolist() for end in bodies.box],
            "fields": [{"title": one.title, "unit": one.scale.label, "low": one.low * one.scale.factor,
                        "high": one.high * one.scale.factor, "range": one.range_text(),
                        "stops": colour_stops(one.colours)} for one in bodies.fields],
            "frames": frames}
