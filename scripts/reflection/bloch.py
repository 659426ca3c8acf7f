# SPDX-License-Identifier: LGPL-2.1-or-later
"""Operators on an endless chain of columns with two complex unknowns each: what Bloch's theorem
makes of a plane lattice with an interface at column 0."""

import numpy
import scipy.sparse


class BlochOperator:
    """`blocks[source - first, target - source + reach]` is the 2 x 2 block by which a source column
    acts on a target. Columns before the first source are as it is, shifted, and those after the
    last as that one."""

    def __init__(self, blocks, first):
        self.blocks, self.first = blocks, first
        self.last, self.reach = first + len(blocks) - 1, blocks.shape[1] // 2

    def at(self, sources):
        """Blocks by source and offset of the target."""
        return self.blocks[numpy.clip(sources, self.first, self.last) - self.first]

    def largest_entry(self):
        return max(abs(self.blocks.real).max(), abs(self.blocks.imag).max())

    def without_round_off(self, tolerance):
        """Without outer columns of the reach in which all entries are below the tolerance times the
        largest one, and with zeros for real and imaginary parts below it."""
        threshold = tolerance * self.largest_entry()
        real, imaginary = (numpy.where(abs(part) > threshold, part, 0)
                           for part in (self.blocks.real, self.blocks.imag))
        blocks = real + 1j * imaginary
        offsets = numpy.flatnonzero(blocks.any(axis=(0, 2, 3))) - self.reach
        needed = abs(offsets).max(initial=0)
        kept = slice(self.reach - needed, self.reach + needed + 1)
        return BlochOperator(blocks[:, kept], self.first)

    def __matmul__(self, other):
        """This one after the other."""
        # A source is far to a side if all that it acts on is.
        first = min(other.first, self.first - other.reach)
        last = max(other.last, self.last + other.reach)
        sources = numpy.arange(first, last + 1)
        before = other.at(sources)
        width = 2 * self.reach + 1
        blocks = numpy.zeros((len(sources), width + 2 * other.reach, 2, 2), complex)
        for k in range(2 * other.reach + 1):
            blocks[:, k:k + width] += self.at(sources + k - other.reach) @ before[:, k, None]
        return BlochOperator(blocks, first)

    def homogeneous(self, side):
        """Everywhere as far to a side, -1 or 1."""
        source = self.first if side < 0 else self.last
        return BlochOperator(self.at(numpy.array([source])), 0)

    def symbol(self, phases):
        """The matrices of its action on p exp(i phase j) (j: number of the column), by phase, where
        it is everywhere alike."""
        offsets = numpy.arange(-self.reach, self.reach + 1)
        factors = numpy.exp(-1j * numpy.multiply.outer(phases, offsets))
        return numpy.tensordot(factors, self.blocks[0], axes=1)

    def matrix(self, first, last):
        """Sparse, of the unknowns of columns first ... last in their order, cut off at both
        ends."""
        n_columns = last - first + 1
        blocks = self.at(numpy.arange(first, last + 1))
        source, offset, to, of = numpy.nonzero(blocks)
        target = source + offset - self.reach
        is_inside = (target >= 0) & (target < n_columns)
        indices = (2 * target + to)[is_inside], (2 * source + of)[is_inside]
        values = blocks[source, offset, to, of][is_inside]
        return scipy.sparse.csr_matrix((values, indices), shape=(2 * n_columns, 2 * n_columns))
