// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/failure/bond_check.h>
#include <tombolo/formulations/failure/partner_lists.h>
#include <tombolo/formulations/part_points.h>
#include <tombolo/formulations/particles/particle_formulation.h>
#include <tombolo/formulations/particles/particle_rows.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace tombolo
{
  class Records;

  /** Bonds between particles that have failed. */
  struct BondCounts
  {
    std::string criterion;      ///< empty: bonds do not break
    double n_broken = 0;        ///< one of ½ for each end
    unsigned long n_debris = 0; ///< particles with broken bonds and without a basis
  };

  /**
   * The bonds of the particles of one part that have broken, for good. A bond is between a particle
   * and a neighbour, or the image of one in planes of symmetry; it belongs to both of its ends,
   * whatever their supports are, and so it is broken in the lists of both, on whichever ranks they
   * are. Particles go by their persistent identifiers here.
   *
   * A check compares each pair with a BondFailure. Pairs that break leave the rows of the shape
   * functions, which are then computed from the remaining neighbours, in the reference that the
   * kernel has: stress, mass and momentum of the particles stay. A particle that has lost bonds
   * gets no new ones, by a search or by coming nearer: what has separated does not grow together.
   *
   * A particle without a basis (its row is rigid) that has lost bonds is debris. Its stress does
   * not act any more: it is put to zero, and its elastic energy is booked as lost to failure. One
   * whose remaining neighbours nearly carry no basis, or that would be turned inside out, loses all
   * its bonds and becomes debris too; where it is wanted, also one that has lost no bond before.
   * Where no bond can break, all calls do nothing.
   */
  template <int dim>
  class Bonds
  {
  public:
    static constexpr const char *dissipation_name = "failure dissipation";

    /** A particle with broken bonds loses all where its present gradients, √Σ_J |F⁻ᵀ∇φ_J|², are
     * this many times those of the start. At the corner of a lattice they are twice those inside.
     */
    static constexpr double largest_gradient_growth = 3.;

    /** Takes the criterion of the section of the formulation, or none. The other arguments must
     * outlive this object, which changes rows and points. Throws InputError. */
    Bonds(const Section &section, const ParticleSet<dim> &particles,
          const KernelConfiguration<dim> &kernel, ParticleRows<dim> &rows, PartPoints &points);

    /** Whether bonds can break. */
    bool is_on() const
    {
      return check != nullptr;
    }
    /** Whether any bond is broken on any rank. */
    bool any() const
    {
      return is_broken_anywhere;
    }

    /** What points must hold; none if off. */
    std::vector<FieldDescription> variables() const;

    /** Takes the rows of the start, whose neighbours with φ ≠ 0 are the bonds. Throws InputError
     * where the points cannot be judged. */
    void initialize();

    /** What is called before stencils change in a run, on all ranks. */
    void set_before_change(const std::function<void()> &to_call)
    {
      before_change = to_call;
    }
    /** Calls it, and remembers the rows as they are. */
    void prepare_change();

    /** Before a search: keeps in mind the bonds that particles with broken ones still have.
     * Collective. */
    void prepare_search();
    /** After it: takes out broken bonds, and new ones of particles that have lost some.
     * Collective. */
    void finish_search();

    /** Checks the bonds at @p position (current ghosts) if that is due; where any breaks, rows,
     * values and gradients change. Returns whether they did, the same on all ranks. Collective. */
    bool update(const NodalVector &position);

    /** Breaks all bonds of particles that are not sound any more at @p position (current ghosts):
     * of those that have lost some, or of all; until none is left. Returns as update().
     * Collective. */
    bool isolate_distorted(const NodalVector &position);
    /** The same at the positions of the reference, after a search whose numbers the rows still
     * have; they get those of a partition. Collective. */
    void isolate_distorted_in_reference();

    /** Books the elastic energy of debris, and takes its stress away. */
    void release_debris();

    /** There are more particles; the one at place old_place[i] is now number i, others are new.
     * Where gains[i] it is a node of cells that came. Follows prepare_search(); with the search
     * after it a new particle gets a bond also with a damaged one if cells came to both, since
     * these have joined them. */
    void add_particles(const std::vector<unsigned int> &old_place, const std::vector<bool> &gains);

    /** Between add_particles() and finish_search(): takes those pairs out of rows in another
     * configuration that finish_search() will refuse. @p partition has all nodes and images of @p
     * neighbourhoods. Collective. */
    void remove_unbonded(const std::shared_ptr<const NodePartition> &partition,
                         Neighbourhoods<dim> &neighbourhoods, Stencils &shape);

    /** Takes @p shape as the rows of the start, for particles without broken bonds. */
    void measure_rows(const Stencils &shape);

    /** Rigid rows with broken bonds, ascending. */
    std::vector<unsigned int> debris() const;
    /** Of the debris() of the last update those that it made, and those that it took further
     * neighbours from. */
    std::vector<LeavingParticle> take_leaving_particles()
    {
      return former_rows.leaving(rows.stencils(), debris());
    }
    /** Over this rank's particles. */
    BondCounts counts() const;
    /** Elastic energy of debris, over this rank. */
    double dissipated_energy() const
    {
      return integral_over_initial_volume(points.points(), dissipation_name);
    }

    /** Lists what is kept from step to step; rows are the particles. */
    void list(Records &records);
    /** Takes broken bonds out of rows that were searched anew, on @p partition. Returns whether
     * there are any on any rank. Collective. */
    bool complete_reading(const std::shared_ptr<const NodePartition> &partition);

  private:
    bool can_isolate() const
    {
      return is_broken_anywhere || (is_on() && check->isolates_all());
    }
    /** Breaks what the criterion tells. Returns whether any bond broke on any rank. Collective. */
    bool break_bonds(const NodalVector &position);
    /** Breaks the bond at an entry of the rows; its other end goes to @p messages. */
    void break_entry(unsigned int row, std::size_t entry, std::vector<PartnerMessage> &messages);
    /** Completes what break_entry() began, takes what broke out of the rows, and computes these.
     * Returns whether there was anything on any rank. Collective. */
    bool complete_breaking(const std::shared_ptr<const NodePartition> &partition,
                           const std::vector<PartnerMessage> &messages);
    /** Takes broken bonds out of the rows. @p partition has all their nodes and images.
     * Collective. */
    void remove_broken(const std::shared_ptr<const NodePartition> &partition);
    /** Adds to @p lists the neighbours of which is_such(row, place, entry) holds. */
    template <typename IsSuch>
    void add_pairs(const IsSuch &is_such, PartnerLists &lists) const;
    bool is_damaged(const unsigned int row, const unsigned int place) const
    {
      return !broken[row].empty() || partners[place].is_damaged;
    }
    /** Whether a pair of a search, of which neither bond nor break is known, is no bond: one of its
     * ends is damaged. */
    bool is_refused(unsigned int row, unsigned int place) const;

    const ParticleSet<dim> &particles;
    const KernelConfiguration<dim> &kernel;
    ParticleRows<dim> &rows;
    PartPoints &points;
    std::unique_ptr<BondCheck<dim>> check; // null: bonds do not break
    bool is_broken_anywhere = false;
    unsigned int fraction_field = 0, dissipation_field = 0;
    std::function<void()> before_change;
    FormerRows former_rows; // only during an update

    // By particle.
    std::vector<std::uint64_t> own_ids;
    std::vector<unsigned int> n_initial_bonds;
    std::vector<double> initial_gradient;   // √Σ_J |∇φ_J|² [1/L]
    std::vector<double> reference_gradient; // the same of the rows as they are; empty: not found
    PartnerLists broken;
    PartnerLists refused;               // found by the last search, but never to be bonded
    PartnerLists previous;              // of bonds with a damaged end, only during a search
    std::vector<ParticleGrowth> growth; // since the last search; empty: none
    bool has_grown = false;

    NeighbourPartners<dim> partners;
  };
} // namespace tombolo
