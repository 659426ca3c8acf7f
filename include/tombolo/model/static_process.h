// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/contact/contact_stiffness.h>
#include <tombolo/state/nodal_vector.h>

#include <vector>

namespace tombolo
{
  template <int dim>
  class Model;

  /**
   * A process, beside those whose forces have no memory, that can act in steps of bodies at rest: a
   * contact. What Process::add_forces() does to it is a trial there: it can be asked again from the
   * state at the start of the step, at other positions. A trial that is not restarted is committed
   * by the begin of the next.
   *
   * The clock of these functions has in `stable_step` the time of which its springs are made, and
   * in `previous_step` the length of the step, zero at the start of the run.
   */
  template <int dim>
  class StaticProcess
  {
  public:
    virtual ~StaticProcess() = default;

    /** From now on its steps are static: nothing resists rates, and what is apart by less than @p
     * tolerance [L] touches. */
    virtual void become_static(double tolerance) = 0;

    /** Keeps the state at the start of a step. Collective. */
    virtual void begin_trial(Model<dim> &model, const Clock &clock) = 0;

    /** Goes back to it. */
    virtual void restart_trial() = 0;

    /** Adds how the forces of the last evaluation change, with nodes that this rank owns. Each
     * place stands on one rank. Collective. */
    virtual void find_stiffness(const Model<dim> &model, const Clock &clock,
                                std::vector<ContactStiffness<dim>> &result) = 0;

    /** Adds to owned nodes of @p sums a bound of its stiffness, whatever touches, as a diagonal
     * matrix. */
    virtual void add_stiffness_bound(const Model<dim> &model, const Clock &clock,
                                     NodalVector &sums) = 0;
  };
} // namespace tombolo
