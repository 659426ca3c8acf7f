// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surface_contact.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/contact_candidates.h>
#include <tombolo/contact/mean_and_largest.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/contact/surface_section.h>
#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  SurfaceContact<dim>::SurfaceContact(const Section &section, const Mesh<dim> &mesh,
                                      const Nodes<dim> &nodes, const NodalState &state,
                                      const std::vector<bool> &can_be_exposed, const bool has_heat,
                                      const std::vector<double> &volume)
      : communicator(nodes.communicator()), settings(section, has_heat),
        surface(create_surface<dim>(section)), contact_name(section.name())
  {
    of_surface.position = surface->reference_point(0.);
    surface->load(nodes.communicator());
    const NodePartition &partition = *state.partition();
    const std::set<types::boundary_id> boundaries = contact_boundaries(section, mesh);
    candidates = find_contact_candidates(section, boundaries, nodes, state, can_be_exposed);
    surface->set_reach(settings.radius);
    find_gaps(state.initial_position, candidates, 0., gap);
    refuse_penetration(section, nodes, state, candidates, gap);

    histories.resize(candidates.size());
    pending_heat.assign(settings.has_heat ? candidates.size() : 0, 0.);
    for (std::size_t k = 0; k < candidates.size(); ++k)
      histories[k].position = vector_of<dim>(state.position.node(candidates[k]));

    if (const Symmetry *const symmetry = partition.symmetry())
      refuse_motion_out_of_symmetry(section, *symmetry, *surface);
    if (has_heat)
      tool_heat = ToolHeat<dim>::create(section);
    if (conducts() || settings.limits_shear())
      areas = std::make_unique<ContactAreas<dim>>(nodes, boundaries, candidates, volume);
    set_partition(state.partition());
  }

  template <int dim>
  double SurfaceContact<dim>::enthalpy(const std::size_t candidate,
                                       const NodalHeat &nodal_heat) const
  {
    const unsigned int node = candidates[candidate];
    return nodal_heat.enthalpy->enthalpy(node, *nodal_heat.temperature->node(node)) +
           (nodal_heat.pending != nullptr ? *nodal_heat.pending->node(node)
                                          : pending_heat[candidate]);
  }

  template <int dim>
  void SurfaceContact<dim>::find_gaps(const NodalVector &position,
                                      const std::vector<unsigned int> &nodes, const double time,
                                      std::vector<double> &gaps) const
  {
    surface->evaluate_gaps(position, nodes, time, gaps);
    if (settings.radius > 0.)
      for (double &of_node : gaps)
        of_node -= settings.radius;
  }

  template <int dim>
  void SurfaceContact<dim>::add_contact(const std::size_t candidate, const double normal_force,
                                        const double area, const Clock &clock)
  {
    of_surface.area += std::max(area, 0.);
    if (tool_heat)
      tool_heat->add_contact(candidate, candidates[candidate], normal_force, area,
                             clock.previous_step);
  }

  template <int dim>
  void SurfaceContact<dim>::add_friction_heat(const std::size_t candidate, const double heat,
                                              const NodalHeat &nodal_heat)
  {
    friction_heat += heat;
    if (!settings.has_heat)
      return;
    double fraction = settings.heat_fraction;
    if (settings.splits_by_effusivity && heat != 0.)
    {
      const unsigned int node = candidates[candidate];
      const double temperature =
          nodal_heat.enthalpy->temperature(node, enthalpy(candidate, nodal_heat));
      const double of_body = nodal_heat.enthalpy->effusivity(node, temperature);
      fraction = of_body / (of_body + settings.tool_effusivity.value(
                                          tool_heat ? tool_heat->temperature() : temperature));
      friction_heat_of_bodies += fraction * heat;
      friction_heat_of_tool += (1. - fraction) * heat;
    }
    pending_heat[candidate] += fraction * heat;
  }

  template <int dim>
  void SurfaceContact<dim>::end_forces(const double friction_heat_before)
  {
    if (!settings.splits_by_effusivity)
      friction_heat_of_tool =
          (1. - settings.heat_fraction) * (friction_heat - friction_heat_before);
  }

  template <int dim>
  double SurfaceContact<dim>::friction_coefficient(const std::size_t candidate,
                                                   const NodalHeat &nodal_heat) const
  {
    if (settings.friction.is_constant() || !(settings.friction.largest() > 0.))
      return settings.friction.largest();
    return settings.friction.value(
        nodal_heat.enthalpy->temperature(candidates[candidate], enthalpy(candidate, nodal_heat)));
  }

  template <int dim>
  void SurfaceContact<dim>::begin_forces(const NodalState &state, const Clock &clock)
  {
    friction_heat_of_tool = 0.;
    of_surface.begin_forces(surface->reference_point(clock.time));
    if (tool_heat)
      tool_heat->begin_step();
    if (areas && clock.stable_step > 0.)
      areas->of_faces().update(state.position);
  }

  template <int dim>
  void SurfaceContact<dim>::forget_motion(const NodalState &state)
  {
    for (std::size_t k = 0; k < candidates.size(); ++k)
      histories[k].position = vector_of<dim>(state.position.node(candidates[k]));
  }

  template <int dim>
  void SurfaceContact<dim>::begin_trial(const NodalState &state, const Clock &clock)
  {
    if (clock.step == 0)
      forget_motion(state);
    committed = tied_state();
    if (tool_heat)
      committed_tool_heat = tool_heat->state();
  }

  template <int dim>
  void SurfaceContact<dim>::restart_trial()
  {
    tied_state() = committed;
    if (tool_heat)
      tool_heat->restore(committed_tool_heat);
  }

  template <int dim>
  void SurfaceContact<dim>::exchange_heat(const NodalHeat &nodal_heat)
  {
    if (tool_heat)
      tool_heat->end_step(
          friction_heat_of_tool, nodal_heat,
          [&](const std::size_t k) { return enthalpy(k, nodal_heat); }, pending_heat, communicator);
  }

  template <int dim>
  void SurfaceContact<dim>::complete_step(const Clock &clock)
  {
    of_surface.add_impulse(clock.velocity_step());
    if (!surface->translation().has_mass())
      return;
    std::array<double, dim> on_bodies;
    for (unsigned int d = 0; d < dim; ++d)
      on_bodies[d] = of_surface.force[d];
    on_bodies = ordered_sum(on_bodies, communicator);
    Tensor<1, dim> reaction;
    for (unsigned int d = 0; d < dim; ++d)
      reaction[d] = -on_bodies[d];
    surface->translation().accelerate(clock, reaction);
  }

  template <int dim>
  void SurfaceContact<dim>::add_pending_heat(NodalVector &heat) const
  {
    for (std::size_t k = 0; k < pending_heat.size(); ++k)
      heat.node(candidates[k])[0] += pending_heat[k];
  }

  template <int dim>
  void SurfaceContact<dim>::add_heat(NodalVector &heat)
  {
    add_pending_heat(heat);
    std::fill(pending_heat.begin(), pending_heat.end(), 0.);
  }

  template <int dim>
  double SurfaceContact<dim>::heat_to_give() const
  {
    return std::accumulate(pending_heat.begin(), pending_heat.end(), 0.);
  }

  template <int dim>
  void SurfaceContact<dim>::add_present_forces(NodalVector &forces) const
  {
    for (std::size_t k = 0; k < candidates.size(); ++k)
      for (unsigned int d = 0; d < dim; ++d)
        forces.node(candidates[k])[d] += histories[k].force[d];
  }

  template <int dim>
  std::array<double, 2>
  SurfaceContact<dim>::temperatures_in_contact(const NodalVector &temperature) const
  {
    std::vector<double> values;
    for (std::size_t k = 0; k < candidates.size(); ++k)
      if (histories[k].force.norm_square() > 0.)
        values.push_back(*temperature.node(candidates[k]));
    return mean_and_largest(values, communicator);
  }

  template <int dim>
  ContactBalance SurfaceContact<dim>::balance(const MPI_Comm communicator) const
  {
    const NodeSums of_nodes = node_sums();
    ContactBalance shares;
    shares.elastic = of_nodes.elastic;
    shares.n_nodes = of_nodes.n_nodes;
    shares.penetration = of_nodes.deepest;
    shares.friction = friction_heat;
    shares.damping = damping_heat;
    shares.conducted = tool_heat ? tool_heat->conducted() : 0.;
    shares.friction_of_bodies = friction_heat_of_bodies;
    ContactBalance result = of_surface.balance(shares, surface->translation(), communicator);
    if (!settings.has_heat)
    {
      result.conducted = result.friction_of_bodies = 0.;
      return result;
    }
    if (!settings.splits_by_effusivity)
      result.friction_of_bodies = settings.heat_fraction * result.friction;
    result.heat_of_bodies = result.friction_of_bodies + result.conducted;
    result.heat_of_tool = tool_heat && tool_heat->has_capacity()
                              ? tool_heat->stored()
                              : result.friction - result.heat_of_bodies;
    result.tool_temperature = tool_heat ? tool_heat->temperature() : 0.;
    return result;
  }

  template <int dim>
  void SurfaceContact<dim>::serialize(StateArchive &archive)
  {
    const auto group = archive.group("contact " + contact_name);
    std::vector<double *> shares{&friction_heat, &damping_heat};
    of_surface.append_shares(shares);
    archive.sums("heat, work and impulse", shares);
    if (settings.splits_by_effusivity)
      archive.sums("friction heat of bodies", {&friction_heat_of_bodies});
    if (areas)
      archive.sums("area in contact", {&of_surface.area});

    serialize_nodes(archive);
    NodeHistory::serialize(archive, candidates, histories);
    surface->translation().serialize(archive);
    if (!settings.has_heat)
      return;
    if (tool_heat)
      tool_heat->serialize(archive);
    std::vector<std::array<double, 3>> heat;
    for (const double value : pending_heat)
      heat.push_back({{value, 0., 0.}});
    archive.nodal("heat to give", candidates, heat);
    for (std::size_t k = 0; k < pending_heat.size(); ++k)
      pending_heat[k] = heat[k][0];
  }

  template <int dim>
  void SurfaceContact<dim>::continue_from(const NodalState &state, StateArchive &archive)
  {
    for (std::size_t k = 0; k < histories.size(); ++k)
      histories[k].position = vector_of<dim>(state.position.node(candidates[k]));
    if (!archive.has("contact " + contact_name))
      return;
    const auto group = archive.group("contact " + contact_name);
    continue_nodes(archive);
    if (!settings.has_heat || !archive.has("heat to give"))
      return;
    std::vector<std::array<double, 3>> heat;
    archive.nodal("heat to give", candidates, heat);
    for (std::size_t k = 0; k < pending_heat.size(); ++k)
      pending_heat[k] = heat[k][0];
  }

  template class SurfaceContact<2>;
  template class SurfaceContact<3>;
} // namespace tombolo
