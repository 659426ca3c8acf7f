// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/penalty_contact.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/contact_candidates.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
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
  void PenaltyContact<dim>::declare_parameters(ParameterHandler &handler)
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
  void PenaltyContact<dim>::validate(const Section &section, const bool has_heat)
  {
    ContactSettings settings(section, has_heat);
    create_surface<dim>(section);
    if (has_heat)
      ToolHeat<dim>::create(section);
    validate_contact_candidates<dim>(section);
  }

  template <int dim>
  PenaltyContact<dim>::PenaltyContact(const Section &section, const Mesh<dim> &mesh,
                                      const Nodes<dim> &nodes, const NodalState &state,
                                      const std::vector<bool> &can_be_exposed, const bool has_heat,
                                      const std::vector<double> &volume)
      : contact_name(section.name()), communicator(nodes.communicator()),
        settings(section, has_heat), surface(create_surface<dim>(section)),
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
  double PenaltyContact<dim>::mass_ratio(const NodalState &state) const
  {
    const double tool_mass = surface->translation().mass();
    if (tool_mass == 0.)
      return 1.;
    double mass = 0;
    for (std::size_t k = 0; k < candidates.size(); ++k)
      if (gap[k] < 0.)
        mass += *state.mass.node(candidates[k]);
    return 1. + ordered_sum(mass, communicator) / tool_mass;
  }

  template <int dim>
  double PenaltyContact<dim>::enthalpy(const std::size_t candidate,
                                       const NodalHeat &nodal_heat) const
  {
    const unsigned int node = candidates[candidate];
    return nodal_heat.enthalpy->enthalpy(node, *nodal_heat.temperature->node(node)) +
           (nodal_heat.pending != nullptr ? *nodal_heat.pending->node(node)
                                          : pending_heat[candidate]);
  }

  template <int dim>
  void PenaltyContact<dim>::add_friction_heat(const std::size_t candidate, const double heat)
  {
    friction_heat += heat;
    if (settings.has_heat)
      pending_heat[candidate] += settings.heat_fraction * heat;
  }

  template <int dim>
  void PenaltyContact<dim>::add_forces(const NodalState &state, const Clock &clock,
                                       NodalVector &loads, std::vector<unsigned int> &loaded_nodes,
                                       const NodalHeat &nodal_heat)
  {
    surface->evaluate_gaps(state.position, candidates, clock.time, gap);
    force_sum = 0.;
    torque_sum = 0.;
    friction_heat_of_tool = 0.;
    position_of_surface = surface->reference_point(clock.time);
    if (!(clock.stable_step > 0.)) // the very start, where nothing touches yet
      return;
    const double begin = clock.time - clock.previous_step;
    const Tensor<1, dim> translation = surface->translation().displacement(clock.time) -
                                       surface->translation().displacement(begin);
    const double ratio = mass_ratio(state);
    const double friction_heat_before = friction_heat;
    if (tool_heat)
      tool_heat->begin_step(state.position);
    for (std::size_t k = 0; k < candidates.size(); ++k)
    {
      NodeHistory &history = histories[k];
      const auto x = vector_of<dim>(state.position.node(candidates[k]));
      const bool is_behind = gap[k] < 0.;
      if (!is_behind && !history.spring.is_closed())
      {
        history.position = x;
        continue;
      }
      const double mass = *state.mass.node(candidates[k]) / ratio;
      const bool has_eroded = mass == 0.;
      if (has_eroded && !history.spring.is_closed())
        continue;
      const Tensor<1, dim> of_surface = surface->motion(x, begin, clock.time);
      const Tensor<1, dim> motion = x - history.position - of_surface;
      const Tensor<1, dim> normal = surface->normal(x, clock.time);
      const Tensor<1, dim> force_before = history.force;
      history.position = x;
      if (!is_behind || has_eroded)
        release(k, motion, normal, has_eroded);
      else
      {
        press(k, motion, normal, mass, clock, nodal_heat);
        force_sum += history.force;
        torque_sum += torque<dim>(x - position_of_surface, history.force);
        for (unsigned int d = 0; d < dim; ++d)
          loads.node(candidates[k])[d] += history.force[d];
        loaded_nodes.push_back(candidates[k]);
      }
      surface_work += 0.5 * (force_before + history.force) * of_surface;
      translation_work += 0.5 * (force_before + history.force) * translation;
    }
    friction_heat_of_tool = (1. - settings.heat_fraction) * (friction_heat - friction_heat_before);
  }

  template <int dim>
  void PenaltyContact<dim>::press(const std::size_t candidate, const Tensor<1, dim> &motion,
                                  const Tensor<1, dim> &normal, const double mass,
                                  const Clock &clock, const NodalHeat &nodal_heat)
  {
    NodeHistory &history = histories[candidate];
    ContactSpring<dim> &spring = history.spring;
    settings.law.press(-gap[candidate], motion, normal, mass, clock.stable_step,
                       clock.previous_step, spring, damping_heat);
    if (settings.friction.largest() > 0.)
    {
      double friction = settings.friction.largest();
      if (!settings.friction.is_constant())
        friction = settings.friction.value(nodal_heat.enthalpy->temperature(
            candidates[candidate], enthalpy(candidate, nodal_heat)));
      add_friction_heat(candidate, ContactLaw::slide(motion, normal, friction, spring));
    }
    const double normal_force = spring.normal_force();
    history.force = normal_force * normal - spring.stiffness * spring.elastic_slip;
    if (tool_heat)
      tool_heat->add_contact(candidate, candidates[candidate], normal_force, normal,
                             clock.previous_step);
  }

  template <int dim>
  void PenaltyContact<dim>::release(const std::size_t candidate, const Tensor<1, dim> &motion,
                                    const Tensor<1, dim> &normal, const bool has_eroded)
  {
    NodeHistory &history = histories[candidate];
    add_friction_heat(candidate, ContactLaw::release(-(motion * normal), has_eroded, history.spring,
                                                     damping_heat));
    history.force = 0.;
  }

  template <int dim>
  void PenaltyContact<dim>::exchange_heat(const NodalHeat &nodal_heat)
  {
    if (tool_heat)
      tool_heat->end_step(
          friction_heat_of_tool, nodal_heat,
          [&](const std::size_t k) { return enthalpy(k, nodal_heat); }, pending_heat, communicator);
  }

  template <int dim>
  void PenaltyContact<dim>::complete_step(const Clock &clock)
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
  void PenaltyContact<dim>::add_pending_heat(NodalVector &heat) const
  {
    for (std::size_t k = 0; k < pending_heat.size(); ++k)
      heat.node(candidates[k])[0] += pending_heat[k];
  }

  template <int dim>
  void PenaltyContact<dim>::add_heat(NodalVector &heat)
  {
    add_pending_heat(heat);
    std::fill(pending_heat.begin(), pending_heat.end(), 0.);
  }

  template <int dim>
  double PenaltyContact<dim>::heat_to_give() const
  {
    return std::accumulate(pending_heat.begin(), pending_heat.end(), 0.);
  }

  template <int dim>
  void PenaltyContact<dim>::add_present_forces(NodalVector &forces) const
  {
    for (std::size_t k = 0; k < candidates.size(); ++k)
      for (unsigned int d = 0; d < dim; ++d)
        forces.node(candidates[k])[d] += histories[k].force[d];
  }

  template <int dim>
  ContactBalance PenaltyContact<dim>::balance(const MPI_Comm communicator) const
  {
    ContactBalance result;
    double elastic = 0, n_nodes = 0, deepest = 0;
    for (const NodeHistory &history : histories)
    {
      elastic += history.spring.elastic_energy();
      n_nodes += history.spring.is_closed() ? 1. : 0.;
      deepest = std::max(deepest, history.spring.depth);
    }
    std::vector<double> sums = {elastic,
                                friction_heat,
                                damping_heat,
                                surface_work,
                                n_nodes,
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
    result.penetration = Utilities::MPI::max(deepest, communicator);

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
  void PenaltyContact<dim>::serialize(StateArchive &archive)
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

    std::vector<std::array<double, 3>> scalars, slips(histories.size()), forces(slips),
        positions(slips);
    for (std::size_t k = 0; k < histories.size(); ++k)
    {
      const NodeHistory &history = histories[k];
      const ContactSpring<dim> &spring = history.spring;
      scalars.push_back({{spring.stiffness, spring.depth, spring.damping_force}});
      for (unsigned int d = 0; d < dim; ++d)
      {
        slips[k][d] = spring.elastic_slip[d];
        forces[k][d] = history.force[d];
        positions[k][d] = history.position[d];
      }
    }
    archive.nodal("stiffness, depth, damping force", candidates, scalars);
    archive.nodal("bond", candidates, slips);
    archive.nodal("force", candidates, forces);
    archive.nodal("position", candidates, positions);
    for (std::size_t k = 0; k < histories.size(); ++k)
    {
      NodeHistory &history = histories[k];
      history.spring.stiffness = scalars[k][0];
      history.spring.depth = scalars[k][1];
      history.spring.damping_force = scalars[k][2];
      for (unsigned int d = 0; d < dim; ++d)
      {
        history.spring.elastic_slip[d] = slips[k][d];
        history.force[d] = forces[k][d];
        history.position[d] = positions[k][d];
      }
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

  template class PenaltyContact<2>;
  template class PenaltyContact<3>;
} // namespace tombolo
