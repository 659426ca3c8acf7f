// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/spring_contact.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/nodal_geometry.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tombolo
{
  using namespace dealii;

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
  void SpringContact<dim>::press(const std::size_t candidate, const Press &press,
                                 const Clock &clock, const NodalHeat &nodal_heat)
  {
    ContactSpring<dim> &spring = springs[candidate];
    this->settings.law.press(press.depth, press.motion, press.normal, press.mass, clock.stable_step,
                             clock.previous_step, spring, this->totals.damping);
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
  void SpringContact<dim>::add_node_sums(ContactBalance &shares) const
  {
    for (const ContactSpring<dim> &spring : springs)
    {
      shares.elastic += spring.elastic_energy();
      shares.n_nodes += spring.is_closed() ? 1. : 0.;
      shares.penetration = std::max(shares.penetration, spring.depth);
    }
  }

  template <int dim>
  void SpringContact<dim>::close_springs(const NodalState &state, StateArchive &archive)
  {
    // Where there was no spring, there was none of the mean.
    NodalVector of_springs, slips, before;
    of_springs.reinit(state.partition(), Quantity::scalars);
    slips.reinit(state.partition());
    archive.nodal(scalars_of_springs, 3, of_springs);
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
      const double stiffness = *of_springs.node(node);
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
      if (!springs[k].is_closed()) // what hangs between others has no mass
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
