// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/boundary/condition_balance.h>
#include <tombolo/boundary/load_sum.h>
#include <tombolo/model/impulse_account.h>

#include <array>
#include <vector>

namespace tombolo
{
  struct ConstraintReaction;
  template <int dim>
  class Model;

  /** Impulses and works of mechanical conditions, by their number: shares of this rank since the
   * start. */
  template <int dim>
  class ConditionAccounts
  {
  public:
    /** Of those that prescribe motion, or of the loads. */
    ConditionAccounts(const Model<dim> &model, bool of_prescribed_motion);

    /** The impulses of the last step count from now on; those that follow are of the interval
     * around t_n, which began at @p time_of_impulse = t_{n-1/2}. */
    void begin_step(double time_of_impulse);

    /** Adds the impulse of the reaction along a component at @p position, in the step at hand. */
    void add_impulse(unsigned int condition, unsigned int component, const double *position,
                     double impulse);
    /** Adds the impulses of loads over @p interval, in the step at hand. */
    void add_loads(const std::vector<LoadSum> &loads, double interval);
    /** Adds a moment of impulses in the step at hand. */
    void add_moment(unsigned int condition, const std::array<double, 3> &moment);
    void add_work(unsigned int condition, double work);
    /** Adds what counts at once. */
    void add_now(unsigned int condition, const ConstraintReaction &reaction);

    /** In the order of the conditions. Collective. */
    std::vector<ConditionBalance> balances() const;

    /** Lists what is kept from step to step. */
    void list(Records &records);

  private:
    struct Account
    {
      bool is_kept; ///< the others are of the other kind
      ImpulseAccount impulses;
      double work = 0;
    };

    /** Sums of x - X over the nodes that each condition prescribes, and their number. */
    std::vector<std::array<double, 4>> displacements() const;

    const Model<dim> &model;
    bool of_prescribed_motion;
    std::vector<Account> accounts; ///< by number of the condition
    double time_of_impulse = 0;
  };
} // namespace tombolo
