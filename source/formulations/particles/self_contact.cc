// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/self_contact.h>

#include <tombolo/formulations/particles/fragments.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tombolo
{
  namespace
  {
    constexpr char force_name[] = "self-contact force";
    constexpr char position_name[] = "self-contact position";
    constexpr char label_name[] = "fragment";
    constexpr char shrinkage_name[] = "contact shrinkage";
  } // namespace

  template <int dim>
  std::unique_ptr<SelfContact<dim>> SelfContact<dim>::create(const Entries &e)
  {
    if (!e.when(e.flag("Self-contact", "false",
                       "Whether particles of fragments that have come apart push each other away, "
                       "debris among them, and those of different bodies of all parts that have "
                       "it. Wants `Bond failure`, or a total Lagrangian kernel.")))
      return nullptr;
    e.refuse(e.given("Bond failure") == "none" && e.given("Configuration") != "total Lagrangian",
             "Self-contact",
             "where the kernel is renewed and no bond breaks, bodies that come near each other "
             "grow together; choose a `Bond failure`, or `total Lagrangian` as `Configuration`");
    return std::unique_ptr<SelfContact<dim>>(new SelfContact<dim>(e));
  }

  template <int dim>
  SelfContact<dim>::SelfContact(const Entries &e)
  {
    stiffness = e.number("Self-contact stiffness", "0.05",
                         positive_up_to(10., "; 2 is as stiff as the material."), "",
                         "Of the springs between two particles: times their reduced mass and the "
                         "square of the wave speed over the smallest spacing of the part. Above 0 "
                         "and up to 10; 2 is as stiff as the material, and takes the step down.");
    law_damping = e.number("Self-contact damping", "0.1", from_to(0., 1.), "",
                           "Of their approach, over the critical one. From 0 to 1.");
    law_rubbing = RubbingLaw::create(e);
  }

  template <int dim>
  std::vector<FieldDescription> SelfContact<dim>::variables() const
  {
    return {{force_name, "M L/T^2", FieldLocation::material_point, 3, true},
            {position_name, "L", FieldLocation::material_point, 3, true, 0., true},
            {label_name, "1", FieldLocation::material_point, n_tags(), true, is_unknown},
            {shrinkage_name, "1", FieldLocation::material_point, 1, true, 0., true}};
  }

  template <int dim>
  typename SelfContact<dim>::Columns SelfContact<dim>::columns(MaterialPoints &points) const
  {
    Columns result;
    const unsigned int force = points.find_field(force_name),
                       position = points.find_field(position_name),
                       label = points.find_field(label_name);
    for (unsigned int d = 0; d < dim; ++d)
    {
      result.force[d] = points.component(force, d);
      result.position[d] = points.component(position, d);
    }
    result.labels.fill(nullptr);
    for (unsigned int t = 0; t < n_tags(); ++t)
      result.labels[t] = points.component(label, t);
    result.shrinkage = points.component(points.find_field(shrinkage_name), 0);
    return result;
  }

  template <int dim>
  unsigned int SelfContact<dim>::n_tags() const
  {
    return images_of_part->empty() ? lower_copies : lower_copies + 1;
  }

  template <int dim>
  void SelfContact<dim>::set_particles(ContactParticles of_part, const double wave_rate,
                                       const MPI_Comm communicator)
  {
    // Spheres are those of the whole body.
    for (std::size_t i = 0; i < of_part.nodes.size(); ++i)
    {
      of_part.volumes[i] *= of_part.copies[i];
      of_part.masses[i] *= of_part.copies[i];
    }
    const ContactParticles before = std::exchange(all_particles, std::move(of_part));
    kept.has_grown.assign(all_particles.nodes.size(), false);
    for (std::size_t i = 0; i < all_particles.nodes.size(); ++i)
    {
      const auto found =
          std::lower_bound(before.nodes.begin(), before.nodes.end(), all_particles.nodes[i]);
      kept.has_grown[i] = found == before.nodes.end() || *found != all_particles.nodes[i] ||
                          before.volumes[static_cast<std::size_t>(found - before.nodes.begin())] !=
                              all_particles.volumes[i];
    }
    law_frequency = std::sqrt(stiffness) * Utilities::MPI::max(wave_rate, communicator);
    mass = 0;
    for (const double of_particle : all_particles.masses)
      mass = std::max(mass, of_particle);
    mass = Utilities::MPI::max(mass, communicator);
    ++revision_of_particles;
  }

  template <int dim>
  unsigned long SelfContact<dim>::set_start(const bool grows, const Stencils &shape,
                                            const NodePartition &partition)
  {
    const std::vector<FragmentOfParticle> fragments =
        find_fragments(shape, all_particles.ids, partition, *images_of_part);
    kept.counts.n_fragments = n_labels_here(fragments, all_particles.ids);
    unsigned long in_whole_body = 0;
    for (std::size_t i = 0; i < fragments.size(); ++i)
      if (fragments[i].label == all_particles.ids[i])
        in_whole_body += (1u << images_of_part->all.size()) / fragments[i].n_copies();
    const unsigned long of_all = Utilities::MPI::sum(in_whole_body, partition.communicator());
    is_apart_at_start = grows || of_all > 1;
    return of_all;
  }

  template <int dim>
  double SelfContact<dim>::stable_fraction(const double of_body, const double n_pairs,
                                           const double angle, const double damping)
  {
    // Sums over the pairs of a particle by Gershgorin's theorem. Dampers act on the approach alone.
    constexpr double of_pair = 2.42;
    const double springs = of_body + of_pair * n_pairs * angle * angle;
    const double dampers = 0.5 * of_pair * n_pairs * damping * angle;
    return (std::sqrt(dampers * dampers + 4. * springs) - dampers) / springs;
  }

  template <int dim>
  double SelfContact<dim>::stable_fraction(const double stable_step) const
  {
    constexpr double on_free_side = 5., around = 12.;
    const double angle = law_frequency * stable_step;
    const double of_debris = angle > 0. ? stable_fraction(0., around, angle, law_damping) : 1.;
    return std::min({1., stable_fraction(4., on_free_side, angle, law_damping), of_debris});
  }

  template <int dim>
  void SelfContact<dim>::account(EnergyAccounts &accounts) const
  {
    accounts.add("self-contact energy", EnergyKind::stored, kept.stored + kept.friction.stored);
    accounts.add("self-contact damping", EnergyKind::dissipated, kept.dissipated);
    if (rubs())
      accounts.add("self-contact friction", EnergyKind::dissipated, kept.friction.dissipated);
  }

  template <int dim>
  void SelfContact<dim>::list(Records &records)
  {
    records.sums("energies", kept.stored, kept.dissipated);
    if (rubs())
      records.archived([this](auto &archive)
                       { kept.friction.serialize(archive, all_particles.ids); });
    records.on_reading(
        [this]
        {
          ++revision_of_particles;
          kept.has_grown.assign(kept.has_grown.size(), false);
        });
  }

  template class SelfContact<2>;
  template class SelfContact<3>;
} // namespace tombolo
