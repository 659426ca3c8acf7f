// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/contact/spring_contact.h>

#include <utility>

namespace tombolo
{
  using namespace dealii;

  /**
   * Contact by penalty springs: each candidate node behind the surface has a spring of ContactLaw,
   * with its mass m̂ and the stable time step Δt, not the one taken, so that the safety factor does
   * not change the stiffness. Against a surface with a mass m_t, m̂ / (1 + M/m_t) replaces m̂, with
   * the mass M of all nodes in contact: then the frequency of the springs is that of contact with a
   * surface of prescribed motion. Against a part it is m̂ / (1 + R), see PartSurface, which gets the
   * reactions.
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
      std::vector<std::size_t> in_contact;
      for (std::size_t k = 0; k < candidates.size(); ++k)
      {
        if (this->gap[k] < 0.)
          mass_behind += *state.mass.node(candidates[k]);
        if (this->gap[k] < this->touch_distance || this->springs[k].is_closed())
          in_contact.push_back(k);
      }
      const double ratio = this->mass_ratio(mass_behind);
      if (this->part)
        this->part->find_places(state, candidates, in_contact);
      auto &springs = this->springs;
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
        const Tensor<1, dim> &of_surface = below.motion, &normal = below.normal;
        const Tensor<1, dim> motion = x - history.position - of_surface;
        const bool touches = is_behind && !has_eroded;
        Tensor<1, dim> force;
        if (touches)
        {
          const double mass = *state.mass.node(candidates[k]) / below.mass_ratio;
          this->press(k, {-this->gap[k], motion, normal, mass}, clock, nodal_heat);
          force = springs[k].force(normal);
        }
        else
        {
          // A node that leaves a part across an edge is as deep as it was.
          const double approach = -(motion * normal);
          const bool is_cut = has_eroded || (this->part && springs[k].depth + approach > 0.);
          this->release(k, approach, is_cut, nodal_heat);
        }
        this->set_force(k, x, force, of_surface, touches, loads, loaded_nodes);
        if (touches && this->part)
          this->part->add_reaction(this->part->place(k), force);
      }
      if (this->part)
        this->part->collect_reactions(loads, loaded_nodes);
      this->end_forces();
    }

    void find_stiffness(const NodalState &state, const Clock &clock,
                        std::vector<ContactStiffness<dim>> &result) override
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

  private:
    using typename SurfaceContact<dim>::NodeHistory;

    /** What a node in contact sees of the surface. */
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
        const auto &place = this->part->place(candidate);
        return {place.normal, place.motion, 1. + place.crowding};
      }
      const double begin = clock.time - clock.previous_step;
      return {this->surface->normal(x, clock.time), this->surface->motion(x, begin, clock.time),
              mass_ratio};
    }

    std::vector<double> depths_at(const NodalVector &position, const Clock &clock) override
    {
      std::vector<double> result;
      this->find_gaps(position, this->candidates, clock.time, result);
      for (double &of_node : result)
        of_node = -of_node;
      return result;
    }
  };

  template <int dim>
  std::unique_ptr<SurfaceContact<dim>> make_penalty_contact(ContactScene<dim> &scene)
  {
    return std::make_unique<PenaltyContact<dim>>(scene);
  }

  template std::unique_ptr<SurfaceContact<2>> make_penalty_contact(ContactScene<2> &);
  template std::unique_ptr<SurfaceContact<3>> make_penalty_contact(ContactScene<3> &);
} // namespace tombolo
