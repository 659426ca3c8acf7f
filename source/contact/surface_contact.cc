// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surface_contact.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/contact_candidates.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/contact/surface_section.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  ContactAreas<dim>::ContactAreas(const Nodes<dim> &nodes,
                                  const std::set<types::boundary_id> &boundaries,
                                  const std::vector<unsigned int> &candidates,
                                  const std::vector<double> &volume)
      : faces(nodes, boundaries)
  {
    for (const unsigned int node : candidates)
      inner_area.push_back(std::pow(volume[node], (dim - 1.) / dim));
  }

  template class ContactAreas<2>;
  template class ContactAreas<3>;

  template <int dim>
  SurfaceContact<dim>::SurfaceContact(const Section &section, const Mesh<dim> &mesh,
                                      const Nodes<dim> &nodes, const NodalState &state,
                                      const std::vector<bool> &can_be_exposed, const bool has_heat,
                                      const std::vector<double> &volume, MasterPart<dim> master)
      : communicator(nodes.communicator()), settings(section, has_heat),
        surface(create_surface<dim>(section)), contact_name(section.name())
  {
    surface->load(nodes.communicator());
    part = surface->of_part();
    if (part)
      part->take(std::move(master), state);
    of_surface.position = surface->reference_point(0.);
    const auto boundaries = contact_boundaries(section, mesh);
    candidates = find_contact_candidates(section, boundaries, nodes, state, can_be_exposed);
    if (part)
      part->drop_own_nodes(section, candidates);
    if (has_heat)
      heat = std::make_unique<ContactHeat<dim>>(section, settings, candidates, part);
    if (conducts() || settings.limits_shear() || part)
      areas = std::make_unique<ContactAreas<dim>>(nodes, boundaries, candidates, volume);
    set_partition(state.partition());
    if (part)
    {
      areas->of_faces().update(state.initial_position);
      part->set_areas(areas->of_faces());
    }
    surface->set_reach(settings.radius);
    find_gaps(state.initial_position, candidates, 0., gap);
    refuse_penetration(section, nodes, state, candidates, gap);

    histories.resize(candidates.size());
    for (std::size_t k = 0; k < candidates.size(); ++k)
      histories[k].position = vector_of<dim>(state.position.node(candidates[k]));
    records.on_continuation([this, &state] { forget_motion(state); });
    records.sums("heat, work and impulse", friction_heat, damping_heat, of_surface.shares());
    if (areas)
      records.sums("area in contact", of_surface.area);
    records.at_nodes(candidates, histories)
        .vector("force", &NodeHistory::force)
        .vector("position", &NodeHistory::position)
        .of_field(state.position);
    surface->translation().list(records);
    if (part)
      part->list(records.group("surface of the part"), candidates);
    if (heat)
      heat->list(records);

    refuse_motion_out_of_mirrors(section, *nodes.images(), *surface);
  }

  template <int dim>
  void SurfaceContact<dim>::find_gaps(const NodalVector &position,
                                      const std::vector<unsigned int> &nodes, const double time,
                                      std::vector<double> &gaps) const
  {
    surface->evaluate_gaps(position, nodes, time, gaps);
    for (double &of_node : gaps)
      of_node -= settings.radius;
  }

  template <int dim>
  void SurfaceContact<dim>::add_contact(const std::size_t candidate, const double normal_force,
                                        const double area, const Clock &clock)
  {
    of_surface.area += std::max(area, 0.);
    if (heat && heat->partner() != nullptr)
      heat->partner()->add_contact(candidate, candidates[candidate], normal_force, area,
                                   clock.previous_step);
  }

  template <int dim>
  void SurfaceContact<dim>::add_friction_heat(const std::size_t candidate, const double of_sliding,
                                              const NodalHeat &nodal_heat)
  {
    friction_heat += of_sliding;
    if (heat)
      heat->add_friction(candidate, of_sliding, nodal_heat);
  }

  template <int dim>
  void SurfaceContact<dim>::end_forces(const double friction_heat_before)
  {
    if (heat)
      heat->end_forces(friction_heat - friction_heat_before);
  }

  template <int dim>
  double SurfaceContact<dim>::friction_coefficient(const std::size_t candidate,
                                                   const NodalHeat &nodal_heat) const
  {
    if (settings.friction.is_constant() || !(settings.friction.largest() > 0.))
      return settings.friction.largest();
    return settings.friction.value(nodal_heat.temperature_of(candidates[candidate]));
  }

  template <int dim>
  void SurfaceContact<dim>::begin_forces(const NodalState &state, const Clock &clock,
                                         const NodalHeat &nodal_heat)
  {
    of_surface.begin_forces(surface->reference_point(clock.time));
    if (heat)
      heat->begin_step(nodal_heat);
    if (areas && !part && clock.stable_step > 0.)
      areas->of_faces().update(state.position);
  }

  template <int dim>
  void SurfaceContact<dim>::forget_motion(const NodalState &state)
  {
    for (std::size_t k = 0; k < candidates.size(); ++k)
      histories[k].position = vector_of<dim>(state.position.node(candidates[k]));
    if (part)
      part->forget_motion(state);
  }

  template <int dim>
  void SurfaceContact<dim>::keep_outside(const Clock &clock, const NodalVector &slides,
                                         const NodalVector &from, NodalVector &position,
                                         NodalVector &is_bound)
  {
    std::vector<double> was, is;
    find_gaps(from, candidates, clock.time, was);
    find_gaps(position, candidates, clock.time, is);
    push_out(*surface, candidates, was, is, clock.time, slides, from, position, is_bound);
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
  std::vector<unsigned int> SurfaceContact<dim>::nodes_in_contact() const
  {
    std::vector<unsigned int> result;
    for (std::size_t k = 0; k < candidates.size(); ++k)
      if (histories[k].force.norm_square() > 0.)
        result.push_back(candidates[k]);
    return result;
  }

  template <int dim>
  void SurfaceContact<dim>::add_present_forces(NodalVector &forces) const
  {
    for (std::size_t k = 0; k < candidates.size(); ++k)
      for (unsigned int d = 0; d < dim; ++d)
        forces.node(candidates[k])[d] += histories[k].force[d];
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
    if (heat)
      heat->add_shares(shares);
    ContactBalance result = of_surface.balance(shares, surface->translation(), communicator);
    if (part)
      result.external_work = 0.; // one body does it on another
    if (heat)
      heat->complete(result);
    return result;
  }

  template class SurfaceContact<2>;
  template class SurfaceContact<3>;
} // namespace tombolo
