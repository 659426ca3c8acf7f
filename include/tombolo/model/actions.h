// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/energy_accounts.h>
#include <tombolo/state/nodal_source.h>
#include <tombolo/state/oblique_nodes.h>
#include <tombolo/state/records.h>

#include <deal.II/base/tensor.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace tombolo
{
  class Bridge;
  class ImpulseAccount;
  class NodalState;
  struct Clock;

  /** Forces, or impulses, at some owned nodes, ascending. */
  struct NodalForces
  {
    std::vector<unsigned int> nodes;
    std::vector<dealii::Tensor<1, 3>> forces;

    void clear()
    {
      nodes.clear();
      forces.clear();
    }
  };

  /** What @p vector has at these owned nodes, ascending, without zeros. */
  void extract_forces(const NodalVector &vector, const std::vector<unsigned int> &nodes,
                      NodalForces &result);

  /** The work of forces on the motion of their nodes from step to step (impulse_of_step()). */
  class StepWork
  {
  public:
    /** Adds the work of the forces at t_{n-1} in the coming step, with the @p velocity of the rows
     * and masses as they are. */
    void begin_change(const NodalVector &velocity, double &work);

    /** Adds the work of the step that ends at t_n, or what of it is left. */
    void complete_step(const NodalForces &forces, const NodalVector &velocity, const Clock &clock,
                       double &work);

    /** As one dataset of nodes. */
    void list(const std::string &name, Records &records);

  private:
    NodalForces previous; ///< Δt_{n-1} f_{n-1}
    NodalForces now;      ///< buffer
  };

  /** Where forces act. */
  enum class ActsAt
  {
    nodes,    ///< on the nodal velocities themselves
    loads,    ///< on the field Φ x, as tractions and body forces do
    positions ///< at the positions of the nodes, wherever the smoothing has these
  };

  /**
   * The forces of one source at t_n. It is made once, by Actions::add(). In each step the process
   * sets its forces at local nodes; all else is done here: forces at ghosts, at images in planes
   * of symmetry and at hanging nodes go to the nodes that move, forces at positions and loads
   * become nodal forces by Φᵀ, their work and their impulse are booked, with the first half of a
   * step before rows or masses change, and go through checkpoints.
   *
   * It costs what its nodes cost, and one pass over the nodes of the rank where forces are spread
   * by Φᵀ or nodes are dependent.
   */
  class Action : public NodalSource
  {
  public:
    Action(std::string name, ActsAt acts_at);

    /** Books the work under the name @p work_name: work done where the kind is external, and
     * work received otherwise. Without it the process accounts for its energies itself. */
    Action &books(const std::string &work_name, const EnergyKind energy_kind)
    {
      energy = work_name;
      kind = energy_kind;
      return *this;
    }

    /** Its impulse comes from outside: momentum is not conserved without it. */
    Action &comes_from_outside()
    {
      is_from_outside = true;
      return *this;
    }

    /** It is added while accelerations are constrained, where the size of the coming step is
     * known, and accelerates what no condition prescribes. */
    Action &follows_acceleration()
    {
      is_late = true;
      return *this;
    }

    Action &stays_on_rank()
    {
      NodalSource::stays_on_rank();
      return *this;
    }

    /** Adds a force [M L/T^2] at a local node: owned, a ghost or an image. */
    template <int dim>
    void add_force(const unsigned int node, const dealii::Tensor<1, dim> &force)
    {
      add(node, force);
    }

    /** The nodal forces. */
    const NodalForces &nodal_forces() const
    {
      return node_forces;
    }
    dealii::Tensor<1, 3> nodal_force(unsigned int node) const;

    /** The work of this rank since the start [M L^2/T^2]. */
    double work() const
    {
      return sum_of_work;
    }

  private:
    friend class Actions;

    void begin()
    {
      clear();
      node_forces.clear();
    }

    void collect(Bridge &bridge, NodalVector &buffer, NodalVector &total);
    void spread(Bridge &bridge, NodalVector &buffer);

    std::string name, energy;
    ActsAt acts_at;
    EnergyKind kind = EnergyKind::external;
    bool is_from_outside = false, is_late = false;
    NodalForces node_forces;
    std::vector<unsigned int> given_nodes; ///< buffer
    StepWork work_of_steps;
    double sum_of_work = 0;
  };

  /**
   * The heat of one source, at positions, as that of surfaces. It is made once, by
   * Actions::add_heat(); the process sets heat at local nodes, in add_heat() or with its forces,
   * at owned nodes (stays_on_rank()) at any time of the step, and all else is done as for forces.
   * The heat waits in ThermalState::pending for the end of the thermal step, where nodes receive it
   * by Sᵀ Φᵀ. The balance of heat has what was added, as external, and what is pending.
   */
  class HeatAction : public NodalSource
  {
  public:
    HeatAction(std::string name, std::string account);

    /** Adds heat [M L^2/T^2] at a local node: owned, a ghost or an image. */
    void add_heat(const unsigned int node, const double heat)
    {
      add(node, heat);
    }

    /** Moves the heat of the process to @p pending at owned nodes (scalar); is called
     * for the process after it has set its forces. Collective. */
    void collect(NodalVector &pending);

  private:
    friend class Actions;

    std::string name, account;
    double sum_of_heat = 0; ///< of this rank
  };

  /** The actions of a process. All functions are collective. */
  class Actions
  {
  public:
    /** Makes one. The name is that in checkpoints, and no other action of the scene has it. The
     * result is valid as long as this. */
    Action &add(const std::string &name, ActsAt acts_at);

    /** Makes a source of heat, which the balance of heat calls @p account: others may have the same
     * one, where the sum counts. */
    HeatAction &add_heat(const std::string &name, const std::string &account)
    {
      HeatAction &heat = heats.emplace_back(name, account);
      records.group(name).sums("heat", heat.sum_of_heat);
      return heat;
    }

    bool has_heat() const
    {
      return !heats.empty();
    }

    void set_partition(const std::shared_ptr<const NodePartition> &partition)
    {
      for_all([&](NodalSource &source) { source.set_partition(partition); });
    }

    /** Clears the forces of the step before, or @p late those of actions that follow the
     * acceleration; then the process sets the present ones. */
    void begin(const bool late = false)
    {
      for (Action &action : all)
        if (action.is_late == late)
          action.begin();
    }

    /** Adds their nodal forces to @p total at owned nodes. */
    void collect(Bridge &bridge, NodalVector &total)
    {
      for (Action &action : all)
        if (!action.is_late)
          action.collect(bridge, buffer, total);
    }

    /** The same of actions that follow the acceleration, which they change as well, except for the
     * components that @p constrained has as bits, and the axes of frames that are prescribed. */
    void collect_late(Bridge &bridge, const std::vector<std::uint8_t> &constrained,
                      const ObliqueNodes &oblique, NodalState &state);

    /** Adds the heat that was given, or that of sources that stay on their rank, to @p pending. */
    void collect_heat(NodalVector &pending, bool on_rank_only = false);

    /** Rows, nodes or masses are about to change. */
    void begin_change(const NodalVector &velocity)
    {
      for (Action &action : all)
        action.work_of_steps.begin_change(velocity, action.sum_of_work);
    }

    /** Books the step that ends at t_n. */
    void complete_step(const NodalState &state, const Clock &clock, ImpulseAccount &impulses);

    /** Calls @p use with each owned node that has a force of one of them now. */
    template <typename Use>
    void for_touched_nodes(const Use &use) const
    {
      for (const Action &action : all)
        for (const unsigned int node : action.node_forces.nodes)
          use(node);
    }

    /** Adds the nodal forces of those that follow the acceleration to @p total at owned nodes. */
    void add_late_forces(NodalVector &total) const
    {
      for (const Action &action : all)
        for (std::size_t k = 0; action.is_late && k < action.node_forces.nodes.size(); ++k)
          for (unsigned int d = 0; d < 3; ++d)
            total.node(action.node_forces.nodes[k])[d] += action.node_forces.forces[k][d];
    }

    void account(EnergyAccounts &accounts) const;
    void account_heat(EnergyAccounts &accounts) const;

    Records records;

  private:
    template <typename Use>
    void for_all(const Use &use)
    {
      std::for_each(all.begin(), all.end(), use);
      std::for_each(heats.begin(), heats.end(), use);
    }

    std::deque<Action> all;
    std::deque<HeatAction> heats;
    NodalVector buffer; ///< zero between uses
  };
} // namespace tombolo
