// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/base/log.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/mechanics/step_size.h>

namespace tombolo
{
  /**
   * Before the first step of a scene with mechanics: warns of what will hardly be meant, and
   * advises settings from which this scene would profit, each with the number of a page of doc
   * that decides it.
   *
   * Warnings: a given step above the limit, conditions that prescribe different motions of one
   * node, contacts whose surface will not come near before @p end_time, an end before a wave has
   * crossed the body, and wave speeds that no solid has where `Unit labels` names the units.
   *
   * Advice: gradients that pass the patch test, another smoothing or step, scaled
   * inertia, longer steps of large cells. A scene with an exact solution compares methods and gets
   * no advice about its settings.
   *
   * Bodies at rest have no waves, no stable step and no smoothing of velocities, and get none of
   * the sentences about them. @p n_steps are those expected. Collective.
   */
  template <int dim>
  void print_advice(const Model<dim> &model, const StepSize<dim> &step_size,
                    const Parameters &parameters, double end_time, double n_steps, Log &log);

  /** The stable step of bodies and contacts in the present state by the spectral estimate with its
   * defaults, whichever the scene uses [T]. Collective. */
  template <int dim>
  double spectral_limit(const Model<dim> &model);

  /** Warns of what processes have to say now. Collective. */
  template <int dim>
  void print_warnings(const Model<dim> &model, const Clock &clock,
                      typename Process<dim>::Occasion occasion, Log &log);
} // namespace tombolo
