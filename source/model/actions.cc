// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/actions.h>

#include <tombolo/base/clock.h>
#include <tombolo/coupling/bridge.h>
#include <tombolo/model/impulse_account.h>
#include <tombolo/state/nodal_state.h>

#include <numeric>
#include <utility>

namespace tombolo
{
  namespace
  {
    void append_force(const NodalVector &vector, const unsigned int node, NodalForces &result)
    {
      const double *const f = vector.node(node);
      if (f[0] == 0. && f[1] == 0. && f[2] == 0.)
        return;
      result.nodes.push_back(node);
      result.forces.push_back(Tensor<1, 3>({f[0], f[1], f[2]}));
    }

    void append_all_forces(const NodalVector &vector, NodalForces &result)
    {
      result.clear();
      for (unsigned int node = 0; node < vector.partition()->n_owned(); ++node)
        append_force(vector, node, result);
    }
  } // namespace

  void extract_forces(const NodalVector &vector, const std::vector<unsigned int> &nodes,
                      NodalForces &result)
  {
    result.clear();
    for (const unsigned int node : nodes)
      append_force(vector, node, result);
  }

  void StepWork::begin_change(const NodalVector &velocity, double &work)
  {
    for (std::size_t k = 0; k < previous.nodes.size(); ++k)
      for (unsigned int d = 0; d < 3; ++d)
        work += 0.5 * velocity.node(previous.nodes[k])[d] * previous.forces[k][d];
    previous.clear();
  }

  void StepWork::complete_step(const NodalForces &forces, const NodalVector &velocity,
                               const Clock &clock, double &work)
  {
    now.clear();
    std::size_t before = 0;
    const auto add = [&](const unsigned int node, const Tensor<1, 3> &force, Tensor<1, 3> impulse)
    {
      const Tensor<1, 3> step_impulse =
          impulse_of_step(clock.velocity_step() * force, impulse, clock);
      for (unsigned int d = 0; d < 3; ++d)
        work += velocity.node(node)[d] * step_impulse[d];
      if (impulse.norm_square() == 0.)
        return;
      now.nodes.push_back(node);
      now.forces.push_back(impulse);
    };
    const auto add_before = [&](const unsigned int end)
    {
      for (; before < previous.nodes.size() && previous.nodes[before] < end; ++before)
        add(previous.nodes[before], Tensor<1, 3>(), previous.forces[before]);
    };
    for (std::size_t k = 0; k < forces.nodes.size(); ++k)
    {
      const unsigned int node = forces.nodes[k];
      add_before(node);
      const bool is_known = before < previous.nodes.size() && previous.nodes[before] == node;
      add(node, forces.forces[k], is_known ? previous.forces[before] : Tensor<1, 3>());
      before += is_known ? 1 : 0;
    }
    add_before(numbers::invalid_unsigned_int);
    std::swap(previous, now);
  }

  void StepWork::list(const std::string &name, Records &records)
  {
    records.archived(
        [this, name](StateArchive &archive)
        {
          std::vector<std::array<double, 3>> impulses;
          for (const Tensor<1, 3> &impulse : previous.forces)
            impulses.push_back({{impulse[0], impulse[1], impulse[2]}});
          if (!archive.is_reading())
          {
            archive.nodal(name, previous.nodes, impulses);
            return;
          }
          std::vector<unsigned int> all(archive.n_owned_nodes());
          std::iota(all.begin(), all.end(), 0u);
          archive.nodal(name, all, impulses);
          previous.clear();
          for (const unsigned int node : all)
            if (const Tensor<1, 3> impulse(
                    {impulses[node][0], impulses[node][1], impulses[node][2]});
                impulse.norm_square() != 0.)
            {
              previous.nodes.push_back(node);
              previous.forces.push_back(impulse);
            }
        });
  }

  Action::Action(std::string name, const ActsAt acts_at)
      : NodalSource(Quantity::vector), name(std::move(name)), acts_at(acts_at)
  {}

  Tensor<1, 3> Action::nodal_force(const unsigned int node) const
  {
    const auto found = std::lower_bound(node_forces.nodes.begin(), node_forces.nodes.end(), node);
    return found != node_forces.nodes.end() && *found == node
               ? node_forces.forces[std::size_t(found - node_forces.nodes.begin())]
               : Tensor<1, 3>();
  }

  void Action::spread(Bridge &bridge, NodalVector &buffer)
  {
    buffer.fit_to(values.partition());
    LoadTransfer &transfer = bridge.load_transfer();
    if (acts_at == ActsAt::loads)
      transfer.add_force_of_loads(node_forces.nodes, values, buffer);
    else
      transfer.add_force_at_positions(node_forces.nodes, values, buffer);
    if (bridge.has_particles())
    {
      buffer.add_to_owners();
      append_all_forces(buffer, node_forces);
    }
    else
    {
      given_nodes.swap(node_forces.nodes);
      extract_forces(buffer, given_nodes, node_forces);
    }
    for (const unsigned int node : node_forces.nodes)
      std::fill_n(buffer.node(node), node_stride, 0.);
  }

  void Action::collect(Bridge &bridge, NodalVector &buffer, NodalVector &total)
  {
    gather();
    for_given([&](const unsigned int node) { append_force(values, node, node_forces); });
    if (acts_at != ActsAt::nodes)
      spread(bridge, buffer);
    for (std::size_t k = 0; k < node_forces.nodes.size(); ++k)
      for (unsigned int d = 0; d < 3; ++d)
        total.node(node_forces.nodes[k])[d] += node_forces.forces[k][d];
  }

  HeatAction::HeatAction(std::string name, std::string account)
      : NodalSource(Quantity::scalar), name(std::move(name)), account(std::move(account))
  {}

  void HeatAction::collect(NodalVector &pending)
  {
    if (is_on_rank && touched.empty() && !is_anywhere && !values.partition()->has_dependent_nodes())
      return;
    gather();
    for_given(
        [&](const unsigned int node)
        {
          *pending.node(node) += *values.node(node);
          sum_of_heat += *values.node(node);
        });
    clear();
  }

  Action &Actions::add(const std::string &name, const ActsAt acts_at)
  {
    Action &action = all.emplace_back(name, acts_at);
    records.group(name).list(
        [&action](Records &action_records)
        {
          if (action.energy.empty())
            return;
          action_records.sums("work", action.sum_of_work);
          action.work_of_steps.list("previous impulse", action_records);
        });
    return action;
  }

  void Actions::collect_late(Bridge &bridge, const std::vector<std::uint8_t> &constrained,
                             const ObliqueNodes &oblique, NodalState &state)
  {
    for (Action &action : all)
    {
      if (!action.is_late)
        continue;
      action.collect(bridge, buffer, state.force);
      const NodalForces &now = action.nodal_forces();
      for (std::size_t k = 0; k < now.nodes.size(); ++k)
      {
        Tensor<1, 3> force = now.forces[k];
        if (const ObliqueNode *const frame = oblique.find(now.nodes[k]))
          frame->remove_prescribed(force.begin_raw());
        for (unsigned int d = 0; d < 3; ++d)
          if (constrained.empty() || !((constrained[now.nodes[k]] >> d) & 1u))
            state.acceleration.node(now.nodes[k])[d] +=
                force[d] / bridge.nodal_mass().node(now.nodes[k])[d];
      }
    }
  }

  void Actions::collect_heat(NodalVector &pending, const bool on_rank_only)
  {
    for (HeatAction &heat : heats)
      if (heat.is_on_rank || !on_rank_only)
        heat.collect(pending);
  }

  void Actions::complete_step(const NodalState &state, const Clock &clock, ImpulseAccount &impulses)
  {
    for (Action &action : all)
    {
      const NodalForces &now = action.nodal_forces();
      if (!action.energy.empty())
        action.work_of_steps.complete_step(now, state.velocity, clock, action.sum_of_work);
      for (std::size_t k = 0; action.is_from_outside && k < now.nodes.size(); ++k)
      {
        const Tensor<1, 3> impulse = clock.velocity_step() * now.forces[k];
        impulses.add(state.position.node(now.nodes[k]), {{impulse[0], impulse[1], impulse[2]}});
      }
    }
  }

  void Actions::account(EnergyAccounts &accounts) const
  {
    for (const Action &action : all)
      if (!action.energy.empty())
        accounts.add(action.energy, action.kind,
                     is_held(action.kind) ? -action.sum_of_work : action.sum_of_work);
  }

  void Actions::account_heat(EnergyAccounts &accounts) const
  {
    for (const HeatAction &heat : heats)
      accounts.add(heat.account, EnergyKind::external, heat.sum_of_heat);
  }
} // namespace tombolo
