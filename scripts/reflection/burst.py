# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sends a burst of one wave at an interface, and measures what returns."""

import math
from dataclasses import dataclass

import numpy
import scipy.sparse

from .case import exact_reflection
from .waves import LatticeWaves

# Slower waves than this fraction of the speed of P waves are not waited for.
SLOWEST = 0.1
FASTEST = 1.1
STEPS_TOGETHER = 64  # of the transform in time


@dataclass
class ReflectionResult:
    """What came back. Amplitudes are those of discrete Fourier transforms in time at the frequency
    of the carrier, over that of the incident wave. The reflected wave is the difference to a run
    without an interface; it is looked at in a window on the left side, at least a wavelength and
    ten spacings from the interface, and is decomposed into the lattice's exact waves there. Values
    are NaN where the lattice has no such incident wave."""
    reflection: float = math.nan  # of the wave of the incident type; the same in v and in v̂
    converted: float = math.nan  # of the other type
    total: float = math.nan  # of all waves: root of reflected over incident energy flux
    smoothed: float = math.nan  # of all of v: root mean square over the window
    unsmoothed: float = math.nan  # of all of v̂, short waves included
    transmitted_energy: float = math.nan  # over the incident energy flux, all waves
    fit_error: float = math.nan  # of v̂ in the window, what is none of the lattice's waves
    # Largest |v̂| of the reflected wave in the window at the end, over that of the incident burst
    # at its start
    remaining: float = math.nan
    exact: float = math.nan  # where it is known: elements, normal incidence
    phase_error: float = math.nan  # of the incident wave: ω/(c k) - 1 without the error of the step
    frequency: float = math.nan
    time_step: float = math.nan
    group_velocity: float = math.nan  # of the incident wave, along the normal
    n_steps: int = 0
    n_columns: int = 0


class Window:
    """Columns begin ... end-1 where waves are measured, with weights whose sum is 1."""

    def __init__(self, begin, end):
        self.begin, self.end = begin, end
        self.columns = numpy.arange(begin, end)
        phases = 2 * math.pi * (self.columns - begin + 0.5) / (end - begin)
        weights = 0.5 - 0.5 * numpy.cos(phases)
        self.weights = weights / weights.sum()

    @classmethod
    def at(cls, near, width, spacing):
        begin = math.ceil(near / spacing)
        return cls(begin, begin + math.ceil(width / spacing))

    def mirrored(self):
        return Window(-self.end + 1, -self.begin + 1)


def slowest_of(modes):
    return max(SLOWEST, min([1.0, *(abs(mode.group_velocity) for mode in modes)]))


@dataclass
class PartialWaves:
    """The waves of one frequency and one wave number along the interface."""
    carrier: object  # of the burst
    incident: list  # all that travel on the left side to the right
    reflected: list
    transmitted: list


class Layout:
    """Where the burst starts and waves are measured, and the columns and steps that this needs:
    `first` ... `last` with the interface, and to `last_without` without it."""

    def __init__(self, case, waves, time_step):
        spacing, right_spacing = case.left_spacing, case.right_spacing

        # Positions. The incident wave is measured in the mirror image of the window of the reflected
        # one, so that both have travelled equally far.
        period_along = 2 * math.pi / waves.carrier.wave_number
        self.incident, self.transmitted = (
            Window.at(max(case.wavelength, 10 * one), 2 * period_along, one)
            for one in (spacing, right_spacing))
        self.reflected = self.incident.mirrored()
        far, far_right = self.incident.end * spacing, self.transmitted.end * right_spacing
        gap = 10 * spacing
        self.burst_length = case.cycles * period_along
        self.burst_begin = -far - gap - self.burst_length

        # Times
        speed = waves.carrier.group_velocity
        arrival = (far + gap) / (FASTEST * speed)
        passed = (far + gap + self.burst_length) / speed
        end = 1.15 * (passed + max(far / speed, far / slowest_of(waves.reflected),
                                   far_right / slowest_of(waves.transmitted)))
        self.n_steps = math.ceil(end / time_step)

        # Rows long enough that nothing comes back from their ends
        way = FASTEST * (end - arrival)
        self.first = -math.ceil(
            max(case.wavelength - self.burst_begin, 0.5 * (way + far)) / spacing)
        self.last = math.ceil(0.5 * (way + max(far, far_right)) / right_spacing)
        self.last_without = math.ceil(0.5 * (way + far) / spacing)

    def within(self, field, window):
        """The values of a window in a field of the columns from the first on."""
        return field[window.begin - self.first:window.end - self.first]


class Burst:
    """Three waves with the wave numbers k and k ± 2π/length, whose sum is one branch's wave of
    number k under a Hann envelope."""

    def __init__(self, waves, carrier, begin, length):
        self.begin, self.length = begin, length
        beside = (waves.continued(carrier, carrier.wave_number + sign * 2 * math.pi / length)
                  for sign in (1, -1))
        self.terms = [(0.5, carrier), *((-0.25, mode) for mode in beside)]

    def start(self, columns, spacing, time_step):
        """e at t = 0 and Δt v̂ at t = -Δt/2, [column, component]."""
        displacement, increment = numpy.zeros((2, len(columns), 2), complex)
        # Columns are counted in whole spacings, so that the ends are not moved by round-off.
        is_within = ((columns >= math.ceil(self.begin / spacing))
                     & (columns <= math.floor((self.begin + self.length) / spacing)))
        for weight, mode in self.terms:
            wave = numpy.exp(1j * mode.wave_number * (columns * spacing - self.begin)) * is_within
            term = weight * numpy.multiply.outer(wave, mode.polarization)
            displacement += term
            increment += term * (1 - numpy.exp(1j * mode.frequency * time_step))
        return displacement, increment


class Motion:
    """The central difference scheme of the program for fields of one wave number along the
    interface:

      d += Δt S v̂,   v̂ -= Δt Φ M⁻¹ (K d + C S v̂),   every n steps v̂ -= δ T^p v̂.

    It is written with the unsmoothed displacement e, d = S e, so that one operator A = Φ M⁻¹ K S
    remains, and with its increments Δt v̂. Chains, each with its operators and its columns (first,
    last), move side by side."""

    def __init__(self, case, filter_fraction, time_step, chains):
        self.power, self.interval, self.fraction = (
            case.filter_power, case.filter_interval, filter_fraction)
        self.time_step, self.chains = time_step, chains
        self.update = self.matrix("update") * time_step**2
        self.damping = self.matrix("damping") * time_step
        self.short_wave_part = self.matrix("short_wave_part") if self.power else None

    def matrix(self, name):
        return scipy.sparse.block_diag([operators[name].matrix(first, last)
                                        for operators, first, last in self.chains], "csr")

    def run(self, burst, spacing, frequency, n_steps):
        """For each chain the transform of v̂ at a frequency, and v̂ at the end, [column,
        component]."""
        starts = [burst.start(numpy.arange(first, last + 1), spacing, self.time_step)
                  for _, first, last in self.chains]
        displacement, increment = (numpy.concatenate([start[part].reshape(-1) for start in starts])
                                   for part in range(2))
        times = (numpy.arange(n_steps) + 0.5) * self.time_step
        factors = numpy.exp(1j * frequency * times)
        spectrum = numpy.zeros_like(increment)
        increments = numpy.empty((STEPS_TOGETHER, len(increment)), complex)
        has_damping = self.damping.nnz > 0
        for step in range(n_steps):
            before = increment
            increment = increments[step % STEPS_TOGETHER]
            numpy.subtract(before, self.update @ displacement, out=increment)
            if has_damping:
                increment -= self.damping @ before
            if self.power and (step + 1) % self.interval == 0:
                # of the mean of the velocities before and after, as MechanicalStep does
                short = before + increment
                for _ in range(self.power):
                    short = self.short_wave_part @ short
                increment -= 0.5 * self.fraction * short
            displacement += increment
            if (step + 1) % STEPS_TOGETHER == 0 or step + 1 == n_steps:
                n_together = step % STEPS_TOGETHER + 1
                spectrum += factors[step + 1 - n_together:step + 1] @ increments[:n_together]
        cuts = numpy.cumsum([2 * (last - first + 1) for _, first, last in self.chains])[:-1]
        return [[part.reshape(-1, 2) for part in numpy.split(field / self.time_step, cuts)]
                for field in (spectrum, increment)]


def amplitude(field, window):
    """Root of the weighted mean square of a field in a window."""
    return math.sqrt(window.weights @ (abs(field)**2).sum(axis=1))


def fit(field, window, modes, spacing):
    """The amplitudes at x = 0 of modes that together come nearest to a field in a window, and the
    root mean square of the rest."""
    roots = numpy.sqrt(window.weights)[:, None]
    x = spacing * window.columns
    basis = [roots * numpy.multiply.outer(numpy.exp(1j * mode.wave_number * x),
                                          mode.polarization) for mode in modes]
    basis = numpy.array(basis).reshape(len(modes), field.size).T
    target = (roots * field).reshape(-1)
    amplitudes = numpy.linalg.lstsq(basis, target, rcond=None)[0]
    return abs(amplitudes), numpy.linalg.norm(target - basis @ amplitudes)


def energy_flux(amplitudes, modes):
    """Density and energy per length are alike on both sides."""
    return sum(one**2 * abs(mode.group_velocity) for one, mode in zip(amplitudes, modes))


def measure_partial_waves(case, waves, layout, fields, result):
    """Decomposes the incident, the reflected and the transmitted wave into those of the
    lattices."""
    incident, reflected, transmitted = (
        fit(layout.within(field, window), window, modes, spacing) for field, window, modes, spacing
        in zip(fields, (layout.incident, layout.reflected, layout.transmitted),
               (waves.incident, waves.reflected, waves.transmitted),
               (case.left_spacing, case.left_spacing, case.right_spacing)))
    k_x = waves.carrier.wave_number
    carrier_amplitude = next((one for one, mode in zip(incident[0], waves.incident)
                              if abs(mode.wave_number - k_x) < 1e-6 * k_x and mode.type == case.wave), 0)
    flux = carrier_amplitude**2 * waves.carrier.group_velocity
    result.reflection = result.converted = 0
    for one, mode in zip(reflected[0] / carrier_amplitude, waves.reflected):
        if not mode.is_short:
            setattr(result, "reflection" if mode.type == case.wave else "converted", one)
    result.fit_error = reflected[1] / carrier_amplitude
    result.total = math.sqrt(energy_flux(reflected[0], waves.reflected) / flux)
    result.transmitted_energy = energy_flux(transmitted[0], waves.transmitted) / flux


def measure_fields(smoothing, layout, incident, reflected, result):
    """Compares the reflected wave as a whole with the incident one."""
    def ratio(one, other):
        return (amplitude(layout.within(one, layout.reflected), layout.reflected)
                / amplitude(layout.within(other, layout.incident), layout.incident))

    def smoothed(field):
        return (left_smoothing.matrix(1, len(field)) @ field.reshape(-1)).reshape(-1, 2)

    result.unsmoothed = ratio(reflected, incident)
    # Far from the interface v is v̂ smoothed by the left side's lattice in both runs.
    left_smoothing = smoothing.homogeneous(-1)
    result.smoothed = ratio(smoothed(reflected), smoothed(incident))


def send_burst(case, operators):
    """The result of a case, on the operators of its strip. Throws StudyError."""
    spacing = case.left_spacing
    wave_number = 2 * math.pi / case.wavelength
    k_x, k_y = wave_number * math.cos(case.angle), wave_number * math.sin(case.angle)
    time_step = case.step_factor * operators.stable_step
    reduced = operators.reduce(k_y)
    left_waves = LatticeWaves(reduced.update, -1, spacing, k_y, time_step)
    right_waves = LatticeWaves(reduced.update, 1, case.right_spacing, k_y, time_step)

    carrier = left_waves.mode(k_x, case.wave)
    result = ReflectionResult(
        time_step=time_step, frequency=carrier.frequency, group_velocity=carrier.group_velocity,
        phase_error=math.sqrt(carrier.eigenvalue) / (case.wave_speed() * wave_number) - 1)
    if carrier.group_velocity < SLOWEST * math.cos(case.angle):
        return result
    onward, back = left_waves.by_side(carrier.frequency)
    waves = PartialWaves(carrier, onward, back, right_waves.by_side(carrier.frequency)[0])

    layout = Layout(case, waves, time_step)
    with_interface = {name: getattr(reduced, name)
                      for name in ("update", "damping", "short_wave_part")}
    without = {name: operator.homogeneous(-1) for name, operator in with_interface.items()}
    filter_fraction = min(1, case.filter_strength * operators.filter_rate * case.filter_interval
                          * time_step)
    motion = Motion(case, filter_fraction, time_step,
                    [(with_interface, layout.first, layout.last),
                     (without, layout.first, layout.last_without)])
    (there, incident), last_velocities = motion.run(
        Burst(left_waves, carrier, layout.burst_begin, layout.burst_length), spacing,
        carrier.frequency, layout.n_steps)
    result.n_steps, result.n_columns = layout.n_steps, layout.last - layout.first + 1

    n_left = 1 - layout.first  # columns up to the interface
    reflected = there[:n_left] - incident[:n_left]
    last_reflected = last_velocities[0][:n_left] - last_velocities[1][:n_left]
    result.remaining = (abs(layout.within(last_reflected, layout.reflected)).max()
                        / math.sqrt(carrier.eigenvalue))
    measure_partial_waves(case, waves, layout, (incident, reflected, there), result)
    measure_fields(reduced.smoothing, layout, incident, reflected, result)
    if case.left == case.right == "FE" and abs(case.angle) < 1e-12:
        result.exact = exact_reflection(carrier.frequency, time_step, case.wave_speed(), spacing,
                                        case.right_spacing)
    return result
