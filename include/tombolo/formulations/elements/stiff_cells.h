// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/formulation.h>

#include <functional>
#include <string>
#include <vector>

namespace tombolo
{
  /** What a cell adds to the linear equations of a static step. */
  struct CellEquations
  {
    std::vector<unsigned int> nodes; ///< local numbers
    /** ∂f/∂x of the internal force f of the cell (that of eq. (16) with the sign of +K) with the
     * positions at the end of the step, row by row; component d of node k is row and column
     * dim k + d. */
    std::vector<double> matrix;
    std::vector<double> force; ///< f, by component of each node
  };

  /** Is given groups of local node numbers. */
  using NodeGroupAction = std::function<void(const std::vector<unsigned int> &)>;

  /** A part whose cells know how their forces change with the motion of the step: what implicit
   * steps need. */
  template <int dim>
  class StiffCells
  {
  public:
    virtual ~StiffCells() = default;

    /** Hands over the equations of each present cell for the motion of @p input, from material
     * points as they are at the start of the step. Afterwards the points are in no state of use:
     * within a Trial, which is restarted next. Ghosts of the input are current. Not collective. */
    virtual void find_cell_equations(const MechanicalInput &input,
                                     const std::function<void(const CellEquations &)> &take) = 0;

    /** Calls @p use with groups of nodes that act on each other, beside those of each cell of the
     * mesh: local numbers. */
    virtual void find_couplings(const NodeGroupAction & /*use*/) const {}

    /** What the part has that has no meaning in a static step, for a message; empty: nothing. */
    virtual std::string unfit_for_statics() const = 0;
  };
} // namespace tombolo
