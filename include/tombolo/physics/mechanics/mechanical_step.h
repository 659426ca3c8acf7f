// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/failure_agreement.h>
#include <tombolo/base/stopwatch.h>
#include <tombolo/model/assembly.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/mechanics/motion_integrator.h>

#include <memory>

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
    /** Declares entries of section "Time step". */
    static void declare_parameters(dealii::ParameterHandler &handler);

    /** With the integrator of section "Time step". Throws InputError. */
    MechanicalStep(Model<dim> &model, const Section &time_step);

    /** With central differences. */
    explicit MechanicalStep(Model<dim> &model);
    ~MechanicalStep();

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

    /** Writes to a checkpoint, or reads from it, what the steps so far leave to the next beside the
     * model. Collective. */
    void serialize(StateArchive &archive);

    /** Wall time of the phases of all steps on this rank. */
    const Stopwatch &times() const;

  private:
    void add_internal_force(const Clock &clock);
    void divide_by_mass(const Clock &clock);

    Model<dim> &model;
    Assembly<dim> assembly;
    std::unique_ptr<MotionIntegrator<dim>> integrator;
    FailureAgreement failures;
    Stopwatch stopwatch;
  };
} // namespace tombolo
