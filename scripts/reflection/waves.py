# SPDX-License-Identifier: LGPL-2.1-or-later
"""The exact waves of a uniform lattice."""

import math
from dataclasses import dataclass

import numpy

from .operators import StudyError


@dataclass
class LatticeMode:
    """A plane wave p exp(i (k_x x + k_y y - ω t)) that the discretization transports unchanged."""
    wave_number: float  # k_x [1/L], within the first Brillouin zone
    eigenvalue: float  # of the update operator [1/T^2]
    frequency: float  # ω under central differences [1/T]
    group_velocity: float  # ∂ω/∂k_x [L/T]
    polarization: numpy.ndarray  # p of v̂, of length one
    type: str  # P or S, which p is closer to
    is_short: bool  # of the short branch, whose phase and energy travel against each other


class LatticeWaves:
    """The update operator's eigenvectors at (k_x, k_y) far to a side, -1 or 1, of columns that are
    `spacing` apart, with the frequencies ω = (2/Δt) asin(Δt √λ / 2) of central differences
    them."""

    def __init__(self, update, side, spacing, k_y, time_step):
        self.update = update.homogeneous(side)
        self.spacing, self.k_y, self.time_step = spacing, k_y, time_step

    def symbol(self, k_x):
        return self.update.symbol(numpy.asarray(k_x) * self.spacing)

    def eigenpairs(self, k_x):
        """Ascending values, and vectors as columns. Hermitian, since all masses of a uniform
        lattice are equal."""
        symbol = self.symbol(k_x)
        return numpy.linalg.eigh(0.5 * (symbol + symbol.conj().swapaxes(-1, -2)))

    def complete(self, k_x, branch):
        """The mode of a branch at k_x. Throws StudyError where it is not stable under the time
        step."""
        values, vectors = self.eigenpairs(k_x)
        eigenvalue, p = max(0.0, values[branch]), vectors[:, branch]
        sine = 0.5 * self.time_step * math.sqrt(eigenvalue)
        if sine >= 1:
            raise StudyError("The time step is too long for the wave: the step factor must be "
                             "smaller.")
        # dλ/dk of this branch, from the derivative of the symbol (Hellmann and Feynman).
        step = 1e-5 / self.spacing
        up, down = self.symbol([k_x + step, k_x - step])
        slope = (p.conj() @ (up - down) @ p).real / (2 * step)
        velocity = (slope / (2 * math.sqrt(eigenvalue) * math.sqrt(1 - sine * sine))
                    if eigenvalue > 0 else 0.0)
        along = abs(p[0] * k_x + p[1] * self.k_y)
        return LatticeMode(k_x, eigenvalue, 2 / self.time_step * math.asin(sine), velocity, p,
                           "P" if 2 * along**2 > k_x**2 + self.k_y**2 else "S", velocity * k_x < 0)

    def mode(self, k_x, wave):
        """The wave of a type at k_x, in the phase in which the larger component is real and
        positive. Throws StudyError."""
        mode = self.complete(k_x, 0)
        if mode.type != wave:
            mode = self.complete(k_x, 1)
        largest = mode.polarization[abs(mode.polarization).argmax()]
        mode.polarization = mode.polarization * (abs(largest) / largest)
        return mode

    def continued(self, neighbour, k_x):
        """The wave at k_x whose polarization is nearest to that of a neighbour, with its phase: the
        same branch, a little farther. Throws StudyError."""
        overlaps = self.eigenpairs(k_x)[1].conj().T @ neighbour.polarization
        mode = self.complete(k_x, int(abs(overlaps).argmax()))
        overlap = mode.polarization.conj() @ neighbour.polarization
        mode.polarization = mode.polarization * (overlap / abs(overlap))
        return mode

    def by_side(self, frequency):
        """All waves of a frequency: those whose energy travels to the right, and the others."""
        target = (2 / self.time_step * math.sin(0.5 * frequency * self.time_step))**2
        samples = numpy.linspace(-math.pi, math.pi, 2049) / self.spacing
        is_below = self.eigenpairs(samples)[0] < target
        interval, branch = numpy.nonzero(is_below[1:] != is_below[:-1])
        low, high = samples[interval], samples[interval + 1]
        starts_below, numbers = is_below[interval, branch], numpy.arange(len(branch))
        for _ in range(9):  # each makes the intervals smaller by a factor of 64
            between = numpy.linspace(low, high, 65)
            is_below = self.eigenpairs(between)[0][:, numbers, branch] < target
            first = (is_below[1:] != starts_below).argmax(axis=0)
            low, high = between[first, numbers], between[first + 1, numbers]
        modes = [self.complete(*start) for start in zip(0.5 * (low + high), branch)]
        return ([mode for mode in modes if mode.group_velocity > 0],
                [mode for mode in modes if mode.group_velocity <= 0])
