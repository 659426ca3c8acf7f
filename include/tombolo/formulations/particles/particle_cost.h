// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/smoothing_settings.h>
#include <tombolo/formulations/particles/kernel_configuration.h>

namespace tombolo
{
  /** The cost of a momentum-consistent particle in a step, without that of its material, in the
   * units of StepCost, for a cell whose box along the axes is @p box_ratio times as large as it. */
  template <int dim>
  double particle_cost_per_cell(const SmoothingSettings &smoothing,
                                const KernelConfiguration<dim> &kernel, double dilation,
                                double box_ratio);
} // namespace tombolo
