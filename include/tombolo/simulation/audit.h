#pragma once

#include <tombolo/output/log.h>
#include <tombolo/simulation/scene.h>
#include <tombolo/simulation/step_size.h>
#include <tombolo/simulation/thermal_step.h>

namespace tombolo
{
  /** Prints what a scene is, before its first step: nodes by label, cells, particles, neighbours,
   * mass, extent, wave speeds, the time step and what limits it, the number of steps and the
   * memory, the balance of the ranks, and what the mesh's source has remarked. @p thermal_step is
   * null in scenes without heat. Collective. */
  template <int dim>
  void print_audit(Scene<dim> &scene, StepSize<dim> &step_size, ThermalStep<dim> *thermal_step,
                   double end_time, Log &log);
} // namespace tombolo
