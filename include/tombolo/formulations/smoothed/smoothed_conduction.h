// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/smoothed/smoothed_gradients.h>
#include <tombolo/materials/temperature_table.h>
#include <tombolo/state/nodal_vector.h>

namespace tombolo
{
  /** Formulation::add_conduction() of smoothed cells: -Σ_q V_q k ∇θ · ∇φ with the gradients of @p
   * rows carried to the present @p position, and k at the mean of the corners of each point. */
  template <int dim>
  void add_smoothed_conduction(const SmoothedGradients<dim> &rows, const CellBatches<dim> &cells,
                               const TemperatureTable &conductivity, const NodalVector &position,
                               const NodalVector &of_conductivity, const NodalVector &temperature,
                               NodalVector &heat_rate);
} // namespace tombolo
