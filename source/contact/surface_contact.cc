// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surface_contact.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/contact_candidates.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    std::unique_ptr<ContactSurface<dim>> create_surface(const Section &section)
    {
      const std::string name = section.get("Surface");
      return Registry<ContactSurface<dim>>::instance().create(name, section.subsection(name));
    }
  } // namespace

  template <int dim>
  void SurfaceContact<dim>::declare_parameters(ParameterHandler &handler)
  {
    Parameters::declare_mandatory(
        handler, "Surface",
        Patterns::Selection(Registry<ContactSurface<dim>>::instance().selection()),
        "The rigid surface.");
    Registry<ContactSurface<dim>>::instance().declare_all(handler);
    declare_contact_candidates(handler);
    ContactSettings::declare_parameters(handler);
    ToolHeat<dim>::declare_parameters(handler);
  }

  template <int dim>
  void SurfaceContact<dim>::validate(const Section &section, const bool has_heat)
  {
    const Parameters &parameters = section.all();
    parameters.attempt([&] { ContactSettings settings(section, has_heat); });
    parameters.attempt([&] { create_surface<dim>(section); });
    if (has_heat)
      parameters.attempt([&] { ToolHeat<dim>::create(section); });
    parameters.attempt([&] { validate_contact_candidates<dim>(section); });
  }

  template <int dim>
  SurfaceContact<dim>::SurfaceContact(const Section &section, const Mesh<dim> &mesh,
                                      const Nodes<dim> &nodes, const NodalState &state,
                                      const std::vector<bool> &can_be_exposed, const bool has_heat,
                                      const std::vector<double> &volume)
      : communicator(nodes.communicator()), settings(section, has_heat),
        surface(create_surface<dim>(section)), contact_name(section.name()),
        position_of_surface(surface->reference_point(0.))
  {
    surface->load(nodes.communicator());
    const NodePartition &partition = *state.partition();
    const std::set<types::boundary_id> boundaries = contact_boundaries(section, mesh);
    candidates = find_contact_candidates(section, boundaries, nodes, state, can_be_exposed);
    surface->evaluate_gaps(state.initial_position, candidates, 0., gap);
    refuse_penetration(section, nodes, state, candidates, gap);

    histories.resize(candidates.size());
    pending_heat.assign(settings.has_heat ? candidates.size() : 0, 0.);
    for (std::size_t k = 0; k < candidates.size(); ++k)
      histories[k].position = vector_of<dim>(state.position.node(candidates[k]));

    if (const Symmetry *const symmetry = partition.symmetry())
      for (const SymmetryPlane &plane : symmetry->planes)
        if (surface->translation().moves_along(plane.axis))
          section.subsection(section.get("Surface"))
              .fail("Directions", std::string("a body with a mass would move out of a plane of "
                                              "symmetry; allowed are directions without ") +
                                      "xyz"[plane.axis] + ".");
    if (has_heat)
      tool_heat = ToolHeat<dim>::create(section);
    if (tool_heat)
      tool_heat->set_nodes(nodes, boundaries, candidates, volume);
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
  void SurfaceContact<dim>::add_friction_heat(const std::size_t candidate, const double heat)
  {
    friction_heat += heat;
    if (settings.has_heat)
      pending_heat[candidate] += settings.heat_fraction * heat;
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
    force_sum = 0.;
    torque_sum = 0.;
    friction_heat_of_tool = 0.;
    position_of_surface = surface->reference_point(clock.time);
    if (tool_heat && clock.stable_step > 0.)
      tool_heat->begin_step(state.position);
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
  void SurfaceContact<dim>::add_force(const NodeHistory &history, const Tensor<1, dim> &x)
  {
    force_sum += history.force;
    torque_sum += torque<dim>(x - position_of_surface, history.force);
  }

  template <int dim>
  void SurfaceContact<dim>::add_surface_work(const Tensor<1, dim> &sum_of_forces,
                                             const Tensor<1, dim> &of_surface,
                                             const Tensor<1, dim> &translation)
  {
    surface_work += 0.5 * sum_of_forces * of_surface;
    translation_work += 0.5 * sum_of_forces * translation;
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
    impulse += clock.velocity_step() * force_sum;
    angular_impulse += clock.velocity_step() * torque_sum;
    if (!surface->translation().has_mass())
      return;
    std::array<double, dim> on_bodies;
    for (unsigned int d = 0; d < dim; ++d)
      on_bodies[d] = force_sum[d];
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
  ContactBalance SurfaceContact<dim>::balance(const MPI_Comm communicator) const
  {
    ContactBalance result;
    const NodeSums of_nodes = node_sums();
    std::vector<double> sums = {of_nodes.elastic,
                                friction_heat,
                                damping_heat,
                                surface_work,
                                of_nodes.n_nodes,
                                translation_work,
                                tool_heat ? tool_heat->conducted() : 0.};
    constexpr std::size_t first_vector = 7;
    for (unsigned int d = 0; d < dim; ++d)
    {
      sums.push_back(force_sum[d]);
      sums.push_back(impulse[d]);
    }
    for (unsigned int c = 0; c < 3; ++c)
      sums.push_back(angular_impulse[c]);
    sums = ordered_sum(sums, communicator);
    result.elastic = sums[0];
    result.friction = sums[1];
    result.damping = sums[2];
    result.work = sums[3];
    result.n_nodes = sums[4];
    for (unsigned int d = 0; d < dim; ++d)
    {
      result.force[d] = sums[first_vector + 2 * d];
      result.impulse[d] = sums[first_vector + 1 + 2 * d];
    }
    std::copy_n(sums.end() - 3, 3, result.angular_impulse.begin());
    result.penetration = Utilities::MPI::max(of_nodes.deepest, communicator);

    const double of_translation = sums[5];
    const RigidTranslation<dim> &translation = surface->translation();
    result.external_work = translation.has_mass()
                               ? result.work - of_translation + translation.work_of_force()
                               : result.work;
    result.tool_kinetic = translation.kinetic_energy();
    for (unsigned int d = 0; d < dim; ++d)
    {
      result.position[d] = position_of_surface[d];
      if (translation.has_mass())
      {
        result.velocity[d] = translation.velocity()[d];
        result.tool_momentum[d] = translation.mass() * result.velocity[d];
      }
    }
    if (!settings.has_heat)
      return result;
    result.conducted = sums[6];
    result.heat_of_bodies = settings.heat_fraction * result.friction + result.conducted;
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
    std::vector<double *> shares{&friction_heat, &damping_heat, &surface_work, &translation_work};
    for (unsigned int d = 0; d < dim; ++d)
    {
      shares.push_back(&impulse[d]);
      shares.push_back(&force_sum[d]);
    }
    for (unsigned int c = 0; c < 3; ++c)
    {
      shares.push_back(&angular_impulse[c]);
      shares.push_back(&torque_sum[c]);
    }
    archive.sums("heat, work and impulse", shares);

    serialize_nodes(archive);
    std::vector<std::array<double, 3>> forces(histories.size()), positions(histories.size());
    for (std::size_t k = 0; k < histories.size(); ++k)
      for (unsigned int d = 0; d < dim; ++d)
      {
        forces[k][d] = histories[k].force[d];
        positions[k][d] = histories[k].position[d];
      }
    archive.nodal("force", candidates, forces);
    archive.nodal("position", candidates, positions);
    for (std::size_t k = 0; k < histories.size(); ++k)
      for (unsigned int d = 0; d < dim; ++d)
      {
        histories[k].force[d] = forces[k][d];
        histories[k].position[d] = positions[k][d];
      }
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
