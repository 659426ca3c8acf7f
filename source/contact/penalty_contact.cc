// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/penalty_contact.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <array>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  PenaltyContact<dim>::PenaltyContact(const Section &section, const Mesh<dim> &mesh,
                                      const Nodes<dim> &nodes, const NodalState &state,
                                      const std::vector<bool> &can_be_exposed, const bool has_heat,
                                      const std::vector<double> &volume)
      : SurfaceContact<dim>(section, mesh, nodes, state, can_be_exposed, has_heat, volume),
        springs(this->candidates.size())
  {}

  template <int dim>
  double PenaltyContact<dim>::mass_ratio(const NodalState &state) const
  {
    const double tool_mass = this->surface->translation().mass();
    if (tool_mass == 0.)
      return 1.;
    double mass = 0;
    for (std::size_t k = 0; k < this->candidates.size(); ++k)
      if (this->gap[k] < 0.)
        mass += *state.mass.node(this->candidates[k]);
    return 1. + ordered_sum(mass, this->communicator) / tool_mass;
  }

  template <int dim>
  void PenaltyContact<dim>::add_forces(const NodalState &state, const Clock &clock,
                                       NodalVector &loads, std::vector<unsigned int> &loaded_nodes,
                                       const NodalHeat &nodal_heat)
  {
    const ContactSurface<dim> &surface = *this->surface;
    const std::vector<unsigned int> &candidates = this->candidates;
    surface.evaluate_gaps(state.position, candidates, clock.time, this->gap);
    this->begin_forces(state, clock);
    if (!(clock.stable_step > 0.)) // the very start, where nothing touches yet
    {
      this->forget_motion(state);
      return;
    }
    const double begin = clock.time - clock.previous_step;
    const RigidTranslation<dim> &of_tool = this->surface->translation();
    const Tensor<1, dim> translation =
        of_tool.displacement(clock.time) - of_tool.displacement(begin);
    const double ratio = mass_ratio(state);
    const double friction_heat_before = this->friction_heat;
    for (std::size_t k = 0; k < candidates.size(); ++k)
    {
      NodeHistory &history = this->histories[k];
      const auto x = vector_of<dim>(state.position.node(candidates[k]));
      const bool is_behind = this->gap[k] < this->touch_distance;
      if (!is_behind && !springs[k].is_closed())
      {
        history.position = x;
        continue;
      }
      const double mass = *state.mass.node(candidates[k]) / ratio;
      const bool has_eroded = mass == 0.;
      if (has_eroded && !springs[k].is_closed())
        continue;
      const Tensor<1, dim> of_surface = surface.motion(x, begin, clock.time);
      const Tensor<1, dim> motion = x - history.position - of_surface;
      const Tensor<1, dim> normal = surface.normal(x, clock.time);
      const Tensor<1, dim> force_before = history.force;
      history.position = x;
      if (!is_behind || has_eroded)
        release(k, motion, normal, has_eroded);
      else
      {
        press(k, motion, normal, mass, clock, nodal_heat);
        this->add_force(history, x);
        for (unsigned int d = 0; d < dim; ++d)
          loads.node(candidates[k])[d] += history.force[d];
        loaded_nodes.push_back(candidates[k]);
      }
      this->add_surface_work(force_before + history.force, of_surface, translation);
    }
    this->friction_heat_of_tool =
        (1. - this->settings.heat_fraction) * (this->friction_heat - friction_heat_before);
  }

  template <int dim>
  void PenaltyContact<dim>::press(const std::size_t candidate, const Tensor<1, dim> &motion,
                                  const Tensor<1, dim> &normal, const double mass,
                                  const Clock &clock, const NodalHeat &nodal_heat)
  {
    ContactSpring<dim> &spring = springs[candidate];
    this->settings.law.press(std::max(0., -this->gap[candidate]), motion, normal, mass,
                             clock.stable_step, clock.previous_step, spring, this->damping_heat);
    if (this->settings.friction.largest() > 0.)
      this->add_friction_heat(
          candidate, ContactLaw::slide(motion, normal,
                                       this->friction_coefficient(candidate, nodal_heat), spring));
    const double normal_force = spring.normal_force();
    this->histories[candidate].force =
        normal_force * normal - spring.stiffness * spring.elastic_slip;
    if (this->tool_heat)
      this->tool_heat->add_contact(candidate, this->candidates[candidate], normal_force, normal,
                                   clock.previous_step);
  }

  template <int dim>
  void PenaltyContact<dim>::release(const std::size_t candidate, const Tensor<1, dim> &motion,
                                    const Tensor<1, dim> &normal, const bool has_eroded)
  {
    this->add_friction_heat(candidate, ContactLaw::release(-(motion * normal), has_eroded,
                                                           springs[candidate], this->damping_heat));
    this->histories[candidate].force = 0.;
  }

  template <int dim>
  void PenaltyContact<dim>::begin_trial(const NodalState &state, const Clock &clock)
  {
    SurfaceContact<dim>::begin_trial(state, clock);
    committed_springs = springs;
  }

  template <int dim>
  void PenaltyContact<dim>::restart_trial()
  {
    SurfaceContact<dim>::restart_trial();
    springs = committed_springs;
  }

  template <int dim>
  void PenaltyContact<dim>::find_stiffness(const NodalState &state, const Clock &clock,
                                           std::vector<ContactStiffness<dim>> &result)
  {
    for (std::size_t k = 0; k < springs.size(); ++k)
    {
      if (!springs[k].is_closed())
        continue;
      const auto x = vector_of<dim>(state.position.node(this->candidates[k]));
      ContactStiffness<dim> stiffness;
      stiffness.node = this->candidates[k];
      stiffness.direction = this->surface->normal(x, clock.time);
      stiffness.entries = {
          {state.partition()->global_index(stiffness.node), stiffness.direction, 1.}};
      add_spring(springs[k], 1., stiffness);
      stiffness.along += curvature_stiffness(*this->surface, x, springs[k].normal_force(),
                                             clock.time, this->way_along_surface());
      result.push_back(std::move(stiffness));
    }
  }

  template <int dim>
  double PenaltyContact<dim>::stable_fraction() const
  {
    return this->settings.law.stable_fraction();
  }

  template <int dim>
  typename PenaltyContact<dim>::NodeSums PenaltyContact<dim>::node_sums() const
  {
    NodeSums sums;
    for (const ContactSpring<dim> &spring : springs)
    {
      sums.elastic += spring.elastic_energy();
      sums.n_nodes += spring.is_closed() ? 1. : 0.;
      sums.deepest = std::max(sums.deepest, spring.depth);
    }
    return sums;
  }

  template <int dim>
  void PenaltyContact<dim>::serialize_nodes(StateArchive &archive)
  {
    std::vector<std::array<double, 3>> scalars, slips(springs.size());
    for (std::size_t k = 0; k < springs.size(); ++k)
    {
      scalars.push_back({{springs[k].stiffness, springs[k].depth, springs[k].damping_force}});
      for (unsigned int d = 0; d < dim; ++d)
        slips[k][d] = springs[k].elastic_slip[d];
    }
    archive.nodal("stiffness, depth, damping force", this->candidates, scalars);
    archive.nodal("bond", this->candidates, slips);
    for (std::size_t k = 0; k < springs.size(); ++k)
    {
      springs[k].stiffness = scalars[k][0];
      springs[k].depth = scalars[k][1];
      springs[k].damping_force = scalars[k][2];
      for (unsigned int d = 0; d < dim; ++d)
        springs[k].elastic_slip[d] = slips[k][d];
    }
  }

  template <int dim>
  void PenaltyContact<dim>::continue_nodes(StateArchive &archive)
  {
    if (archive.has("bond"))
      serialize_nodes(archive);
  }

  template class PenaltyContact<2>;
  template class PenaltyContact<3>;
} // namespace tombolo
