# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a step moves and computes by the layout of the data: bytes and operations for each cell or
particle.

Every array counts once for each sweep that reads it and once for each that writes it; values of
neighbours that a sweep gathers count once a node, since the next particles or cells find them in
the caches; that a write fetches the line first is not counted, as it is not in the measured
bandwidth. What a block of cells or particles uses twice in a row counts once.
"""

from dataclasses import dataclass

VECTOR = 4 * 8  # a nodal vector: three components and a pad
NUMBER = 8
INDEX = 4
GRADIENT = 3 * 8
MATRIX = 3 * VECTOR
STRESS = 6 * 8

UPDATE = 2  # read and written
CORNERS = 8  # of a cell, and cells around a particle


@dataclass
class Rows:
    """Shape functions: neighbours a particle, and whether rows share their coefficients. Shared
    ones stay in the caches."""
    neighbours: float
    are_shared: bool = False

    def pointers(self):
        """Where the row and its coefficients begin, its particle and its neighbours."""
        return 2 * NUMBER + INDEX + INDEX * self.neighbours

    def values(self):
        return 0 if self.are_shared else NUMBER * self.neighbours

    def gradients(self):
        return 0 if self.are_shared else GRADIENT * self.neighbours


def acceleration():
    """Force set to zero; force and mass to acceleration."""
    return VECTOR + 3 * VECTOR


def element_motion():
    """A copy of the velocity; number, share and acceleration, velocity; v and x updated."""
    return 2 * VECTOR + INDEX + 3 * VECTOR + 2 * UPDATE * VECTOR


def points(n_points, n_variables):
    """Stress, volume ratio and the material's variables updated, the volume written."""
    return n_points * (UPDATE * (STRESS + NUMBER + n_variables * NUMBER) + NUMBER)


def cell_force(n_points, n_variables, n_element_variables, n_nodes=8):
    """Node numbers; position and velocity gathered, force added, of one node a cell; points."""
    return (INDEX * n_nodes + 2 * VECTOR + UPDATE * VECTOR + points(n_points, n_variables)
            + UPDATE * NUMBER * n_element_variables)


def momentum_to_velocity():
    return 3 * VECTOR


def particle_force(rows, n_variables, has_inverse):
    """Velocity, and position or F⁻¹ as the affine smoothing has left it; gradients; points with
    their initial volume; force added."""
    return (rows.pointers() + rows.gradients() + VECTOR + (MATRIX if has_inverse else VECTOR)
            + points(1, n_variables) + NUMBER + UPDATE * VECTOR)


def cell_row(rows):
    """Where the row of a cell and its coefficients begin, its first node and its nodes."""
    return Rows(CORNERS).pointers() + Rows(CORNERS, rows.are_shared).gradients()


def cell_dilatation(rows):
    """Of one cell a particle: position gathered, cofactors and J_c written; its share in the J_I
    of particles, and their pressures in it; then its force, with its volume."""
    shares = INDEX + CORNERS * (INDEX + NUMBER)
    ratios = cell_row(rows) + VECTOR + MATRIX + NUMBER + shares + 3 * NUMBER
    pressures = 3 * NUMBER + shares + UPDATE * NUMBER
    return ratios + pressures + cell_row(rows) + MATRIX + 4 * NUMBER + UPDATE * VECTOR


def zero_energy_control(rows, flows):
    """Position gathered with φ, volume and length, energy updated; slip and loss where something
    flows."""
    return VECTOR + rows.values() + 2 * NUMBER + UPDATE * NUMBER * (5 if flows else 1)


def paper_motion(rows):
    """Momentum set to zero; acceleration and velocity gathered with φ, share and mass of the row,
    v̂ and x updated, momentum added; then velocity from momentum."""
    return (VECTOR + rows.pointers() + rows.values() + 4 * VECTOR + 3 * UPDATE * VECTOR
            + momentum_to_velocity())


def affine_smoothing(rows):
    """Momentum set to zero; position, velocity and mass of the row, F⁻¹ written, momentum added;
    then velocity from momentum."""
    return (VECTOR + rows.pointers() + rows.values() + rows.gradients() + 3 * VECTOR + MATRIX
            + UPDATE * VECTOR + momentum_to_velocity())


def affine_motion(rows):
    """Momentum set to zero; position, acceleration, mass of the row and F⁻¹, momentum added; over
    the mass; v̂ and x updated."""
    return (VECTOR + rows.pointers() + rows.values() + rows.gradients() + 3 * VECTOR + MATRIX
            + UPDATE * VECTOR + (2 * VECTOR + NUMBER) + 2 * (UPDATE * VECTOR + VECTOR))


def rebuilding(rows):
    """Position and support read, coefficients written; the smoothed mass from them."""
    own = Rows(rows.neighbours)
    return (own.pointers() + 2 * VECTOR + own.values() + own.gradients()
            + VECTOR + own.pointers() + own.values() + 2 * VECTOR + UPDATE * VECTOR)


# Operations, pads of vectors included, since the processor counts them. Those of cells and points
# were counted by `perf stat` on this code; those of sweeps over rows follow from their loops.
LANES = 4
KINEMATICS = 330       # of a point: increments of strain and rotation, stress rotated
JOHNSON_COOK = 860     # of a point that flows: Newton steps with powers and logarithms
ONE_POINT_CELL = 1350
FULLY_INTEGRATED_CELL = 4800
NODAL_UPDATE = 8 * LANES


def gradient_operations(rows, with_deformation):
    """Differences to the own value times the components of ∇φ, of v and where requested of x."""
    return rows.neighbours * 7 * LANES * (2 if with_deformation else 1)


def affine_smoothing_operations(rows):
    return gradient_operations(rows, True) + rows.neighbours * (3 + 8 * LANES) + 100


def affine_motion_operations(rows):
    return rows.neighbours * (3 + 8 * LANES + 7 * LANES) + 80


def cell_dilatation_operations():
    """F_c, its cofactors and J_c, shares twice, the force."""
    return CORNERS * (7 * LANES + 2 + 2 + 6 * LANES) + 60


def zero_energy_control_operations(rows):
    """Residual and force."""
    return rows.neighbours * 4 * LANES + 30


def paper_motion_operations(rows):
    return rows.neighbours * 6 * LANES


def particle_force_operations(rows, has_inverse):
    return gradient_operations(rows, not has_inverse) + rows.neighbours * 6 * LANES + KINEMATICS


def rebuilding_operations(rows):
    """Kernel and its gradient, moments, a small inverse, φ and ∇φ; the smoothed mass."""
    return rows.neighbours * 195 + 300


@dataclass
class Step:
    """A step of one cell or particle."""
    bytes: float
    flops: float


def element_step(n_points, n_variables, n_element_variables, cell_flops):
    plastic = n_points * JOHNSON_COOK if n_variables else 0
    return Step(acceleration() + element_motion()
                + cell_force(n_points, n_variables, n_element_variables),
                NODAL_UPDATE + cell_flops + plastic)


def particle_step(rows, n_variables, smoothing, rebuilds=False):
    is_affine = smoothing == "affine"
    moved = acceleration() + particle_force(rows, n_variables, is_affine)
    operations = (NODAL_UPDATE + particle_force_operations(rows, is_affine)
                  + (JOHNSON_COOK if n_variables else 0))
    if is_affine:
        moved += affine_smoothing(rows) + affine_motion(rows)
        operations += affine_smoothing_operations(rows) + affine_motion_operations(rows)
        if not rebuilds:  # cell averages, which have the dilatation of cells
            moved += cell_dilatation(rows) + zero_energy_control(rows, n_variables > 0)
            operations += cell_dilatation_operations() + zero_energy_control_operations(rows)
    else:
        moved += paper_motion(rows)
        operations += paper_motion_operations(rows)
    if rebuilds:
        moved += rebuilding(rows)
        operations += rebuilding_operations(rows)
    return Step(moved, operations)
