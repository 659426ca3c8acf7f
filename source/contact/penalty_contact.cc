// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/penalty_contact.h>

#include <tombolo/contact/nodal_geometry.h>

#include <utility>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  PenaltyContact<dim>::PenaltyContact(const Section &section, const Mesh<dim> &mesh,
                                      const Nodes<dim> &nodes, const NodalState &state,
                                      const std::vector<bool> &can_be_exposed, const bool has_heat,
                                      const std::vector<double> &volume, MasterPart<dim> master)
      : SpringContact<dim>(section, mesh, nodes, state, can_be_exposed, has_heat, volume,
                           std::move(master))
  {}

  template <int dim>
  double PenaltyContact<dim>::mass_behind(const NodalState &state) const
  {
    double mass = 0;
    for (std::size_t k = 0; k < this->candidates.size(); ++k)
      if (this->gap[k] < 0.)
        mass += *state.mass.node(this->candidates[k]);
    return mass;
  }

  template <int dim>
  void PenaltyContact<dim>::find_places(const NodalState &state)
  {
    std::vector<std::size_t> in_contact;
    for (std::size_t k = 0; k < this->candidates.size(); ++k)
      if (this->gap[k] < this->touch_distance || this->springs[k].is_closed())
        in_contact.push_back(k);
    this->part->find_places(state, this->candidates, in_contact);
  }

  template <int dim>
  typename PenaltyContact<dim>::Below
  PenaltyContact<dim>::below(const std::size_t candidate, const Tensor<1, dim> &x,
                             const Clock &clock, const double mass_ratio) const
  {
    if (this->part)
    {
      const auto &place = this->part->place(candidate);
      return {place.normal, place.motion, 1. + place.crowding};
    }
    const double begin = clock.time - clock.previous_step;
    return {this->surface->normal(x, clock.time), this->surface->motion(x, begin, clock.time),
            mass_ratio};
  }

  template <int dim>
  void PenaltyContact<dim>::add_forces(const NodalState &state, const Clock &clock,
                                       NodalVector &loads, std::vector<unsigned int> &loaded_nodes,
                                       const NodalHeat &nodal_heat)
  {
    const std::vector<unsigned int> &candidates = this->candidates;
    if (this->part)
      this->find_surroundings(state);
    this->find_gaps(state.position, candidates, clock.time, this->gap);
    this->begin_forces(state, clock, nodal_heat);
    if (!(clock.stable_step > 0.)) // the very start, where nothing touches yet
    {
      this->forget_motion(state);
      return;
    }
    const double begin = clock.time - clock.previous_step;
    const RigidTranslation<dim> &of_tool = this->surface->translation();
    const Tensor<1, dim> translation =
        of_tool.displacement(clock.time) - of_tool.displacement(begin);
    const double ratio = this->mass_ratio(mass_behind(state));
    if (this->part)
      find_places(state);
    auto &springs = this->springs;
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
      const bool has_eroded = *state.mass.node(candidates[k]) == 0.;
      if (has_eroded && !springs[k].is_closed())
        continue;
      const Below below = this->below(k, x, clock, ratio);
      const double mass = *state.mass.node(candidates[k]) / below.mass_ratio;
      const Tensor<1, dim> &of_surface = below.motion, &normal = below.normal;
      const Tensor<1, dim> motion = x - history.position - of_surface;
      const Tensor<1, dim> force_before = history.force;
      history.position = x;
      if (!is_behind || has_eroded)
      {
        // A node that leaves a part across an edge is as deep as it was.
        const double approach = -(motion * normal);
        const bool is_cut = has_eroded || (this->part && springs[k].depth + approach > 0.);
        this->release(k, approach, is_cut, nodal_heat);
        history.force = 0.;
      }
      else
      {
        this->press(k, {-this->gap[k], motion, normal, mass}, clock, nodal_heat);
        history.force = springs[k].force(normal);
        this->of_surface.add_force(history.force, x);
        for (unsigned int d = 0; d < dim; ++d)
          loads.node(candidates[k])[d] += history.force[d];
        loaded_nodes.push_back(candidates[k]);
        if (this->part)
          this->part->add_reaction(this->part->place(k), history.force);
      }
      this->of_surface.add_work(force_before + history.force, of_surface, translation);
    }
    if (this->part)
      this->part->collect_reactions(loads, loaded_nodes);
    this->end_forces(friction_heat_before);
  }

  template <int dim>
  std::vector<double> PenaltyContact<dim>::depths_at(const NodalVector &position,
                                                     const Clock &clock)
  {
    std::vector<double> result;
    this->find_gaps(position, this->candidates, clock.time, result);
    for (double &of_node : result)
      of_node = -of_node;
    return result;
  }

  template <int dim>
  void PenaltyContact<dim>::find_stiffness(const NodalState &state, const Clock &clock,
                                           std::vector<ContactStiffness<dim>> &result)
  {
    for (std::size_t k = 0; k < this->springs.size(); ++k)
    {
      if (!this->springs[k].is_closed())
        continue;
      const auto x = vector_of<dim>(state.position.node(this->candidates[k]));
      ContactStiffness<dim> stiffness;
      stiffness.node = this->candidates[k];
      stiffness.direction = this->surface->normal(x, clock.time);
      stiffness.entries = {
          {state.partition()->global_index(stiffness.node), stiffness.direction, 1.}};
      add_spring(this->springs[k], 1., stiffness);
      stiffness.along += curvature_stiffness(*this->surface, x, this->springs[k].normal_force(),
                                             clock.time, this->way_along_surface());
      result.push_back(std::move(stiffness));
    }
  }

  template class PenaltyContact<2>;
  template class PenaltyContact<3>;
} // namespace tombolo
