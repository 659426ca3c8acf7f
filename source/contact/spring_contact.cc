// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/spring_contact.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  SpringContact<dim>::SpringContact(const Section &section, const Mesh<dim> &mesh,
                                    const Nodes<dim> &nodes, const NodalState &state,
                                    const std::vector<bool> &can_be_exposed, const bool has_heat,
                                    const std::vector<double> &volume, MasterPart<dim> master)
      : SurfaceContact<dim>(section, mesh, nodes, state, can_be_exposed, has_heat, volume,
                            std::move(master)),
        springs(this->candidates.size())
  {}

  template <int dim>
  double SpringContact<dim>::mass_ratio(const double mass) const
  {
    const double tool_mass = this->surface->translation().mass();
    return tool_mass == 0. ? 1. : 1. + ordered_sum(mass, this->communicator) / tool_mass;
  }

  template <int dim>
  void SpringContact<dim>::press(const std::size_t candidate, const Press &press,
                                 const Clock &clock, const NodalHeat &nodal_heat)
  {
    ContactSpring<dim> &spring = springs[candidate];
    this->settings.law.press(press.depth, press.motion, press.normal, press.mass, clock.stable_step,
                             clock.previous_step, spring, this->damping_heat);
    const double area = this->area(candidate, press.normal);
    if (this->settings.friction.largest() > 0.)
    {
      const double limit =
          this->tangential_limit(candidate, spring.normal_force(), area, nodal_heat);
      spring.limit_follows_pressure = limit < this->shear_limit(candidate, area);
      this->add_friction_heat(
          candidate, ContactLaw::slide(press.motion, press.normal, limit, spring), nodal_heat);
    }
    this->add_contact(candidate, press.share * spring.normal_force(), area, clock);
  }

  template <int dim>
  void SpringContact<dim>::release(const std::size_t candidate, const double approach,
                                   const bool has_eroded, const NodalHeat &nodal_heat)
  {
    this->add_friction_heat(
        candidate,
        ContactLaw::release(approach, has_eroded, springs[candidate], this->damping_heat),
        nodal_heat);
  }

  template <int dim>
  double SpringContact<dim>::stable_fraction() const
  {
    return this->settings.law.stable_fraction();
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
  void SpringContact<dim>::begin_trial(const NodalState &state, const Clock &clock)
  {
    SurfaceContact<dim>::begin_trial(state, clock);
    committed_springs = springs;
  }

  template <int dim>
  void SpringContact<dim>::restart_trial()
  {
    SurfaceContact<dim>::restart_trial();
    springs = committed_springs;
  }

  template <int dim>
  typename SpringContact<dim>::NodeSums SpringContact<dim>::node_sums() const
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
  void SpringContact<dim>::serialize_nodes(StateArchive &archive)
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
  void SpringContact<dim>::continue_nodes(StateArchive &archive)
  {
    if (archive.has("bond"))
      SpringContact<dim>::serialize_nodes(archive);
  }

  template <int dim>
  void SpringContact<dim>::follow_division(const NodalState &state, StateArchive &archive,
                                           const Clock &clock)
  {
    const NodalVector before = NodeHistory::follow_division(archive, this->name(), this->candidates,
                                                            state.position, this->histories);
    const auto group = archive.group("division of springs " + this->name());
    enum Slot : unsigned int
    {
      stiffness,
      mass,
      n_slots
    };
    NodalVector of_springs, slips;
    of_springs.reinit(state.partition(), Quantity::scalars);
    slips.reinit(state.partition());
    for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
      of_springs.node(i)[mass] = *state.mass.node(i);
    for (std::size_t k = 0; k < springs.size(); ++k)
    {
      of_springs.node(this->candidates[k])[stiffness] = springs[k].stiffness;
      for (unsigned int d = 0; d < dim; ++d)
        slips.node(this->candidates[k])[d] = springs[k].elastic_slip[d];
    }
    archive.nodal("stiffness, mass", n_slots, of_springs);
    archive.nodal("slip", dim, slips);
    if (!archive.is_reading())
      return;
    Clock then = clock;
    then.time -= clock.previous_step;
    const std::vector<double> depths = depths_at(before, then);
    const double mean = mean_stiffness();
    for (std::size_t k = 0; k < springs.size(); ++k)
    {
      const unsigned int node = this->candidates[k];
      const double *const source = of_springs.node(node);
      // The stiffness over the area stays: it is as m^(1-1/dim).
      const double ratio = source[mass] > 0. ? *state.mass.node(node) / source[mass] : 1.;
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
          source[stiffness] > 0.
              ? source[stiffness] * std::pow(ratio, 1. - 1. / dim)
              : std::min(mean,
                         this->settings.law.stiffness(*state.mass.node(node), clock.previous_step));
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
} // namespace tombolo
