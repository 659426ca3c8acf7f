// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/energy_accounts.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/particles/fragments.h>
#include <tombolo/formulations/particles/rubbing_law.h>
#include <tombolo/state/material_points.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  struct FragmentCounts
  {
    unsigned long n_fragments = 0; ///< bodies that no chain of bonds connects, at the last search
    unsigned long n_touching = 0;  ///< particles that others push
  };

  /** The particles of a part on this rank, as contact uses them, in the order of rows. */
  struct ContactParticles
  {
    std::vector<dealii::types::global_dof_index> nodes; ///< ascending
    std::vector<std::uint64_t> ids;                     ///< persistent identifiers
    std::vector<double> volumes;                        ///< initial ones [L^dim]
    std::vector<double> masses;                         ///< inertia: m̂, scaled as it is [M]
    /** Volume and mass in the whole body over these: 1 without planes of symmetry. */
    std::vector<double> copies;
  };

  /** The state of the contact of a part from step to step, beside its points. */
  template <int dim>
  struct ContactOfPart
  {
    double stored = 0, dissipated = 0; ///< along normals, of this rank [M L^2/T^2]
    FragmentCounts counts;             ///< of this rank; a fragment is counted where its label is
    std::vector<bool> has_grown;       ///< particles, since pairs were found last
    FrictionOfPart<dim> friction;
  };

  /**
   * The contact of one part of particles: its law, its particles, and their state. Forces
   * and pairs are those of SphereContact, which has all parts with self-contact.
   */
  template <int dim>
  class SelfContact
  {
  public:
    /** Null where the section of the formulation does not enable it. Throws InputError. */
    static std::unique_ptr<SelfContact> create(const Entries &e)
    {
      if (!e.when(
              e.flag("Self-contact", "false",
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

    /** Particles meet these images. Before variables(). */
    void set_images(const std::shared_ptr<const Images> &images)
    {
      images_of_part = images;
    }

    std::vector<FieldDescription> variables() const
    {
      return {{force_name, "M L/T^2", FieldLocation::material_point, 3, true},
              {position_name, "L", FieldLocation::material_point, 3, true, 0., true},
              {label_name, "1", FieldLocation::material_point, n_tags(), true, is_unknown},
              {shrinkage_name, "1", FieldLocation::material_point, 1, true, 0., true}};
    }

    /** The addresses of these variables, by particle. */
    struct Columns
    {
      std::array<double *, dim> force;          ///< of the step before, without friction
      std::array<double *, dim> position;       ///< at its end
      std::array<double *, node_stride> labels; ///< the first n_tags() of fragments (FragmentTag)
      double *shrinkage;                        ///< of the radius, over the initial one
    };
    Columns columns(MaterialPoints &points) const
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
    /** The number of tags that identify the fragment of a particle. */
    unsigned int n_tags() const
    {
      return images_of_part->empty() ? lower_copies : lower_copies + 1;
    }

    /** First, and when there are more particles. @p wave_rate: c/h, always the same. Collective. */
    void set_particles(ContactParticles new_particles, const double wave_rate,
                       const MPI_Comm communicator)
    {
      // Spheres are those of the whole body.
      for (std::size_t i = 0; i < new_particles.nodes.size(); ++i)
      {
        new_particles.volumes[i] *= new_particles.copies[i];
        new_particles.masses[i] *= new_particles.copies[i];
      }
      const ContactParticles before = std::exchange(all_particles, std::move(new_particles));
      kept.has_grown.assign(all_particles.nodes.size(), false);
      for (std::size_t i = 0; i < all_particles.nodes.size(); ++i)
      {
        const auto found =
            std::lower_bound(before.nodes.begin(), before.nodes.end(), all_particles.nodes[i]);
        kept.has_grown[i] =
            found == before.nodes.end() || *found != all_particles.nodes[i] ||
            before.volumes[static_cast<std::size_t>(found - before.nodes.begin())] !=
                all_particles.volumes[i];
      }
      law_frequency = std::sqrt(stiffness) * dealii::Utilities::MPI::max(wave_rate, communicator);
      mass = 0;
      for (const double particle_mass : all_particles.masses)
        mass = std::max(mass, particle_mass);
      mass = dealii::Utilities::MPI::max(mass, communicator);
      ++revision_of_particles;
    }

    /** Returns how many fragments the whole body has. Where cells become particles of the part, or
     * there are several fragments, pairs are searched from the first step on, otherwise from the
     * first broken bond on. @p partition as in find_fragments(). Collective. */
    unsigned long set_start(const bool grows, const Stencils &shape, const NodePartition &partition)
    {
      const std::vector<FragmentOfParticle> fragments =
          find_fragments(shape, all_particles.ids, partition, *images_of_part);
      kept.counts.n_fragments = n_labels_here(fragments, all_particles.ids);
      unsigned long in_whole_body = 0;
      for (std::size_t i = 0; i < fragments.size(); ++i)
        if (fragments[i].label == all_particles.ids[i])
          in_whole_body += (1u << images_of_part->all.size()) / fragments[i].n_copies();
      const unsigned long n_fragments =
          dealii::Utilities::MPI::sum(in_whole_body, partition.communicator());
      is_apart_at_start = grows || n_fragments > 1;
      return n_fragments;
    }

    /** In each step: whether rows have changed, and whether any on any rank has lost neighbours. */
    void set_rows(const bool have_changed, const bool are_torn)
    {
      revision_of_rows += have_changed ? 1 : 0;
      is_torn = are_torn;
    }

    /** Whether there can be several fragments. */
    bool is_apart() const
    {
      return is_apart_at_start || is_torn;
    }

    /** In the whole body. */
    const ContactParticles &particles() const
    {
      return all_particles;
    }

    /** Counters of the changes of particles, and of rows as well. The same on all ranks. */
    unsigned long particles_revision() const
    {
      return revision_of_particles;
    }
    unsigned long rows_revision() const
    {
      return revision_of_rows;
    }

    /** @name The law */
    ///@{
    double frequency() const ///< √(k/μ) [1/T]
    {
      return law_frequency;
    }
    double damping() const ///< over the critical one
    {
      return law_damping;
    }
    const RubbingLaw &rubbing() const
    {
      return law_rubbing;
    }
    ///@}

    /** The largest m̂, over all ranks [M]. */
    double largest_mass() const
    {
      return mass;
    }

    /** The share of @p stable_step, the limit without contact, that springs and dampers leave: to a
     * particle of a body with five others on its free side, or to debris among twelve. */
    double stable_fraction(const double stable_step) const
    {
      constexpr double on_free_side = 5., around = 12.;
      const double angle = law_frequency * stable_step;
      const double debris_fraction =
          angle > 0. ? stable_fraction(0., around, angle, law_damping) : 1.;
      return std::min({1., stable_fraction(4., on_free_side, angle, law_damping), debris_fraction});
    }

    /** The share that is left where others push from @p n_pairs sides with springs of ω = @p
     * angle over the step; @p body_springs is 4 for a particle of a body, 0 for one alone. */
    static double stable_fraction(const double body_springs, const double n_pairs,
                                  const double angle, const double damping)
    {
      // Sums over the pairs of a particle by Gershgorin's theorem. Dampers act on the approach
      // alone.
      constexpr double pair_springs = 2.42;
      const double springs = body_springs + pair_springs * n_pairs * angle * angle;
      const double dampers = 0.5 * pair_springs * n_pairs * damping * angle;
      return (std::sqrt(dampers * dampers + 4. * springs) - dampers) / springs;
    }

    /** Adds the energy of springs, and what was dissipated by damping, by spheres that shrink and
     * by the steps, and by friction: this rank's shares. */
    void account(EnergyAccounts &accounts) const
    {
      accounts.add("self-contact energy", EnergyKind::stored, kept.stored + kept.friction.stored);
      accounts.add("self-contact damping", EnergyKind::dissipated, kept.dissipated);
      if (rubs())
        accounts.add("self-contact friction", EnergyKind::dissipated, kept.friction.dissipated);
    }

    /** At the last search, over this rank. */
    FragmentCounts counts() const
    {
      return kept.counts;
    }

    /** Whether particles rub or conduct. */
    bool rubs() const
    {
      return law_rubbing.rubs() || law_rubbing.conducts();
    }

    void list(Records &records)
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

    ContactOfPart<dim> kept;

  private:
    static constexpr char force_name[] = "self-contact force";
    static constexpr char position_name[] = "self-contact position";
    static constexpr char label_name[] = "fragment";
    static constexpr char shrinkage_name[] = "contact shrinkage";

    explicit SelfContact(const Entries &e)
    {
      stiffness =
          e.number("Self-contact stiffness", "0.05",
                   positive_up_to(10., "; 2 is as stiff as the material."), "",
                   "Of the springs between two particles: times their reduced mass and the "
                   "square of the wave speed over the smallest spacing of the part. Above 0 "
                   "and up to 10; 2 is as stiff as the material, and takes the step down.");
      law_damping = e.number("Self-contact damping", "0.1", from_to(0., 1.), "",
                             "Of their approach, over the critical one. From 0 to 1.");
      law_rubbing = RubbingLaw::create(e);
    }

    double stiffness, law_damping, law_frequency = 0, mass = 0;
    RubbingLaw law_rubbing;
    std::shared_ptr<const Images> images_of_part = Images::none();
    ContactParticles all_particles;
    bool is_apart_at_start = false, is_torn = false;
    unsigned long revision_of_particles = 0, revision_of_rows = 0;
  };
} // namespace tombolo
