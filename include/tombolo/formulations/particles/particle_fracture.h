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
    /** Takes the criterion of the section of the formulation, or none. The other arguments must
     * outlive this object, which changes rows and points. Throws InputError. */
    ParticleFracture(const Section &section, const ParticleSet<dim> &particles,
                     const KernelConfiguration<dim> &kernel, ParticleRows<dim> &rows,
                     PartPoints &points);

    bool is_on() const
    {
      return bonds != nullptr;
    }
    /** On any rank. */
    bool has_broken_bonds() const
    {
      return bonds != nullptr && bonds->any();
    }

    /** What points must hold; none if off. */
    std::vector<FieldDescription> variables() const
    {
      return bonds ? bonds->variables() : std::vector<FieldDescription>();
    }

    /** Takes the rows of the start. Throws InputError where the points cannot be judged. */
    void initialize()
    {
      if (bonds)
        bonds->initialize(particles.persistent_ids(), rows.stencils(), points.points(),
                          particles.communicator());
    }

    /** What is called before stencils change in a run, on all ranks. */
    void set_before_change(const std::function<void()> &to_call)
    {
      before_change = to_call;
    }
    /** Calls it, and remembers the rows as they are. */
    void prepare_change();

    /** Around a search of neighbours: particles that have lost bonds get no new ones.
     * Collective. */
    void prepare_search()
    {
      if (has_broken_bonds())
        bonds->prepare_search(rows.partition(particles), rows.neighbourhoods(), rows.stencils());
    }
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
    void add_particles(const std::vector<unsigned int> &old_index, const std::vector<bool> &gains)
    {
      if (bonds)
        bonds->add_particles(particles.persistent_ids(), old_index, gains);
    }
    /** Takes unbonded pairs out of rows in the initial configuration, as
     * Bonds::remove_unbonded(). */
    void remove_unbonded(const std::shared_ptr<const NodePartition> &partition,
                         Neighbourhoods<dim> &neighbourhoods, Stencils &shape)
    {
      if (bonds)
        bonds->remove_unbonded(partition, neighbourhoods, shape);
    }
    /** Takes @p shape as the rows of the start, for particles without broken bonds. */
    void measure_rows(const Stencils &shape)
    {
      if (bonds)
        bonds->measure_rows(shape);
    }

    std::vector<unsigned int> debris() const
    {
      return bonds ? bonds->debris(rows.stencils()) : std::vector<unsigned int>();
    }
    LeavingParticles take_leaving_particles()
    {
      return bonds ? former_rows.leaving(rows.stencils(), debris()) : LeavingParticles();
    }
    BondCounts counts() const
    {
      return bonds ? bonds->counts(rows.stencils()) : BondCounts();
    }
    /** Elastic energy of debris, over this rank. */
    double dissipated_energy() const
    {
      return bonds ? integral_over_initial_volume(points.points(), Bonds<dim>::dissipation_name)
                   : 0.;
    }

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
