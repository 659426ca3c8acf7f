// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>

namespace tombolo
{
  /**
   * Evaluations of forces that are not to be steps. From its construction on, what an evaluation
   * does to the material points of a model (stress, internal variables, accounted energies) is a
   * trial: restart() goes back to the committed state, so that a residual can be evaluated again at
   * another motion, and commit() keeps the last evaluation. A trial that was not committed is
   * undone by its destructor. An explicit step has no trial: it commits directly, at no cost.
   *
   * Positions, velocities and forces of nodes are the caller's.
   */
  template <int dim>
  class Trial
  {
  public:
    /** @p model must outlive this. */
    explicit Trial(const Model<dim> &model) : model(model)
    {
      for (const Part<dim> &part : model.parts)
        part.formulation->points().begin_trial();
    }

    ~Trial()
    {
      if (is_committed)
        return;
      restart();
      end();
    }

    Trial(const Trial &) = delete;
    Trial &operator=(const Trial &) = delete;

    void restart()
    {
      for (const Part<dim> &part : model.parts)
        part.formulation->points().restart_trial();
    }

    void commit()
    {
      is_committed = true;
      end();
    }

  private:
    void end()
    {
      for (const Part<dim> &part : model.parts)
        part.formulation->points().commit_trial();
    }

    const Model<dim> &model;
    bool is_committed = false;
  };
} // namespace tombolo
