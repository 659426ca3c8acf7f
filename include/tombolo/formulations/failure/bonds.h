// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/failure/bond_check.h>
#include <tombolo/formulations/failure/partner_lists.h>
#include <tombolo/formulations/particles/particle_formulation.h>

#include <deal.II/base/point.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace tombolo
{
  class Records;

  /**
   * The bonds of the particles of one part that have broken, for good. A bond is between a particle
   * and a neighbour, or the image of one in planes of symmetry; it belongs to both of its ends,
   * whatever their supports are, and so it is broken in the lists of both, on whichever ranks they
   * are. Particles go by their persistent identifiers here.
   *
   * A check compares each pair with a BondFailure. Pairs that break leave the rows of the shape
   * functions, which the formulation then computes from the remaining neighbours, in the reference
   * that the kernel has: stress, mass and momentum of the particles stay. A particle that has lost
   * bonds gets no new ones, by a search or by coming nearer: what has separated does not grow
   * together.
   *
   * A particle without a basis (its row is rigid) that has lost bonds is debris. Its stress does
   * not act any more: it is put to zero, and its elastic energy is booked as lost to failure. One
   * whose remaining neighbours nearly carry no basis, or that would be turned inside out, loses all
   * its bonds and becomes debris too; where it is wanted, also one that has lost no bond before.
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

    /** Null where the section of the formulation wants no bond failure. Throws InputError. */
    static std::unique_ptr<Bonds> create(const Entries &e);

    /** What points must hold. */
    std::vector<FieldDescription> variables() const;

    /** The particles of this rank have the persistent identifiers @p ids; @p shape are the rows of
     * the start, whose neighbours with φ ≠ 0 are the bonds. Throws InputError where @p points
     * cannot be judged. */
    void initialize(const std::vector<std::uint64_t> &ids, const Stencils &shape,
                    const MaterialPoints &points, MPI_Comm communicator);

    /** Counts a step; whether its bonds are checked. */
    bool is_due()
    {
      return check.is_due();
    }

    bool needs_deformation() const
    {
      return check.needs_deformation();
    }

    /**
     * Breaks what the criterion tells. @p position has current ghosts; @p particles are the global
     * numbers of this rank's particles (ascending), @p initial_positions where they began, @p
     * deformation as in BondFailure. Returns whether any bond broke on any rank; then
     * remove_broken() is due. Collective.
     */
    bool break_bonds(const NodalVector &position,
                     const std::vector<dealii::types::global_dof_index> &particles,
                     const std::vector<dealii::Point<dim>> &initial_positions,
                     const std::vector<dealii::Tensor<2, 3>> &deformation,
                     const Neighbourhoods<dim> &neighbourhoods, const Stencils &shape,
                     MaterialPoints &points);

    /** Whether there can be particles that isolate_distorted() isolates. */
    bool can_isolate() const
    {
      return isolates_all || is_broken_anywhere;
    }

    /** Breaks all bonds of particles that are not sound any more at @p position (current ghosts):
     * of those that have lost some, or of all. Otherwise as break_bonds(). Collective. */
    bool isolate_distorted(const NodalVector &position,
                           const std::vector<dealii::types::global_dof_index> &particles,
                           const Neighbourhoods<dim> &neighbourhoods, const Stencils &shape,
                           MaterialPoints &points);

    /** There are more particles, those with the identifiers @p ids; the one at place old_place[i]
     * is now number i, others are new. Where gains[i] it is a node of cells that came. Follows
     * prepare_search(); with the search after it a new particle gets a bond also with a damaged one
     * if cells came to both, since these have joined them. */
    void add_particles(const std::vector<std::uint64_t> &ids,
                       const std::vector<unsigned int> &old_place, const std::vector<bool> &gains);

    /** Between add_particles() and finish_search(): takes those pairs out of rows in another
     * configuration that finish_search() will refuse. @p partition as in remove_broken().
     * Collective. */
    void remove_unbonded(const std::shared_ptr<const NodePartition> &partition,
                         Neighbourhoods<dim> &neighbourhoods, Stencils &shape);

    /** Takes @p shape as the rows of the start, for particles without broken bonds. */
    void measure_rows(const Stencils &shape);

    /** After bonds broke, before remove_broken(): of particles with broken bonds, neighbours that
     * the last search found out of the support (φ = 0) stay without a bond, wherever they move.
     * Collective. */
    void refuse_unbonded(const std::shared_ptr<const NodePartition> &partition,
                         const Neighbourhoods<dim> &neighbourhoods, const Stencils &shape);

    /** Takes broken bonds out of the rows. @p partition has all nodes and images of @p
     * neighbourhoods. Collective. */
    void remove_broken(const std::shared_ptr<const NodePartition> &partition,
                       Neighbourhoods<dim> &neighbourhoods, Stencils &shape);

    /** Whether any bond is broken on any rank. */
    bool any() const
    {
      return is_broken_anywhere;
    }

    /** Before a search: keeps in mind the bonds that particles with broken ones still have. @p
     * partition as in remove_broken(). Collective. */
    void prepare_search(const std::shared_ptr<const NodePartition> &partition,
                        const Neighbourhoods<dim> &neighbourhoods, const Stencils &shape);

    /** After it: takes out broken bonds, and new ones of particles that have lost some.
     * Collective. */
    void finish_search(const std::shared_ptr<const NodePartition> &partition,
                       Neighbourhoods<dim> &neighbourhoods, Stencils &shape);

    /** Books the elastic energy of debris, of those of all points, and takes its stress away. */
    void release_debris(const Stencils &shape, const std::vector<double> &elastic_energies,
                        const std::vector<double> &initial_volume, MaterialPoints &points) const;

    /** Rigid rows with broken bonds, ascending. */
    std::vector<unsigned int> debris(const Stencils &shape) const;

    /** Over this rank's particles. */
    BondCounts counts(const Stencils &shape) const;

    /** Lists what is kept from step to step; rows are the particles. */
    void list(Records &records);

  private:
    explicit Bonds(const Entries &e);

    /** Breaks the bond at an entry of the rows; its other end goes to @p messages. */
    void break_entry(unsigned int row, std::size_t entry, const Neighbourhoods<dim> &neighbourhoods,
                     std::vector<PartnerMessage> &messages);
    /** Completes what break_entry() began. Returns whether there was anything on any rank.
     * Collective. */
    bool complete_breaking(const NodePartition &partition,
                           const std::vector<dealii::types::global_dof_index> &particles,
                           const std::vector<PartnerMessage> &messages, MaterialPoints &points);
    /** Whether a pair of a search, of which neither bond nor break is known, is no bond: one of its
     * ends is damaged. */
    bool is_refused(unsigned int row, unsigned int place) const;
    /** Finds who the neighbours are. Collective. */
    void find_partners(const std::shared_ptr<const NodePartition> &partition,
                       const Neighbourhoods<dim> &neighbourhoods);

    BondCheck<dim> check;
    bool isolates_all;
    MPI_Comm communicator = MPI_COMM_NULL;
    bool is_broken_anywhere = false;
    unsigned int fraction_field = 0, dissipation_field = 0;

    // By particle.
    std::vector<std::uint64_t> own_ids;
    std::vector<unsigned int> n_initial_bonds;
    std::vector<double> initial_gradient; // √Σ_J |∇φ_J|² [1/L]
    PartnerLists broken;
    PartnerLists refused;               // found by the last search, but never to be bonded
    PartnerLists previous;              // of bonds with a damaged end, only during a search
    std::vector<ParticleGrowth> growth; // since the last search; empty: none
    bool has_grown = false;

    NeighbourPartners<dim> partners;
  };
} // namespace tombolo
