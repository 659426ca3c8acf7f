// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surface_contact.h>

#include <tombolo/base/ordered_sum.h>

#include <utility>

namespace tombolo
{
  template <int dim>
  SurfaceContact<dim>::SurfaceContact(ContactScene<dim> &scene)
      : communicator(scene.nodes.communicator()), settings(scene.section, scene.has_heat),
        surface(scene.create_surface(scene.section)), contact_name(scene.section.name())
  {
    const Section &section = scene.section;
    const NodalState &state = scene.state;
    surface->load(communicator);
    part = surface->part_surface();
    if (part)
      part->set_part(std::move(scene.master), state);
    totals.position = surface->reference_point(0.);
    const auto boundaries = scene.boundaries();
    candidates = scene.candidates(boundaries);
    if (part)
      part->drop_own_nodes(section, candidates);
    if (settings.has_heat)
      heat = std::make_unique<ContactHeat<dim>>(section, settings, candidates, part);
    if (conducts() || settings.limits_shear() || part)
    {
      areas = std::make_unique<OutwardAreas<dim>>(scene.nodes, boundaries);
      for (const unsigned int node : candidates)
        inner_areas.push_back(std::pow(scene.volume[node], (dim - 1.) / dim));
    }
    set_partition(state.partition());
    if (part)
    {
      areas->update(state.initial_position);
      part->set_areas(*areas);
    }
    surface->set_reach(settings.radius);
    find_gaps(state.initial_position, candidates, 0., gap);
    std::vector<double> depths;
    for (std::size_t k = 0; k < candidates.size(); ++k)
      depths.push_back(*state.mass.node(candidates[k]) > 0. ? -gap[k] : 0.);
    scene.refuse_depth(scene.nodes, state, candidates, depths,
                       [&](const std::string &depth, const std::string &node)
                       {
                         return section.describe("") +
                                ": the surface starts inside the body: " + node + " is " + depth +
                                " behind it. Move the surface or the body. The normal of a plane "
                                "points to the side where bodies may be.";
                       });

    histories.resize(candidates.size());
    for (std::size_t k = 0; k < candidates.size(); ++k)
      histories[k].position = vector_of<dim>(state.position.node(candidates[k]));
    records.on_continuation([this, &state] { reset_motion(state); });
    records.sums("heat, work and impulse", totals.friction, totals.damping, totals.work,
                 totals.translation_work, interleaved(totals.impulse, totals.force, dim),
                 interleaved(totals.angular_impulse, totals.torque_of_force));
    if (areas)
      records.sums("area in contact", totals.area);
    records.at_nodes(candidates, histories)
        .vector("force", &NodeHistory::force)
        .vector("position", &NodeHistory::position)
        .samples_field(state.position);
    surface->translation().list(records);
    if (part)
      part->list(records.group("surface of the part"), candidates);
    if (heat)
      heat->list(records);

    scene.refuse_motion_out_of_mirrors(*surface);
  }

  template <int dim>
  bool SurfaceContact<dim>::begin_forces(const NodalState &state, const Clock &clock,
                                         const NodalHeat &nodal_heat)
  {
    const RigidTranslation<dim> &surface_translation = surface->translation();
    translation = surface_translation.displacement(clock.time) -
                  surface_translation.displacement(clock.time - clock.previous_step);
    totals.begin_forces(surface->reference_point(clock.time));
    friction_before = totals.friction;
    if (heat)
      heat->begin_step(nodal_heat);
    if (!(clock.stable_step > 0.))
    {
      reset_motion(state);
      return false;
    }
    return true;
  }

  template <int dim>
  void SurfaceContact<dim>::set_force(const std::size_t candidate, const Tensor<1, dim> &x,
                                      const Tensor<1, dim> &force,
                                      const Tensor<1, dim> &surface_motion, const bool touches,
                                      NodalVector &loads, std::vector<unsigned int> &loaded_nodes)
  {
    totals.add_work(histories[candidate].force + force, surface_motion, translation);
    histories[candidate] = {force, x};
    if (!touches)
      return;
    totals.add_force(force, x);
    for (unsigned int d = 0; d < dim; ++d)
      loads.node(candidates[candidate])[d] += force[d];
    loaded_nodes.push_back(candidates[candidate]);
  }

  template <int dim>
  void SurfaceContact<dim>::complete_step(const Clock &clock)
  {
    totals.add_impulse(clock.velocity_step());
    if (!surface->translation().has_mass())
      return;
    std::array<double, dim> on_bodies;
    std::copy_n(totals.force.begin_raw(), dim, on_bodies.begin());
    on_bodies = ordered_sum(on_bodies, communicator);
    surface->translation().accelerate(clock, -vector_of<dim>(on_bodies.data()));
  }

  template <int dim>
  ContactBalance SurfaceContact<dim>::balance(const MPI_Comm communicator) const
  {
    ContactBalance result;
    result.name = name();
    add_node_sums(result);
    totals.add_to(result);
    if (heat)
      heat->add_shares(result);
    result.sum_over_ranks(communicator);
    const RigidTranslation<dim> &surface_translation = surface->translation();
    result.external_work = surface_translation.has_mass() ? result.work - result.external_work +
                                                                surface_translation.work_of_force()
                           : part ? 0. // one body does it on another
                                  : result.work;
    result.tool_kinetic = surface_translation.kinetic_energy();
    for (unsigned int d = 0; d < dim; ++d)
    {
      result.position[d] = totals.position[d];
      if (surface_translation.has_mass())
      {
        result.velocity[d] = surface_translation.velocity()[d];
        result.tool_momentum[d] = surface_translation.mass() * result.velocity[d];
      }
    }
    if (heat)
      heat->complete(result);
    return result;
  }

  template class SurfaceContact<2>;
  template class SurfaceContact<3>;
} // namespace tombolo
