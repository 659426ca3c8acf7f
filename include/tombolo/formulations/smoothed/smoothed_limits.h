// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/formulation.h>

#include <vector>

namespace tombolo
{
  /** The smallest of @p time_steps, by cell, of the cells that are there, times the root of the
   * factor of its inertia (none: one), and where it is. */
  template <int dim>
  StepLimit
  smoothed_step_limit(const CellBatches<dim> &cells, const std::vector<double> &time_steps,
                      const std::vector<double> &inertia_factors, const NodalVector &position);

  /** Formulation::diffusion_limit() of cells with this diffusivity [L^2/T]: the shortest distance
   * between two corners counts. */
  template <int dim>
  StepLimit smoothed_diffusion_limit(const CellBatches<dim> &cells, double diffusivity,
                                     const NodalVector &position);
} // namespace tombolo
