// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/kinematic_contact.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/nodal_geometry.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** A node whose free components make up less than this of the normal, squared, is held. */
    constexpr double smallest_free_share = 0.01;

    template <int dim>
    Tensor<1, dim> along_surface(const Tensor<1, dim> &vector, const Tensor<1, dim> &normal)
    {
      return vector - (vector * normal) * normal;
    }
  } // namespace

  template <int dim>
  KinematicContact<dim>::KinematicContact(ContactScene<dim> &scene)
      : SurfaceContact<dim>(scene), normal_forces(this->candidates.size())
  {
    this->records.sums("loss of tool", loss_of_tool);
    this->records.at_nodes(this->candidates, normal_forces)
        .vector(
            "normal force", [](Tensor<1, dim> & force) -> auto & { return force; });
  }

  template <int dim>
  double KinematicContact<dim>::least_gap(const NodalVector &guess, const Clock &clock)
  {
    this->find_gaps(guess, this->candidates, clock.time + clock.next_step, this->gap);
    double least = std::numeric_limits<double>::max();
    for (const double of_candidate : this->gap)
      least = std::min(least, of_candidate);
    if (this->surface->translation().has_mass())
      least -= this->surface->translation().free_motion(clock).norm();
    return least;
  }

  template <int dim>
  double KinematicContact<dim>::begin_step(const NodalState &state, const NodalVector &predicted,
                                           const NodalVector &mass,
                                           const std::vector<std::uint8_t> &constrained,
                                           const Clock &clock, const NodalHeat &nodal_heat)
  {
    const ContactSurface<dim> &surface = *this->surface;
    const std::vector<unsigned int> &candidates = this->candidates;
    const double end = clock.time + clock.next_step;
    const bool has_mass = this->surface->translation().has_mass();
    const Tensor<1, dim> free_motion =
        has_mass ? this->surface->translation().free_motion(clock) : Tensor<1, dim>();
    if (has_mass)
      find_places_from_mass(predicted, free_motion);
    const NodalVector &places = has_mass ? places_from_mass : predicted;
    this->find_gaps(places, candidates, end, this->gap);
    this->find_surroundings(state);
    constraints.clear();
    double largest = 0;
    for (std::size_t k = 0; k < candidates.size(); ++k)
    {
      const unsigned int node = candidates[k];
      if (*state.mass.node(node) == 0. || !(this->gap[k] < 0.))
        continue;
      const auto place = vector_of<dim>(places.node(node));
      const Tensor<1, dim> motion = place - vector_of<dim>(state.position.node(node)) -
                                    surface.motion(place, clock.time, end);
      add_constraint(k, place, motion, mass, constrained.empty() ? 0u : constrained[node], clock,
                     nodal_heat);
      if (!constraints.empty() && constraints.back().candidate == k)
        largest = std::max(largest, -this->gap[k]);
    }
    return largest;
  }

  template <int dim>
  void KinematicContact<dim>::find_places_from_mass(const NodalVector &predicted,
                                                    const Tensor<1, dim> &free_motion)
  {
    places_from_mass.fit_to(predicted.partition(), predicted.quantity());
    for (const unsigned int node : this->candidates)
      for (unsigned int d = 0; d < dim; ++d)
        places_from_mass.node(node)[d] = predicted.node(node)[d] - free_motion[d];
  }

  template <int dim>
  void KinematicContact<dim>::add_constraint(const std::size_t candidate,
                                             const Tensor<1, dim> &place,
                                             const Tensor<1, dim> &motion, const NodalVector &mass,
                                             const unsigned int held_components, const Clock &clock,
                                             const NodalHeat &nodal_heat)
  {
    const unsigned int node = this->candidates[candidate];
    Constraint constraint;
    constraint.candidate = candidate;
    constraint.gap = this->gap[candidate];
    constraint.normal = this->surface->normal(place, clock.time + clock.next_step);
    constraint.slip = along_surface(motion, constraint.normal);
    constraint.friction = this->friction_coefficient(candidate, nodal_heat);
    constraint.shear_limit = this->shear_limit(candidate, this->area(candidate, constraint.normal));
    constraint.mass = std::numeric_limits<double>::max();
    double free_share = 0;
    for (unsigned int d = 0; d < dim; ++d)
    {
      constraint.mass =
          std::min(constraint.mass, mass.node(node)[mass.n_slots_per_node() == 1 ? 0 : d]);
      if (!((held_components >> d) & 1u))
        free_share += constraint.normal[d] * constraint.normal[d];
    }
    if (free_share < smallest_free_share)
      return;
    // The forces of the last step are the first ones to try.
    const Tensor<1, dim> &normal_force = normal_forces[candidate];
    constraint.normal_force = constraint.trial_normal_force =
        std::max(0., normal_force * constraint.normal);
    constraint.friction_force = constraint.trial_friction_force =
        along_surface(this->histories[candidate].force - normal_force, constraint.normal);
    constraints.push_back(constraint);
  }

  template <int dim>
  void KinematicContact<dim>::append_nodes_behind(std::vector<unsigned int> &nodes) const
  {
    for (const Constraint &constraint : constraints)
      nodes.push_back(this->candidates[constraint.candidate]);
  }

  template <int dim>
  void KinematicContact<dim>::count_constraints(NodalVector &count) const
  {
    for (const Constraint &constraint : constraints)
      *count.node(this->candidates[constraint.candidate]) += 1.;
  }

  template <int dim>
  void KinematicContact<dim>::share_masses(const NodalVector &count)
  {
    double mass = 0;
    for (Constraint &constraint : constraints)
    {
      constraint.mass /= *count.node(this->candidates[constraint.candidate]);
      mass += constraint.mass;
    }
    if (!this->surface->translation().has_mass())
      return;
    const double ratio =
        1. + ordered_sum(mass, this->communicator) / this->surface->translation().mass();
    for (Constraint &constraint : constraints)
      constraint.mass /= ratio;
  }

  template <int dim>
  void KinematicContact<dim>::add_trial_forces(NodalVector &loads) const
  {
    for (const Constraint &constraint : constraints)
    {
      const Tensor<1, dim> force =
          constraint.trial_normal_force * constraint.normal + constraint.trial_friction_force;
      for (unsigned int d = 0; d < dim; ++d)
        loads.node(this->candidates[constraint.candidate])[d] += force[d];
    }
  }

  template <int dim>
  Tensor<1, dim> KinematicContact<dim>::response_of_surface() const
  {
    if (!this->surface->translation().has_mass())
      return Tensor<1, dim>();
    std::array<double, dim> sum{};
    for (const Constraint &constraint : constraints)
      for (unsigned int d = 0; d < dim; ++d)
        sum[d] += constraint.trial_normal_force * constraint.normal[d] +
                  constraint.trial_friction_force[d];
    sum = ordered_sum(sum, this->communicator);
    Tensor<1, dim> reaction;
    for (unsigned int d = 0; d < dim; ++d)
      reaction[d] = -sum[d];
    return this->surface->translation().motion_by(reaction, 1.);
  }

  template <int dim>
  double KinematicContact<dim>::correct(const NodalVector &response, const Clock &clock,
                                        const double momentum)
  {
    const double compliance = clock.next_step * clock.velocity_step();
    const Tensor<1, dim> of_surface = response_of_surface();
    double largest = 0;
    for (Constraint &c : constraints)
    {
      c.response = compliance * vector_of<dim>(response.node(this->candidates[c.candidate]));
      c.response_of_surface = compliance * of_surface;
      const Tensor<1, dim> relative = c.response - c.response_of_surface;
      const double per_mass = compliance / c.mass;
      const double normal_before = c.normal_force;
      c.normal_force =
          std::max(0., c.trial_normal_force - (c.gap + relative * c.normal) / per_mass);
      const Tensor<1, dim> friction_before = c.friction_force;
      c.friction_force = 0.;
      if (const double limit = std::min(c.friction * c.normal_force, c.shear_limit); limit > 0.)
      {
        c.friction_force =
            c.trial_friction_force - (c.slip + along_surface(relative, c.normal)) / per_mass;
        const double norm = c.friction_force.norm();
        if (norm > limit)
          c.friction_force *= limit / norm;
      }
      const double normal_change = c.normal_force - normal_before;
      const Tensor<1, dim> friction_change = c.friction_force - friction_before;
      largest = std::max(largest, per_mass * std::sqrt(normal_change * normal_change +
                                                       friction_change.norm_square()));
      c.trial_normal_force = c.normal_force + momentum * normal_change;
      c.trial_friction_force = c.friction_force + momentum * friction_change;
    }
    return largest;
  }

  template <int dim>
  void KinematicContact<dim>::end_step(const NodalState &state, const Clock &clock,
                                       const NodalHeat &nodal_heat, NodalVector &loads,
                                       std::vector<unsigned int> &loaded_nodes)
  {
    this->begin_forces(state, clock, nodal_heat);
    measure_depths(state, clock.time);
    const double begin = clock.time - clock.previous_step;
    if (clock.step > 0)
      this->totals.damping += std::exchange(loss_of_tool, 0.);
    auto constraint = constraints.begin();
    for (std::size_t k = 0; k < this->candidates.size(); ++k)
    {
      NodeHistory &history = this->histories[k];
      const unsigned int node = this->candidates[k];
      const auto x = vector_of<dim>(state.position.node(node));
      const bool is_behind = constraint != constraints.end() && constraint->candidate == k;
      const bool touches = is_behind && constraint->normal_force > 0.;
      const Tensor<1, dim> normal_force_before = normal_forces[k];
      const Tensor<1, dim> friction_force_before = history.force - normal_force_before;
      Tensor<1, dim> friction_force;
      normal_forces[k] = 0.;
      if (touches)
      {
        normal_forces[k] = constraint->normal_force * constraint->normal;
        friction_force = constraint->friction_force;
      }
      const Tensor<1, dim> force_before = history.force;
      const Tensor<1, dim> force = normal_forces[k] + friction_force;
      if (touches || force_before.norm_square() > 0.)
      {
        const Tensor<1, dim> of_surface = this->surface->motion(x, begin, clock.time);
        const Tensor<1, dim> motion = x - history.position - of_surface;
        this->totals.damping -= 0.5 * (normal_force_before + normal_forces[k]) * motion;
        double friction_heat = -0.5 * (friction_force_before + friction_force) * motion;
        if (touches && clock.step == 0)
        {
          // The kinetic energy of bodies at t_0 lacks the square of what forces change in half a
          // step; that of a tool loses it in the next one.
          this->totals.damping += 0.25 * normal_forces[k] * constraint->response;
          friction_heat += 0.25 * friction_force * constraint->response;
          loss_of_tool -= 0.25 * force * constraint->response_of_surface;
        }
        if (this->settings.friction.largest() > 0.)
          this->add_friction_heat(k, friction_heat, nodal_heat);
        this->set_force(k, x, force, of_surface, touches, loads, loaded_nodes);
      }
      else
        history = {force, x};
      if (touches)
        this->add_contact(k, constraint->normal_force, this->area(k, constraint->normal), clock);
      if (is_behind)
        ++constraint;
    }
    this->end_forces();
    constraints.clear();
  }

  template <int dim>
  void KinematicContact<dim>::measure_depths(const NodalState &state, const double time)
  {
    std::vector<unsigned int> nodes;
    for (std::size_t k = 0; k < this->candidates.size(); ++k)
      if (normal_forces[k].norm_square() > 0.)
        nodes.push_back(this->candidates[k]);
    this->find_gaps(state.position, nodes, time, this->gap);
    deepest = 0.;
    for (std::size_t k = 0; k < nodes.size(); ++k)
      deepest = std::max(deepest, -this->gap[k]);
  }

  template <int dim>
  void KinematicContact<dim>::add_node_sums(ContactBalance &shares) const
  {
    for (const Tensor<1, dim> &force : normal_forces)
      shares.n_nodes += force.norm_square() > 0. ? 1. : 0.;
    shares.penetration = deepest;
  }

  template class KinematicContact<2>;
  template class KinematicContact<3>;
} // namespace tombolo
