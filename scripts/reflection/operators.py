# SPDX-License-Identifier: LGPL-2.1-or-later
"""The linear update of small motion across a plane interface, from the operators of a strip that
the program applies to unit vectors."""

import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy

from tombolo.errors import TomboloError
from tombolo.parameter_file import InputError
from tombolo.scene import find_program
from .bloch import BlochOperator

ROUND_OFF = 1e-11


class StudyError(TomboloError):
    """The study cannot go on."""


def require(condition, message):
    if not condition:
        raise StudyError(message)


class Probes:
    """The program's operators of strips, in files of a directory, which several processes of the
    program write. `failures` has, by strip, the error of those that the program refuses. Only reads
    the scenes where `validates` is true."""

    def __init__(self, strips, directory, n_processes, validates=False):
        self.directory, self.failures = Path(directory), {}
        self.names = {strip: f"strip_{number}"
                      for number, strip in enumerate(dict.fromkeys(strips), 1)}
        for strip, name in self.names.items():
            (self.directory / f"{name}.prm").write_text(strip.scene, "utf-8")
        program = find_program("strip_operators", "TOMBOLO_STRIP_OPERATORS")
        calls = []
        for start in range(min(n_processes, len(self.names))):
            mine = list(self.names)[start::n_processes]
            scenes = [f"{self.names[strip]}.prm" for strip in mine]
            calls.append((mine, subprocess.Popen(
                [program, *["--validate"] * validates, *scenes], cwd=directory, text=True,
                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)))
        for mine, process in calls:
            words = process.communicate()[1].strip()
            if process.returncode:
                self.note_failure(mine, process.returncode, words)

    def note_failure(self, strips, code, words):
        """Of the strip that the program names, or else the first that it did not write."""
        failed = next((strip for strip in strips if f"{self.names[strip]}.prm" in words), None)
        failed = failed or next(strip for strip in strips if not self.file(strip).exists())
        kind = InputError if code == 1 else StudyError
        self.failures[failed] = kind(
            words.removeprefix("Error: ").removeprefix("The probing stopped: "))

    def file(self, strip):
        return self.directory / f"{self.names[strip]}.operators"


@dataclass
class ReducedOperators:
    """For fields that vary as exp(i k_y y) along the interface; the unknowns of a column are the
    components of displacement or velocity of its nodes."""
    smoothing: BlochOperator  # S
    stiffness: BlochOperator  # M⁻¹ K, and the trace bridge's field on both sides of K [1/T^2]
    interpolation: BlochOperator  # the adjoint of S, as chosen
    short_wave_part: BlochOperator  # T = I - ΦS of the lattice filter
    update: BlochOperator  # A = interpolation · stiffness · smoothing [1/T^2]
    damping: BlochOperator  # interpolation · M⁻¹ C · smoothing of artificial viscosity [1/T]


class StripOperators:
    """Of a strip: `stable_step`, `filter_rate` (c/h of the particles), `masses` (m̂, and m in x and
    y) by column, and the responses to unit vectors."""

    def __init__(self, strip, file):
        self.strip = strip
        numbers = numpy.fromfile(file)
        n_nodes, n_probed = (int(number) for number in numbers[:2])
        self.stable_step, self.filter_rate = numbers[2:4]
        parts = numpy.split(numbers[4:], numpy.cumsum([2 * n_nodes, 3 * n_nodes, n_probed]))
        index = self.lattice_indices(parts[0].reshape(-1, 2))
        shape = 2 * strip.n_columns + 1, strip.n_rows + 1
        nodes = numpy.empty(shape, int)
        nodes[index[:, 0], index[:, 1]] = numpy.arange(n_nodes)
        self.masses = parts[1].reshape(-1, 3)[nodes[:, strip.middle]]
        sources = numpy.argsort(index[parts[2].astype(int), 0])
        require(len(sources) == 2 * strip.n_probed + 1,
                "The strip has not the nodes that were to be probed.")
        responses = parts[3].reshape(5, n_probed, 2, n_nodes, 2)[:, sources][:, :, :, nodes]
        (self.smoothing, self.interpolation, self.short_wave_part, self.stiffness,
         damped) = map(self.near, responses)
        self.viscosity = damped - self.stiffness
        for near in (self.smoothing, self.interpolation, self.short_wave_part, self.stiffness):
            self.check_far_columns(near)

    def lattice_indices(self, position):
        """Column (from 0) and row of each node."""
        case, strip = self.strip.case, self.strip
        x, y = position.T
        column = numpy.where(x < 0, x / case.left_spacing, x / case.right_spacing)
        index = numpy.stack([column, y / case.row_spacing], axis=1)
        whole = numpy.rint(index)
        n_lattice_nodes = (2 * strip.n_columns + 1) * (strip.n_rows + 1)
        require(abs(index - whole).max() < 1e-6
                and len(numpy.unique(whole, axis=0)) == len(index) == n_lattice_nodes,
                "The nodes of the strip are no lattice.")
        return whole.astype(int) + (strip.n_columns, 0)

    def near(self, responses):
        """The responses [source, component, offset of column, offset of row, component] within the
        reach of an operator."""
        strip, reach = self.strip, self.strip.reach
        magnitudes = abs(responses).max(axis=(1, 4))
        rows = slice(strip.middle - reach, strip.middle + reach + 1)
        near = []
        for number in range(2 * strip.n_probed + 1):
            source = strip.n_columns - strip.n_probed + number
            columns = slice(source - reach, source + reach + 1)
            near.append(responses[number, :, columns, rows])
            largest = magnitudes[number].max()
            magnitudes[number, columns, rows] = 0
            require(magnitudes[number].max() <= ROUND_OFF * largest,
                    "An operator reaches farther than its strip was made for.")
        return numpy.array(near)

    @staticmethod
    def check_far_columns(responses):
        difference = max(abs(responses[0] - responses[1]).max(),
                         abs(responses[-1] - responses[-2]).max())
        require(difference <= ROUND_OFF * max(abs(responses[0]).max(), abs(responses[-1]).max()),
                "The outer columns of the strip see its ends or the interface.")

    def reduce_one(self, responses, wave_number):
        offsets = numpy.arange(-self.strip.reach, self.strip.reach + 1)
        factors = numpy.exp(-1j * wave_number * offsets * self.strip.case.row_spacing)
        blocks = numpy.einsum("socrt,r->scto", responses, factors)
        return BlochOperator(blocks, -self.strip.n_probed).without_round_off(1e-14)

    def reduce(self, wave_number):
        """Bloch's reduction to a wave number along the interface [1/L]."""
        smoothing, stiffness, viscosity, interpolation, short_wave_part = (
            self.reduce_one(responses, wave_number) for responses in (
                self.smoothing, self.stiffness, self.viscosity, self.interpolation,
                self.short_wave_part))
        damping = interpolation @ (viscosity @ smoothing)
        # Without viscosity nothing but the round-off of a difference is left.
        has_viscosity = damping.largest_entry() > 1e-10 * stiffness.largest_entry()**0.5
        return ReducedOperators(smoothing, stiffness, interpolation, short_wave_part,
                                (interpolation @ (stiffness @ smoothing)).without_round_off(1e-14),
                                damping.without_round_off(1e-14 if has_viscosity else 2))
