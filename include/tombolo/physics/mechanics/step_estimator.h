// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/registry.h>
#include <tombolo/model/model.h>
#include <tombolo/model/step_limit.h>

namespace tombolo
{
  /** A bound of the stable time step, before any safety factor: a plug-in, `Time step/Estimator`.
   */
  template <int dim>
  class StepEstimator
  {
  public:
    virtual ~StepEstimator() = default;

    /** The largest stable step at the present configuration, the same on all ranks, with the entity
     * that limits it. Uses and may keep information of earlier calls. Collective. */
    virtual StepLimit estimate(Model<dim> &model) = 0;

    /** Whether estimate() is cheap enough to be called at every look at the step size; otherwise it
     * is called when the configuration has changed by so much that it matters. */
    virtual bool is_cheap() const = 0;

    /** Writes to a checkpoint, or reads from it, what is kept of earlier calls. Collective. */
    virtual void serialize(StateArchive & /*archive*/, const Model<dim> & /*scene*/) {}
  };

  template <int dim>
  struct PluginKind<StepEstimator<dim>>
  {
    static constexpr const char *name = "step estimator";
  };

  /** The next number below with a short mantissa: what a different order of summation does to the
   * last digits of an estimate must not change the step. */
  double round_down(double step);

  /** eq. (41): the smallest ratio of characteristic length (an element's, or a particle's support)
   * to wave speed. Collective. */
  template <int dim>
  StepLimit courant_limit(const Model<dim> &model);
} // namespace tombolo
