// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/sub_cells.h>
#include <tombolo/state/nodal_vector.h>

#include <array>
#include <vector>

namespace tombolo
{
  /** A symmetric matrix of nodes that is a sum over cells, with numbers on the diagonal beside. It
   * acts on all slots of a vector alike. */
  template <int dim>
  class CellMatrices
  {
  public:
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;

    /** With room for so many cells. */
    CellMatrices(const std::shared_ptr<const NodePartition> &partition, std::size_t n_cells);

    /** @p nodes are local numbers; of the @p matrix the lower triangle is taken. */
    void add_cell(const std::array<unsigned int, n_corners> &nodes,
                  const std::array<double, n_corners * n_corners> &matrix);

    /** Scalar, at owned nodes. */
    NodalVector diagonal;

    /** Owned values of A @p direction, whose ghosts are updated. Collective. */
    void apply(NodalVector &direction, NodalVector &result) const;

    /** The diagonal of the matrices of the cells, scalar, at owned nodes. Collective. */
    NodalVector diagonal_of_cells() const;

    /**
     * Solves A @p solution = @p right_side at the owned nodes where @p preconditioner (scalar) is
     * positive, by conjugate gradients that it preconditions as a diagonal; elsewhere the solution
     * stays. Ends where each slot of the residual has fallen to @p tolerance of what it would be
     * for no solution, or falls no more. Ghosts of the solution are updated. Returns the number of
     * iterations. Collective.
     */
    unsigned int solve(const NodalVector &right_side, const NodalVector &preconditioner,
                       double tolerance, NodalVector &solution) const;

  private:
    std::shared_ptr<const NodePartition> partition;
    std::vector<std::array<unsigned int, n_corners>> nodes_of_cells;
    std::vector<std::array<double, n_corners *(n_corners + 1) / 2>> matrices; // lower triangles
  };
} // namespace tombolo
