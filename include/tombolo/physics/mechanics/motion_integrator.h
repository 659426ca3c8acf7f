// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/model/model.h>

namespace tombolo
{
  /** How positions and unsmoothed velocities follow the acceleration: a plug-in,
   * `Time step/Integrator`. */
  template <int dim>
  class MotionIntegrator
  {
  public:
    virtual ~MotionIntegrator() = default;

    /** From positions at t_n, unsmoothed velocities at t_{n-1/2} and the acceleration at t_n
     * (ghosts of all three and of the velocity are current) to positions at t_{n+1} and unsmoothed
     * velocities at t_{n+1/2}, with current ghosts. Collective. */
    virtual void advance(Model<dim> &model, const Clock &clock) = 0;

    /** Writes to a checkpoint, or reads from it, what is kept from step to step. Collective. */
    virtual void serialize(Model<dim> & /*model*/, StateArchive & /*archive*/) {}
  };

  template <int dim>
  struct PluginKind<MotionIntegrator<dim>>
  {
    static constexpr const char *name = "motion integrator";
  };
} // namespace tombolo
