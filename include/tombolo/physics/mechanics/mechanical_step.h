// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/failure_agreement.h>
#include <tombolo/base/stopwatch.h>
#include <tombolo/model/assembly.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/mechanics/central_differences.h>

namespace tombolo
{
  /**
   * Algorithm 1 of Pan et al. 2019 (doc/method.md, section 5) around the time t_n: forces, then,
   * when the size of the coming step is known, the acceleration with its constraints, then motion.
   * After complete() the state is that of t_n (stress, position, acceleration) and can be looked
   * at.
   */
  template <int dim>
  class MechanicalStep
  {
  public:
    explicit MechanicalStep(Model<dim> &model);

    /** From positions at t_n and velocities at t_{n-1/2} to the acceleration at t_n. Returns what
     * has changed in the model. Throws RunError on all ranks when a value stopped being finite, one
     * step after it did. Collective. */
    ModelChange evaluate(const Clock &clock);

    /** Prescribes motion and accounts for the step; the size of the coming step must be known.
     * Collective. */
    void complete(const Clock &clock);

    /** From t_n to t_{n+1}. Collective. */
    void advance(const Clock &clock);

    /** Throws the RunError of a failure found in the step last evaluated, without waiting for the
     * next. Collective. */
    void check_now();

    /** Wall time of the phases of all steps on this rank. */
    const Stopwatch &times() const;

  private:
    void add_internal_force(const Clock &clock);
    void divide_by_mass(const Clock &clock);

    Model<dim> &model;
    Assembly<dim> assembly;
    CentralDifferences<dim> differences;
    FailureAgreement failures;
    Stopwatch stopwatch;
  };
} // namespace tombolo
