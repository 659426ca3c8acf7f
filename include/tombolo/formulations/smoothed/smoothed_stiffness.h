// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/row_material.h>
#include <tombolo/formulations/smoothed/smoothed_gradients.h>

#include <functional>
#include <vector>

namespace tombolo
{
  /** Formulation::find_cell_equations() of smoothed cells: a cell acts on all neighbours of its
   * points. */
  template <int dim>
  void find_smoothed_equations(const SmoothedGradients<dim> &rows, const CellBatches<dim> &cells,
                               const RowMaterial &material, const MechanicalInput &input,
                               const std::function<void(const CellEquations &)> &take);

  /** Formulation::find_couplings() of @p n_cells smoothed cells. */
  template <int dim>
  void find_smoothed_couplings(const SmoothedGradients<dim> &rows, unsigned int n_cells,
                               const NodeGroupAction &use);
} // namespace tombolo
