// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/energy_accounts.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/particles/fragment_friction.h>
#include <tombolo/state/material_points.h>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace tombolo
{
  class Records;

  /** Fragments of a part in contact. */
  struct FragmentCounts
  {
    unsigned long n_fragments = 0; ///< bodies that no chain of bonds connects, as last looked for
    unsigned long n_touching = 0;  ///< particles that others push
  };

  /** The particles of a part on this rank, as contact knows them; in the order of rows. */
  struct ContactParticles
  {
    std::vector<dealii::types::global_dof_index> nodes; ///< ascending
    std::vector<std::uint64_t> ids;                     ///< persistent identifiers
    std::vector<double> volumes;                        ///< initial ones [L^dim]
    std::vector<double> masses;                         ///< inertia: m̂, scaled as it is [M]
    /** Volume and mass in the whole body over these: 1 without planes of symmetry. */
    std::vector<double> copies;
  };

  /** What contact keeps of a part from step to step, beside its points. */
  template <int dim>
  struct ContactOfPart
  {
    double stored = 0, dissipated = 0; ///< along normals, of this rank [M L^2/T^2]
    FragmentCounts counts;             ///< of this rank; a fragment is counted where its label is
    std::vector<bool> has_grown;       ///< particles, since pairs were found last
    FrictionOfPart<dim> friction;
  };

  /**
   * The contact of one part of particles: its law, its particles, and what is kept of them. Forces
   * and pairs are those of SphereContact, which sees all parts with self-contact.
   */
  template <int dim>
  class SelfContact
  {
  public:
    /** Null where the section of the formulation does not want it. Throws InputError. */
    static std::unique_ptr<SelfContact> create(const Entries &e);

    /** Particles meet these images. Before variables(). */
    void set_images(const std::shared_ptr<const Images> &images)
    {
      images_of_part = images;
    }

    /** What points must hold. */
    std::vector<FieldDescription> variables() const;

    /** The addresses of these variables, by particle. */
    struct Columns
    {
      std::array<double *, dim> force;          ///< of the step before, without friction
      std::array<double *, dim> position;       ///< at its end
      std::array<double *, node_stride> labels; ///< the first n_tags() of fragments (FragmentTag)
      double *shrinkage;                        ///< of the radius, over the initial one
    };
    Columns columns(MaterialPoints &points) const;
    /** How many numbers tell the fragment of a particle. */
    unsigned int n_tags() const;

    /** Before anything else, and whenever there are more particles. @p wave_rate is c/h, the same
     * each time. Collective. */
    void set_particles(ContactParticles particles, double wave_rate, MPI_Comm communicator);

    /** Returns how many fragments the whole body has. Where cells become particles of the part, or
     * there are several, pairs are looked for from the first step on, otherwise from the first
     * broken bond on. @p partition as in find_fragments(). Collective. */
    unsigned long set_start(bool grows, const Stencils &shape, const NodePartition &partition);

    /** In each step: whether rows have lost neighbours or have other ones, and whether any has
     * lost some, on any rank. */
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

    /** What these count are changes of particles, and of rows as well. The same on all ranks. */
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
    double stable_fraction(double stable_step) const;

    /** The share that is left where others push from @p n_pairs sides with springs of ω = @p
     * angle over the step; @p of_body is 4 for a particle of a body, 0 for one alone. */
    static double stable_fraction(double of_body, double n_pairs, double angle, double damping);

    /** What springs store, and what has been taken by damping, by spheres that shrink and by the
     * steps, and by friction: this rank's shares. */
    void account(EnergyAccounts &accounts) const;

    /** As last looked for, over this rank. */
    FragmentCounts counts() const
    {
      return kept.counts;
    }

    /** Whether particles rub or conduct. */
    bool rubs() const
    {
      return law_rubbing.rubs() || law_rubbing.conducts();
    }

    /** Beside points. */
    void list(Records &records);

    ContactOfPart<dim> kept;

  private:
    explicit SelfContact(const Entries &e);

    double stiffness, law_damping, law_frequency = 0, mass = 0;
    RubbingLaw law_rubbing;
    std::shared_ptr<const Images> images_of_part = Images::none();
    ContactParticles all_particles;
    bool is_apart_at_start = false, is_torn = false;
    unsigned long revision_of_particles = 0, revision_of_rows = 0;
  };
} // namespace tombolo
