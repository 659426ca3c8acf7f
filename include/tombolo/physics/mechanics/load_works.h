// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/boundary/mechanical_condition.h>
#include <tombolo/physics/mechanics/condition_accounts.h>
#include <tombolo/state/nodal_vector.h>

#include <array>
#include <vector>

namespace tombolo
{
  /**
   * The works of single loads where a scene has several; those of all together are the external
   * work that Loads accounts for. The work of a condition in the step from t_{n-1} to t_n is
   * ½ (Δt_{n-1} f_{n-1} + Δt_n f_n) · u_{n-1/2}, with its forces f at places and their velocity u =
   * Φ v: what all do together is that of Φᵀ f on v.
   */
  template <int dim>
  class LoadWorks
  {
  public:
    /** @p accounts must outlive it; works are added to them. */
    LoadWorks(const std::vector<MechanicalCondition<dim>> &conditions,
              ConditionAccounts<dim> &accounts);

    /** Whether there are several loads. Nothing else is to be called where there are not. */
    bool is_active() const;

    /** Owned nodes at which loads can act; what is kept of other nodes is lost. */
    void set_nodes(const std::vector<unsigned int> &loaded_nodes);

    /** Accounts for the loads at t_{n-1} on the velocity @p at_places of t_{n-1/2}, once. */
    void add_first_half(const NodalVector &at_places);

    /** Loads at t_{n-1} are no more those of the nodes. */
    void forget();

    /** Takes the @p loads of a condition alone at t_n, collected at owned nodes. */
    void take(unsigned int condition, const NodalVector &loads);

    /** Accounts for the loads at t_n on the same velocity, and for the first half where that is not
     * done; @p velocity_step is Δt_n, and @p is_start says that there was no step before. */
    void add_second_half(const NodalVector &at_places, double velocity_step, bool is_start);

    /** Writes to a checkpoint or reads from it, in the present group. Collective. */
    void serialize(StateArchive &archive);

  private:
    using Vector = std::array<double, 3>;
    struct OfCondition
    {
      unsigned int number;
      std::vector<Vector> force;            ///< at the nodes at t_n
      std::vector<Vector> previous_impulse; ///< Δt_{n-1} f_{n-1}; empty: not known
    };

    ConditionAccounts<dim> &accounts;
    std::vector<OfCondition> loads;
    std::vector<unsigned int> nodes;
    bool first_half_is_added = false; ///< of the step in progress; never between two steps
  };
} // namespace tombolo
