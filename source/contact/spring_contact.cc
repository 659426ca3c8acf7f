// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surface_contact.h>

#include <tombolo/base/on_ranks.h>
#include <tombolo/base/ordered_sum.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace tombolo
{
  namespace
  {
    constexpr const char *scalars_of_springs = "stiffness, depth, damping force",
                         *slips_of_springs = "bond";
  } // namespace

  template <int dim>
  SpringContact<dim>::SpringContact(ContactScene<dim> &scene)
      : SurfaceContact<dim>(scene), springs(this->candidates.size())
  {
    using Spring = ContactSpring<dim>;
    this->records.at_nodes(this->candidates, springs)
        .numbers(scalars_of_springs, &Spring::stiffness, &Spring::depth, &Spring::damping_force)
        .vector(slips_of_springs, &Spring::elastic_slip)
        .continues(this->settings.is_of_faces ? "last position" : "");
    this->records.on_division([this, &state = scene.state](StateArchive &archive)
                              { close_springs(state, archive); });
  }

  template <int dim>
  void SpringContact<dim>::press(const std::size_t candidate, const ContactMotion<dim> &move,
                                 const double mass, const double area, const double share,
                                 const Clock &clock, const NodalHeat &nodal_heat)
  {
    ContactSpring<dim> &spring = springs[candidate];
    this->settings.law.press(move, mass, clock.stable_step, clock.previous_step, spring,
                             this->totals.damping);
    if (this->settings.friction.largest() > 0.)
    {
      const double shear_limit = this->shear_limit(candidate, area / share);
      const auto limit_of = [&](const double coefficient)
      { return std::min(coefficient * spring.normal_force(), shear_limit); };
      const auto heat_of = [&](const double coefficient)
      {
        ContactSpring<dim> trial = spring;
        return ContactLaw::slide(move, limit_of(coefficient), trial);
      };
      const double limit = limit_of(this->implicit_friction(candidate, nodal_heat, heat_of));
      spring.limit_follows_pressure = limit < shear_limit;
      this->add_friction_heat(candidate, ContactLaw::slide(move, limit, spring), nodal_heat);
    }
    this->add_contact(candidate, share * spring.normal_force(), area, clock);
  }

  template <int dim>
  double SpringContact<dim>::mean_stiffness() const
  {
    std::array<double, 2> sums{};
    for (const ContactSpring<dim> &spring : springs)
      if (spring.is_closed())
      {
        sums[0] += spring.stiffness;
        sums[1] += 1.;
      }
    sums = ordered_sum(sums, this->communicator);
    return sums[1] > 0. ? sums[0] / sums[1] : std::numeric_limits<double>::max();
  }

  template <int dim>
  void SpringContact<dim>::place_nodes(const NodalState &state, const NodalVector &before,
                                       const Clock &clock)
  {
    SurfaceContact<dim>::place_nodes(state, before, clock);
    const std::vector<double> was = depths_at(before, clock);
    const std::vector<double> is = depths_at(state.position, clock);
    const double mean = mean_stiffness();
    for (std::size_t k = 0; k < springs.size(); ++k)
    {
      const double mass = *state.mass.node(this->candidates[k]);
      if (mass == 0.) // all of its cells have been emptied
        springs[k] = ContactSpring<dim>();
      else if (springs[k].is_closed())
        springs[k].depth = std::max(0., springs[k].depth + is[k] - was[k]);
      else if (is[k] > 0.)
      {
        // Nodes are as deep as those around, whose springs can be softer.
        springs[k].stiffness =
            std::min(mean, this->settings.law.stiffness(mass, clock.stable_step));
        springs[k].depth = is[k];
      }
    }
  }

  template <int dim>
  void SpringContact<dim>::close_springs(const NodalState &state, StateArchive &archive)
  {
    // Where there was no spring, there was none of the mean.
    NodalVector spring_scalars, slips, before;
    spring_scalars.reinit(state.partition(), Quantity::scalars);
    slips.reinit(state.partition());
    archive.nodal(scalars_of_springs, 3, spring_scalars);
    archive.nodal(slips_of_springs, 3, slips);
    before.reinit(state.partition(), Quantity::position);
    before.copy_from(state.position);
    for (std::size_t k = 0; k < springs.size(); ++k)
      for (unsigned int d = 0; d < dim; ++d)
        before.node(this->candidates[k])[d] = this->histories[k].position[d];
    before.update_ghosts();
    const Clock &clock = archive.division()->clock;
    Clock then = clock;
    then.time -= clock.previous_step;
    const std::vector<double> depths = depths_at(before, then);
    const double mean = mean_stiffness();
    for (std::size_t k = 0; k < springs.size(); ++k)
    {
      const unsigned int node = this->candidates[k];
      const double stiffness = *spring_scalars.node(node);
      const double mass_before = *archive.division()->mass.node(node);
      // The stiffness over the area stays: it is as m^(1-1/dim).
      const double ratio = mass_before > 0. ? *state.mass.node(node) / mass_before : 1.;
      if (springs[k].is_closed() && ratio == 1.)
        continue;
      const bool was_closed = springs[k].is_closed();
      springs[k].depth = std::max(0., depths[k]);
      if (!(springs[k].depth > 0.))
      {
        springs[k] = ContactSpring<dim>();
        this->histories[k].force = 0.;
        continue;
      }
      springs[k].stiffness =
          stiffness > 0. ? stiffness * std::pow(ratio, 1. - 1. / dim)
                         : std::min(mean, this->settings.law.stiffness(*state.mass.node(node),
                                                                       clock.previous_step));
      if (!springs[k].is_closed()) // hanging nodes have no mass
      {
        springs[k] = ContactSpring<dim>();
        continue;
      }
      if (!was_closed)
        springs[k].elastic_slip = vector_of<dim>(slips.node(node));
      this->histories[k].force =
          springs[k].force(this->surface->normal(this->histories[k].position, then.time));
    }
  }

  template class SpringContact<2>;
  template class SpringContact<3>;

  /**
   * Contact by penalty springs: each candidate node behind the surface has a spring of ContactLaw,
   * with its mass m̂ and the stable time step Δt, not the present one, so that the safety factor
   * does not change the stiffness. Against a surface with a mass m_t, m̂ / (1 + M/m_t) replaces m̂,
   * with the mass M of all nodes in contact: then the frequency of the springs is that of contact
   * with a surface of prescribed motion. Against a part it is m̂ / (1 + R), see PartSurface, on
   * which the reactions act.
   */
  template <int dim>
  class PenaltyContact : public SpringContact<dim>
  {
  public:
    using SpringContact<dim>::SpringContact;

    void add_forces(const NodalState &state, const Clock &clock, NodalVector &loads,
                    std::vector<unsigned int> &loaded_nodes, const NodalHeat &nodal_heat) override
    {
      const std::vector<unsigned int> &candidates = this->candidates;
      if (this->part)
        this->find_surroundings(state);
      this->find_gaps(state.position, candidates, clock.time, this->gap);
      if (!this->begin_forces(state, clock, nodal_heat))
        return;
      double mass_behind = 0;
      in_contact.clear();
      touching_nodes.clear();
      for (std::size_t k = 0; k < candidates.size(); ++k)
      {
        if (this->gap[k] < 0.)
          mass_behind += *state.mass.node(candidates[k]);
        if (this->gap[k] < this->touch_distance || this->springs[k].is_closed())
        {
          in_contact.push_back(k);
          touching_nodes.push_back(candidates[k]);
        }
        else
          this->histories[k].position = vector_of<dim>(state.position.node(candidates[k]));
      }
      this->find_areas(state, &touching_nodes);
      const double ratio = this->mass_ratio(mass_behind);
      if (this->part)
        this->part->find_contact_points(state, candidates, in_contact);
      auto &springs = this->springs;
      for (const std::size_t k : in_contact)
      {
        const NodeHistory &history = this->histories[k];
        const auto x = vector_of<dim>(state.position.node(candidates[k]));
        const bool is_behind = this->gap[k] < this->touch_distance;
        const bool has_eroded = *state.mass.node(candidates[k]) == 0.;
        if (has_eroded && !springs[k].is_closed())
          continue;
        const Below below = this->below(k, x, clock, ratio);
        const Tensor<1, dim> &surface_motion = below.motion, &normal = below.normal;
        const Tensor<1, dim> motion = x - history.position - surface_motion;
        const bool touches = is_behind && !has_eroded;
        ContactMotion<dim> move(std::max(0., -this->gap[k]), motion, normal);
        // Along the normal that the surface had below the node.
        if (springs[k].normal_force() > 0.)
          move.past_approach = -(history.force + springs[k].stiffness * springs[k].elastic_slip) *
                               motion / springs[k].normal_force();
        Tensor<1, dim> force;
        if (touches)
        {
          const double mass = *state.mass.node(candidates[k]) / below.mass_ratio;
          // Nodes that only touch have no depth: no spring pulls.
          this->press(k, move, mass, this->area(k, normal), 1., clock, nodal_heat);
          force = springs[k].force(normal);
        }
        else
          this->release(k, move, nodal_heat);
        this->set_force(k, x, force, surface_motion, touches, loads, loaded_nodes);
        if (touches && this->part)
          this->part->add_reaction(this->part->contact_point(k), force);
      }
      if (this->part)
        this->part->collect_reactions(loads, loaded_nodes);
      this->end_forces();
    }

    void find_stiffness(const NodalState &state, const Clock &clock,
                        std::vector<ContactStiffness<dim>> &result) override
    {
      const auto has_depth = [](const ContactSpring<dim> &spring)
      { return spring.is_closed() && spring.depth > 0.; };
      // Nodes that touch and have no depth resist where nothing else does.
      const bool is_pressed = any_of_all_ranks(this->springs, has_depth, this->communicator);
      for (std::size_t k = 0; k < this->springs.size(); ++k)
      {
        if (!(is_pressed ? has_depth(this->springs[k]) : this->springs[k].is_closed()))
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

  private:
    using typename SurfaceContact<dim>::NodeHistory;

    /** The surface at a node in contact. */
    struct Below
    {
      Tensor<1, dim> normal, motion; ///< motion over the last step [L]
      double mass_ratio;             ///< of its mass to that of its spring
    };

    Below below(const std::size_t candidate, const Tensor<1, dim> &x, const Clock &clock,
                const double mass_ratio) const
    {
      if (this->part)
      {
        const auto &contact_point = this->part->contact_point(candidate);
        return {contact_point.normal, contact_point.motion, 1. + contact_point.crowding};
      }
      const double begin = clock.time - clock.previous_step;
      return {this->surface->normal(x, clock.time), this->surface->motion(x, begin, clock.time),
              mass_ratio};
    }

    std::vector<double> depths_at(const NodalVector &position, const Clock &clock) override
    {
      std::vector<double> result;
      this->find_gaps(position, this->candidates, clock.time, result);
      for (double &depth : result)
        depth = -depth;
      return result;
    }

    // Of the step.
    std::vector<std::size_t> in_contact; ///< candidates
    std::vector<unsigned int> touching_nodes;
  };

  template <int dim>
  std::unique_ptr<SurfaceContact<dim>> make_penalty_contact(ContactScene<dim> &scene)
  {
    return std::make_unique<PenaltyContact<dim>>(scene);
  }

  template std::unique_ptr<SurfaceContact<2>> make_penalty_contact(ContactScene<2> &);
  template std::unique_ptr<SurfaceContact<3>> make_penalty_contact(ContactScene<3> &);
} // namespace tombolo
