// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/formulation.h>

namespace tombolo
{
  /** Formulation::diffusion_limit() of cells with this diffusivity [L^2/T]: the shortest distance
   * between two corners counts. */
  template <int dim>
  StepLimit smoothed_diffusion_limit(const CellBatches<dim> &cells, double diffusivity,
                                     const NodalVector &position);
} // namespace tombolo
