// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/failure_agreement.h>
#include <tombolo/base/stopwatch.h>
#include <tombolo/model/assembly.h>
#include <tombolo/model/forces_while_waiting.h>
#include <tombolo/model/model.h>

namespace tombolo
{
  /**
   * Explicit central differences, eqs (22)-(25) and, at shared nodes, (52)-(56): with the bridge's
   * Φ and its sharpened form Φ_γ (I where there are elements only),
   *
   * @verbatim
   *   v̂ += Δt_n Φ_γ a
   *   x += Δt Φ (v + Δt_n a)
   * @endverbatim
   *
   * Affine smoothing differs from eq. (25): x += Δt v̂. Angular momentum is Σ x × m̂ v̂, and of all
   * increments only v̂ itself (or a self-adjoint operator on it that keeps linear fields, which
   * costs twice the smoothing) changes x without changing it and carries a rigid rotation exactly.
   */
  template <int dim>
  class CentralDifferences
  {
  public:
    /** From positions at t_n, unsmoothed velocities at t_{n-1/2} and the acceleration at t_n
     * (ghosts of all three and of the velocity are current) to positions at t_{n+1} and unsmoothed
     * velocities at t_{n+1/2}, with current ghosts. Collective. */
    void advance(Model<dim> &model, const Clock &clock);

  private:
    NodalVector rate, field; // scratch, where velocities are sharpened
  };

  /**
   * Algorithm 1 of Pan et al. 2019 (doc/method.md, section 5) around the time t_n: forces, then,
   * when the size of the coming step is set, the acceleration with its constraints, then motion.
   * After complete() the state is that of t_n (stress, position, acceleration) and can be read.
   */
  template <int dim>
  class MechanicalStep
  {
  public:
    explicit MechanicalStep(Model<dim> &model);

    /** From positions at t_n and velocities at t_{n-1/2} to the acceleration at t_n. Returns the
     * change of the model. Throws RunError on all ranks when a value stopped being finite, one step
     * after it did. Collective. */
    ModelChange evaluate(const Clock &clock);

    /** Prescribes motion and accounts for the step; the size of the coming step must be set.
     * Collective. */
    void complete(const Clock &clock);

    /** From t_n to t_{n+1}. Collective. */
    void advance(const Clock &clock);

    /** Throws the RunError of a failure found in the step last evaluated, without waiting for the
     * next. Collective. */
    void check_now()
    {
      failures.end();
    }

    /** Wall time of the phases of all steps on this rank. */
    const Stopwatch &times() const
    {
      return stopwatch;
    }

  private:
    /** Smooths the velocities, and finds forces that need no smoothed ones while these travel. */
    void smooth_velocity(const Clock &clock);
    /** Adds the other forces of the parts. */
    void add_internal_force(const Clock &clock);
    /** Calls @p add_force, which adds forces of a part, and notes its failure. */
    void evaluate_part(std::size_t number, const Clock &clock,
                       const std::function<void()> &add_force);
    void divide_by_mass(const Clock &clock);

    Model<dim> &model;
    Assembly<dim> assembly;
    ForcesWhileWaiting<dim> forces_while_waiting;
    CentralDifferences<dim> differences;
    FailureAgreement failures;
    Stopwatch stopwatch;
  };
} // namespace tombolo
