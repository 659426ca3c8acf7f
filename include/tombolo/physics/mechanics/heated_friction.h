// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surface_contact.h>
#include <tombolo/model/model.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * The friction over the temperature of contacts in a scene whose particles distribute the heat
   * of nodes (SpreadFriction). The coefficients of the receivers are implicit in the thermal step:
   * those of their temperatures at its end if the heat of the last one by the coefficient 1
   * is repeated,
   *
   * @verbatim
   *   m_j = μ(T_j),   H_j(T_j) = H_j + m_j Σ_i G_ij q_i / μ_i
   * @endverbatim
   *
   * where T_j is that of the node or of the field there, whichever is hotter: sharpened and affine
   * smoothings are hotter between nodes than these are.
   *
   * Where nodes hang, heat is distributed as that of other sources, and friction depends on the
   * field at the node.
   */
  template <int dim>
  class HeatedFriction
  {
  public:
    using Contacts = std::vector<std::unique_ptr<SurfaceContact<dim>>>;

    /** Of those of @p contacts that have a friction over the temperature, where something is
     * smoothed: of none elsewhere. They must outlive this. Lists its state in @p records. */
    HeatedFriction(const Contacts &contacts, const Model<dim> &model, Records &records)
    {
      if (!model.heat || model.heat->bridge.operators() == Bridge::Operators::identity)
        return;
      for (const auto &contact : contacts)
      {
        if (contact->contact_settings().friction.is_constant())
          continue;
        SpreadFriction &friction = contact->spread_friction();
        members.push_back({contact.get(), &friction});
        Records &contact_records = records.group("friction of " + contact->name());
        contact_records.value("is outdated", friction.is_outdated);
        contact_records.nodal("coefficients of receivers", 1, friction.weight);
        contact_records.nodal("coefficient", 1, friction.coefficient);
        contact_records.nodal("heat of friction", 1, friction.heat);
        contact_records.nodal("heat by the coefficient 1", 1, friction.unit_heat);
        // Pending heat is distributed as that of other sources.
        contact_records.on_division(
            [&friction](auto &)
            {
              friction.heat.set_zero();
              friction.unit_heat.set_zero();
              friction.is_outdated = true;
            });
      }
      if (!members.empty())
        set_partition(model.state.partition()); // before a checkpoint is read
    }

    /** Before forces of contacts: finds coefficients where a thermal step has ended. Collective. */
    void update(const Model<dim> &model)
    {
      if (members.empty())
        return;
      ThermalModel<dim> &thermal_model = *model.heat;
      set_partition(model.state.partition());
      for (Member &member : members)
      {
        SpreadFriction &friction = *member.friction;
        if (!std::exchange(friction.is_outdated, false))
          continue;
        const TemperatureTable &table = member.contact->contact_settings().friction;
        const bool are_dependent = model.state.partition()->has_dependent_nodes();
        const unsigned int n_owned = friction.weight.partition()->n_owned();
        hottest.resize(n_owned);
        explicit_weights.resize(n_owned);
        // The field can be hotter than the values that it is made of.
        const auto excess_of = [&](const unsigned int i)
        {
          return std::max(0., *thermal_model.state.temperature.node(i) -
                                  *thermal_model.state.unsmoothed_temperature.node(i));
        };
        for (unsigned int i = 0; i < n_owned; ++i)
          hottest[i] = *thermal_model.state.unsmoothed_temperature.node(i) + excess_of(i);
        table.evaluate(n_owned, hottest.data(), explicit_weights.data());
        friction.weight.fill(
            [&](const unsigned int i, double *const weight)
            {
              *weight = explicit_weights[i];
              const double expected = *friction.unit_heat.node(i);
              if (!(expected > 0.))
                return;
              const double enthalpy = *thermal_model.state.enthalpy.node(i), excess = excess_of(i);
              const auto with_heat = [&](const double coefficient) {
                return thermal_model.nodal_enthalpy.temperature(i,
                                                                enthalpy + coefficient * expected) +
                       excess;
              };
              *weight = implicit_coefficient(table, hottest[i], with_heat);
            });
        limit_weights(model, member);
        if (!are_dependent)
          find_coefficients(model, member, friction.coefficient);
        member.is_current = !are_dependent;
        revision_of_rows = model.revisions.stencils;
        for (const unsigned int node : member.contact->candidate_nodes())
        {
          double &node_coefficient = *friction.coefficient.node(node);
          node_coefficient = are_dependent
                                 ? table.value(*thermal_model.state.temperature.node(node))
                                 : std::max(0., node_coefficient);
        }
      }
    }

    /** The model has changed, other than its rows alone. */
    void invalidate_coefficients()
    {
      for (Member &member : members)
        member.is_current = false;
    }

    /** At the end of a thermal step: adds the pending heat of friction to nodes.
     * Collective. */
    void distribute_heat(const Model<dim> &model)
    {
      if (members.empty())
        return;
      set_partition(model.state.partition());
      for (const Member &member : members)
      {
        if (model.state.partition()->has_dependent_nodes())
        {
          member.friction->heat.set_zero();
          member.friction->unit_heat.set_zero();
        }
        else
          distribute_heat(model, member);
        member.friction->is_outdated = true;
      }
    }

  private:
    /** The temperature from which on there is no friction; infinite where there always is. */
    static double end_of_friction(const TemperatureTable &friction)
    {
      double result = std::numeric_limits<double>::infinity();
      for (std::size_t k = friction.values().size(); k > 0 && friction.values()[k - 1] == 0.; --k)
        result = friction.temperatures()[k - 1];
      return result;
    }

    struct Member
    {
      const SurfaceContact<dim> *contact;
      SpreadFriction *friction;
      bool is_current = false; ///< whether its coefficients are those of its weights
    };

    /** Collective. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition)
    {
      const auto move = [&](NodalVector &vector, const Quantity quantity)
      {
        if (vector.partition() == nullptr)
          vector.reinit(partition, quantity);
        else if (vector.partition() != partition)
          vector.move_to(partition);
      };
      for (const Member &member : members)
      {
        move(member.friction->weight, Quantity::scalars);
        move(member.friction->coefficient, Quantity::scalars);
        move(member.friction->heat, Quantity::scalar);
        move(member.friction->unit_heat, Quantity::scalar);
      }
      for (NodalVector *const buffer : {&smoothed, &field, &loads, &heat})
        buffer->fit_to(partition, Quantity::scalars);
      unit_heat.fit_to(partition, Quantity::scalar);
    }

    /** Removes friction from receivers whose heat raises the field where that is beyond the end of
     * friction. Collective. */
    void limit_weights(const Model<dim> &model, const Member &member)
    {
      // Of the range up to the end of friction: a field that is beyond it by so much, at a node
      // with all the heat of a receiver, removes all friction of this receiver.
      constexpr double tolerance = 1e-3;
      ThermalModel<dim> &thermal_model = *model.heat;
      const double end = end_of_friction(member.contact->contact_settings().friction);
      heated.clear();
      loads.set_zero();
      for (unsigned int i = 0; i < loads.partition()->n_owned(); ++i)
      {
        const double excess = *thermal_model.state.temperature.node(i) - end;
        const double range = end - thermal_model.nodal_enthalpy.initial_temperature(i);
        if (!(excess > 0.) || !(range > 0.) || *thermal_model.bridge.mass().node(i) == 0.)
          continue;
        *loads.node(i) = excess / (tolerance * range);
        heated.push_back(i);
      }
      if (dealii::Utilities::MPI::max(heated.empty() ? 0 : 1, model.communicator) == 0)
        return;
      add_up({&heat},
             [&] { thermal_model.bridge.load_transfer().add_force_of_loads(heated, loads, heat); });
      unit_heat.set_zero();
      thermal_model.add_transposed_smoothing(heat, unit_heat);
      member.friction->weight.fill([&](const unsigned int i, double *const weight)
                                   { *weight *= 1. - std::clamp(*unit_heat.node(i), 0., 1.); });
    }

    /** Σ_j G_ij m_j at nodes that can touch. Collective. */
    void find_coefficients(const Model<dim> &model, const Member &member, NodalVector &result)
    {
      model.heat->smooth(member.friction->weight, smoothed);
      model.heat->bridge.load_transfer().interpolate(member.contact->candidate_nodes(), smoothed,
                                                     result);
    }

    void distribute_heat(const Model<dim> &model, const Member &member)
    {
      // Below, receivers have nearly no friction, and the heat is distributed as other heat.
      constexpr double smallest_share = 1e-3;
      // The heat of a thermal step is expected for some more, since a coefficient of zero hides how
      // much would come, and sticking nodes slip again.
      constexpr double remembered = 0.9;
      SpreadFriction &friction = *member.friction;
      ThermalModel<dim> &thermal_model = *model.heat;
      ThermalState &state = thermal_model.state;
      // Those of the forces, if nothing has changed since, but for negative ones, which count
      // alike.
      const bool are_current = member.is_current && revision_of_rows == model.revisions.stencils;
      if (!are_current)
        find_coefficients(model, member, field);
      const NodalVector &coefficients = are_current ? friction.coefficient : field;
      const double smallest =
          smallest_share * member.contact->contact_settings().friction.largest();
      loads.set_zero();
      heated.clear();
      for (const unsigned int node : member.contact->candidate_nodes())
      {
        const double friction_heat = std::exchange(*friction.heat.node(node), 0.);
        const double coefficient = *coefficients.node(node);
        if (friction_heat == 0. || !(coefficient > smallest) ||
            *thermal_model.bridge.mass().node(node) == 0.)
          continue; // it stays with other pending heat
        *loads.node(node) = friction_heat / coefficient;
        *state.pending.node(node) -= friction_heat;
        heated.push_back(node);
      }
      add_up({&heat}, [&]
             { thermal_model.bridge.load_transfer().add_force_at_positions(heated, loads, heat); });
      unit_heat.set_zero();
      thermal_model.add_transposed_smoothing(heat, unit_heat);
      for (unsigned int i = 0; i < unit_heat.partition()->n_owned(); ++i)
      {
        const double now = *unit_heat.node(i);
        *state.enthalpy.node(i) += *friction.weight.node(i) * now;
        double &expected = *friction.unit_heat.node(i);
        expected = std::max(now, remembered * expected);
      }
    }

    std::vector<Member> members;
    unsigned long revision_of_rows = 0; // of the coefficients
    // Buffers.
    NodalVector smoothed, field, loads, heat, unit_heat;
    std::vector<double> hottest, explicit_weights;
    std::vector<unsigned int> heated;
  };
} // namespace tombolo
