// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/log.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/heat/thermal_step.h>
#include <tombolo/physics/mechanics/step_size.h>
#include <tombolo/physics/statics/static_steps.h>

namespace tombolo
{
  /** Prints the size of a model before its first step: nodes by label, cells, particles,
   * neighbours, mass, extent, wave speeds, the time step and what limits it, the number of steps
   * and the memory, the balance of the ranks, and the remarks of the reader of the mesh. @p
   * thermal_step is null in models without heat, @p statics where steps are explicit; @p
   * bytes_before were allocated before the model was built. Returns how many steps are expected.
   * Collective. */
  template <int dim>
  double print_audit(const Model<dim> &model, StepSize<dim> &step_size,
                     ThermalStep<dim> *thermal_step, const StaticSteps<dim> *statics,
                     double end_time, std::size_t bytes_before, Log &log);
} // namespace tombolo
