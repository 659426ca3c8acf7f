// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/thermal_model.h>

#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/model/step_limit.h>
#include <tombolo/state/dependent_nodes.h>

#include <algorithm>
#include <utility>

namespace tombolo
{
  template <int dim>
  ThermalModel<dim>::ThermalModel(const std::vector<Section> &condition_sections,
                                  const Section &heat_section, const Mesh<dim> &mesh,
                                  const Nodes<dim> &nodes, std::vector<Part<dim>> &parts,
                                  const NodalVector &initial_position,
                                  const SmoothingSettings &smoothing, const bool trace)
      : conditions(condition_sections, heat_section, mesh, nodes),
        bridge(smoothing, trace, Quantity::scalars), parts(parts),
        initial_position(initial_position), assembly(parts)
  {
    bridge.set_smoothed_parts(smoothed_parts(parts));
  }

  template <int dim>
  void ThermalModel<dim>::set_partition(const std::shared_ptr<const NodePartition> &partition)
  {
    conditions.set_partition(*partition);
    const bool is_first = state.enthalpy.partition() == nullptr;
    if (is_first)
      state.reinit(partition);
    else
      state.move_to(partition);

    const unsigned int n_owned = partition->n_owned();
    nodal_enthalpy.reinit(n_owned);
    element_capacity.reinit(partition, Quantity::scalar);
    if (conditions.has_sources())
      initial_volume.reinit(partition, Quantity::scalar);
    std::vector<NodalVector> masses(parts.size());
    std::vector<Stencils *> shapes;
    std::vector<double> capacities;
    for (unsigned int p = 0; p < parts.size(); ++p)
    {
      Part<dim> &part = parts[p];
      NodalVector &mass = masses[p];
      mass.reinit(partition, Quantity::scalar);
      part.formulation->add_mass(mass);
      mass.collect();
      const double capacity = part.heat->capacity().value(part.heat->initial_temperature());
      const bool is_of_particles = part.particles != nullptr;
      if (is_of_particles)
      {
        shapes.push_back(&part.particles->stencils());
        capacities.push_back(capacity);
      }
      for (unsigned int i = 0; i < n_owned; ++i)
      {
        if (!(*mass.node(i) > 0.))
          continue;
        if (!is_of_particles)
          *element_capacity.node(i) += capacity * *mass.node(i);
        if (conditions.has_sources())
          *initial_volume.node(i) += *mass.node(i) / part.material->density();
      }
    }
    bridge.reinit(partition,
                  {shapes, element_capacity, conditions.constrained_components(), capacities, {}});
    for (unsigned int p = 0; p < parts.size(); ++p)
      for (unsigned int i = 0; i < n_owned; ++i)
        if (const double mass = *masses[p].node(i); mass > 0.)
          nodal_enthalpy.add(i, mass * (*bridge.mass().node(i) / *bridge.lumped_mass().node(i)),
                             *parts[p].heat, parts[p].material->density());
    nodal_enthalpy.complete();
    field_is_of_state = has_field = false;
    for (NodalVector *vector :
         {&smoothed_temperature, &heat, &adjoint, &direction_field, &smoothed_direction})
      vector->reinit(partition, Quantity::scalars);
    if (has_plastic_heat())
      plastic_heating.reinit(partition, Quantity::scalar);
    loads.reinit(partition, Quantity::scalars);
    load_heat.reinit(partition, Quantity::scalars);
    if (conditions.has_surface_heat())
      surface_nodes = with_nodes_depended_on(partition, conditions.surface_nodes(partition));
  }

  template <int dim>
  void ThermalModel<dim>::set_initial_temperature()
  {
    for (unsigned int i = 0; i < state.enthalpy.partition()->n_owned(); ++i)
    {
      *state.unsmoothed_temperature.node(i) = nodal_enthalpy.initial_temperature(i);
      *state.enthalpy.node(i) = nodal_enthalpy.enthalpy(i, *state.unsmoothed_temperature.node(i));
    }
  }

  template <int dim>
  void ThermalModel<dim>::find_field(NodalVector &unsmoothed, NodalVector &field)
  {
    smooth(unsmoothed, smoothed_temperature);
    bridge.load_transfer().interpolate(smoothed_temperature, field);
    has_field = true;
    field_is_of_state = false;
  }

  template <int dim>
  void ThermalModel<dim>::keep_field_of_state()
  {
    // A step that a checkpoint cut in two has found its field before it.
    field_is_of_state = has_field;
  }

  template <int dim>
  void ThermalModel<dim>::add_conduction(const NodalVector &position, const NodalVector &field,
                                         const NodalVector &smoothed, NodalVector &heat_of_nodes)
  {
    assembly.assemble(bridge, smoothed, heat_of_nodes,
                      [&](const Part<dim> &part, const NodalVector &part_field, NodalVector &result)
                      {
                        Stencils *const rows =
                            part.particles != nullptr && part.particles->pairs() == nullptr
                                ? &part.particles->stencils()
                                : nullptr;
                        const bool is_current =
                            rows == nullptr || rows->inverse_deformation_is_current;
                        if (!is_current)
                          NodalSmoothing::try_inverse_deformation<dim>(position.data(), *rows);
                        part.formulation->add_conduction(position, field, part_field, result);
                        // Heat that affects nothing must not change the forces, which compute their
                        // own.
                        if (!is_current)
                          rows->inverse_deformation_is_current = false;
                      });
  }

  template <int dim>
  void ThermalModel<dim>::smooth(NodalVector &field, NodalVector &smoothed)
  {
    field.distribute();
    bridge.apply_smoothing(field, smoothed);
    const std::vector<unsigned int> &constrained = conditions.constrained_nodes();
    if (conditions.has_constraints())
      smoothed.fill(constrained, [&](const std::size_t k, double *const value)
                    { *value = *field.node(constrained[k]); });
  }

  template <int dim>
  void ThermalModel<dim>::add_transposed_smoothing(NodalVector &nodal_heat, NodalVector &result)
  {
    nodal_heat.condense();
    const std::vector<unsigned int> &constrained = conditions.constrained_nodes();
    kept.clear();
    for (const unsigned int node : constrained)
      kept.push_back(std::exchange(*nodal_heat.node(node), 0.));
    const NodalVector &smoothed_capacity = bridge.nodal_mass();
    nodal_heat.fill([&](const unsigned int i, double *const value)
                    { *value /= *smoothed_capacity.node(i); });
    bridge.apply_adjoint(nodal_heat, adjoint);
    for (unsigned int i = 0; i < nodal_heat.partition()->n_owned(); ++i)
      *result.node(i) += *bridge.mass().node(i) * *adjoint.node(i);
    for (std::size_t k = 0; k < constrained.size(); ++k)
      *result.node(constrained[k]) += kept[k];
  }

  template <int dim>
  void ThermalModel<dim>::add_surface_loads(const double factor)
  {
    loads.collect();
    add_up({&load_heat},
           [&] { bridge.load_transfer().add_force_of_loads(surface_nodes, loads, load_heat); });
    for (unsigned int i = 0; i < load_heat.partition()->n_owned(); ++i)
      *heat.node(i) += factor * *load_heat.node(i);
  }

  template <int dim>
  void ThermalModel<dim>::heat_rate(const NodalVector &position, const NodalVector &field,
                                    const double time, NodalVector &rate,
                                    std::vector<double> &condition_heat)
  {
    add_conduction(position, field, smoothed_temperature, heat);
    if (conditions.has_surface_heat())
    {
      loads.set_zero();
      conditions.update_areas(position);
      conditions.add_surface_heat(initial_position, field, time, loads, condition_heat);
      add_surface_loads(1.);
    }
    // Sources and plastic heat go where the mass is: with lumped rows that is another one than m̂.
    rate.set_zero();
    const bool are_of_nodes = bridge.load_transfer().acts_at_nodes();
    if (conditions.has_sources() && are_of_nodes)
      conditions.add_sources(initial_position, initial_volume, time, heat, condition_heat);
    add_transposed_smoothing(heat, rate);
    if (conditions.has_sources() && !are_of_nodes)
      conditions.add_sources(initial_position, initial_volume, time, rate, condition_heat);
  }

  template <int dim>
  void ThermalModel<dim>::apply_conduction(const NodalVector &position, const NodalVector &field,
                                           const double time, const NodalVector &direction,
                                           NodalVector &result)
  {
    const unsigned int n_owned = result.partition()->n_owned();
    bridge.apply_smoothing(direction, smoothed_direction);
    if (conditions.has_constraints())
      smoothed_direction.fill(conditions.constrained_nodes(),
                              [](const std::size_t, double *const value) { *value = 0.; });
    add_conduction(position, field, smoothed_direction, heat);
    if (conditions.has_films())
    {
      bridge.load_transfer().interpolate(smoothed_direction, direction_field);
      loads.set_zero();
      conditions.add_film_action(initial_position, field, time, direction_field, loads);
      add_surface_loads(-1.);
    }
    result.set_zero();
    add_transposed_smoothing(heat, result);
    for (unsigned int i = 0; i < n_owned; ++i)
      *result.node(i) *= -1.;
    for (const unsigned int node : conditions.constrained_nodes())
      *result.node(node) = 0.;
  }

  template <int dim>
  void ThermalModel<dim>::add_film_diagonal(const double time, const NodalVector &field,
                                            NodalVector &diagonal)
  {
    if (!conditions.has_films())
      return;
    for (unsigned int i = 0; i < direction_field.partition()->n_local(); ++i)
      *direction_field.node(i) = 1.;
    loads.set_zero();
    conditions.add_film_action(initial_position, field, time, direction_field, loads);
    loads.collect();
    for (unsigned int i = 0; i < diagonal.partition()->n_owned(); ++i)
      *diagonal.node(i) += *loads.node(i);
  }

  template <int dim>
  void ThermalModel<dim>::find_free_temperature(const NodalVector &enthalpy,
                                                NodalVector &unsmoothed) const
  {
    for (unsigned int i = 0; i < enthalpy.partition()->n_owned(); ++i)
      *unsmoothed.node(i) = nodal_enthalpy.temperature(i, *enthalpy.node(i));
  }

  template <int dim>
  void ThermalModel<dim>::find_temperature(const double time, NodalVector &enthalpy,
                                           NodalVector &unsmoothed,
                                           std::vector<double> &condition_heat) const
  {
    find_free_temperature(enthalpy, unsmoothed);
    const std::vector<unsigned int> &constrained = conditions.constrained_nodes();
    if (constrained.empty())
      return;
    conditions.prescribe(initial_position, time, unsmoothed);
    for (std::size_t k = 0; k < constrained.size(); ++k)
    {
      const unsigned int node = constrained[k];
      const double held = nodal_enthalpy.enthalpy(node, *unsmoothed.node(node));
      condition_heat[static_cast<unsigned int>(conditions.prescribing_condition(k, 0))] +=
          held - *enthalpy.node(node);
      *enthalpy.node(node) = held;
    }
  }

  template <int dim>
  bool ThermalModel<dim>::has_plastic_heat() const
  {
    return std::any_of(parts.begin(), parts.end(),
                       [](const Part<dim> &part)
                       { return part.material->plastic_heat_fraction() > 0.; });
  }

  template <int dim>
  void ThermalModel<dim>::add_plastic_heat(NodalVector &enthalpy)
  {
    if (!has_plastic_heat())
      return;
    plastic_heating.set_zero();
    for (Part<dim> &part : parts)
      part.formulation->add_plastic_heat(plastic_heating);
    plastic_heating.collect();
    if (bridge.load_transfer().acts_at_nodes())
    {
      heat.set_zero();
      for (unsigned int i = 0; i < enthalpy.partition()->n_owned(); ++i)
        *heat.node(i) = *plastic_heating.node(i);
      add_transposed_smoothing(heat, enthalpy);
      return;
    }
    for (unsigned int i = 0; i < enthalpy.partition()->n_owned(); ++i)
      *enthalpy.node(i) += *plastic_heating.node(i);
  }

  template <int dim>
  void ThermalModel<dim>::add_pending_heat()
  {
    const unsigned int n_owned = state.pending.partition()->n_owned();
    loads.set_zero();
    for (unsigned int i = 0; i < n_owned; ++i)
      *loads.node(i) = std::exchange(*state.pending.node(i), 0.);
    loads.condense(); // nodes can depend on others since then
    std::vector<unsigned int> heated;
    for (unsigned int i = 0; i < n_owned; ++i)
      if (double &nodal_load = *loads.node(i); nodal_load != 0. && *bridge.mass().node(i) == 0.)
        eroded_heat += std::exchange(nodal_load, 0.); // of a node that slid and then lost its cells
      else if (nodal_load != 0.)
        heated.push_back(i);
    add_up({&load_heat},
           [&] { bridge.load_transfer().add_force_at_positions(heated, loads, load_heat); });
    add_transposed_smoothing(load_heat, state.enthalpy);
    // What ghosts and images keep would be added to their owners with the next heat of surfaces.
    load_heat.set_zero();
  }

  template <int dim>
  void ThermalModel<dim>::lose_heat(const std::vector<unsigned int> &nodes, const double pending)
  {
    const auto lose = [&](const NodalVector &temperature, NodalVector &enthalpy)
    {
      double lost = 0;
      for (const unsigned int node : nodes)
      {
        const double left = nodal_enthalpy.enthalpy(node, *temperature.node(node));
        lost += *enthalpy.node(node) - left;
        *enthalpy.node(node) = left;
      }
      return lost;
    };
    const double now = lose(state.unsmoothed_temperature, state.enthalpy);
    const double at_end = lose(state.next_unsmoothed_temperature, state.next_enthalpy);
    eroded_heat += now + pending;
    eroding_heat += at_end - now;
    limit_is_outdated = true;
  }

  template <int dim>
  bool ThermalModel<dim>::is_linear() const
  {
    // Of the parts and not of the nodes here: a rank may have none.
    bool linear = !conditions.has_films();
    for (const Part<dim> &part : parts)
      linear =
          linear && part.heat->capacity().is_constant() && part.heat->conductivity().is_constant();
    return linear;
  }

  template <int dim>
  StepLimit ThermalModel<dim>::diffusion_limit(const NodalVector &position) const
  {
    std::vector<StepLimit> part_limits;
    for (const Part<dim> &part : parts)
    {
      part_limits.push_back(part.formulation->diffusion_limit(position));
      part_limits.back().entity += " of part \"" + part.name + "\"";
    }
    return smallest_limit(part_limits, position.partition()->communicator());
  }

  template class ThermalModel<2>;
  template class ThermalModel<3>;
} // namespace tombolo
