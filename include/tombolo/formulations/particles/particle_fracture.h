// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/former_rows.h>
#include <tombolo/formulations/failure/bonds.h>
#include <tombolo/formulations/part_points.h>
#include <tombolo/formulations/particles/kernel_configuration.h>
#include <tombolo/formulations/particles/particle_rows.h>
#include <tombolo/formulations/particles/particle_set.h>

#include <functional>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * What broken bonds do to the particles of one part: checks the bonds, takes the broken ones out
   * of the rows and computes these again in the reference of the kernels, keeps new searches from
   * finding lost neighbours, and releases the stress of debris. Where no bond can break, all calls
   * do nothing.
   */
  template <int dim>
  class ParticleFracture
  {
  public:
    /** The arguments must outlive this object, which changes rows and points. */
    ParticleFracture(const ParticleSet<dim> &particles, const KernelConfiguration<dim> &kernel,
                     ParticleRows<dim> &rows, PartPoints &points);

    /** Takes the criterion of the section of the formulation, or none. Throws InputError. */
    void choose(const Section &section);

    bool is_on() const;
    bool has_broken_bonds() const; ///< on any rank

    /** What points must hold; none if off. */
    std::vector<FieldDescription> variables() const;

    /** Takes the rows of the start. Throws InputError where the points cannot be judged. */
    void initialize();

    /** What is called before stencils change in a run, on all ranks. */
    void set_before_change(const std::function<void()> &to_call);
    /** Calls it, and remembers the rows as they are. */
    void prepare_change();

    /** Around a search of neighbours: particles that have lost bonds get no new ones.
     * Collective. */
    void prepare_search();
    void finish_search();

    /** Checks the bonds at @p position (current ghosts) if that is due; where any breaks, rows,
     * values and gradients change. Returns whether they did, the same on all ranks. Collective. */
    bool update(const NodalVector &position);

    /** Takes all bonds from particles with broken ones that are not sound at @p position, until
     * none is left. Returns as update(). Collective. */
    bool isolate_distorted(const NodalVector &position);
    /** The same at the positions of the reference, after a search whose numbers the rows still
     * have; they get those of a partition. Collective. */
    void isolate_distorted_in_reference();

    /** Takes the stress of debris away, and accounts for its elastic energy. */
    void release_debris();

    /** After cells became particles: particle i was number @p old_index[i] or is new, and gains
     * mass where @p gains[i]. */
    void add_particles(const std::vector<unsigned int> &old_index, const std::vector<bool> &gains);
    /** Takes unbonded pairs out of rows in the initial configuration, as
     * Bonds::remove_unbonded(). */
    void remove_unbonded(const std::shared_ptr<const NodePartition> &partition,
                         Neighbourhoods<dim> &neighbourhoods, Stencils &shape);
    /** Takes @p shape as the rows of the start, for particles without broken bonds. */
    void measure_rows(const Stencils &shape);

    std::vector<unsigned int> debris() const;
    LeavingParticles take_leaving_particles();
    BondCounts counts() const;
    double dissipated_energy() const; ///< elastic energy of debris, over this rank

    void list(Records &records)
    {
      if (bonds)
        bonds->list(records);
    }
    /** Takes broken bonds out of rows that were searched anew, on @p partition. Returns whether
     * there are any on any rank. Collective. */
    bool complete_reading(const std::shared_ptr<const NodePartition> &partition);

  private:
    bool break_bonds(const NodalVector &position);
    /** Takes what broke out of the rows, and computes these. Collective. */
    void renew_broken_rows(const std::shared_ptr<const NodePartition> &partition);

    const ParticleSet<dim> &particles;
    const KernelConfiguration<dim> &kernel;
    ParticleRows<dim> &rows;
    PartPoints &points;
    std::unique_ptr<Bonds<dim>> bonds; // null: they do not break
    FormerRows former_rows;            // only during an update
    std::function<void()> before_change;
  };
} // namespace tombolo
