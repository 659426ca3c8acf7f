// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/consistent_gradients.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/formulations/particles/part_boundary.h>
#include <tombolo/formulations/particles/particle_set.h>

#include <deal.II/base/index_set.h>

#include <vector>

namespace tombolo
{
  /**
   * Makes the gradients of the particles of one part pass the linear patch test
   * (ConsistentGradients), where the entry `Gradient` chooses it: finds the vector areas of the
   * boundary as the nodal forces of a constant stress see them. Off, it holds and does nothing.
   */
  template <int dim>
  class PatchTestGradients
  {
  public:
    static void declare_parameters(dealii::ParameterHandler &handler);

    PatchTestGradients() = default;
    explicit PatchTestGradients(const Section &section);

    bool is_on() const;

    /** Finds the boundary of the part. @p smooths tells whether velocities are smoothed by the
     * rows. Before all below. */
    void initialize(const PartSetup<dim> &setup, const ParticleSet<dim> &particles, bool smooths);

    /** Nodes of the boundary, whose values this rank must see; empty if off. */
    dealii::IndexSet required_nodes() const;

    /**
     * Changes the gradients of @p shape. @p volume is that of each row in the reference of the
     * kernels, @p position where the stencils were computed, on the partition of their numbers,
     * with current ghosts. If on. Collective.
     */
    void establish(const std::vector<double> &volume, const NodalVector &position, Stencils &shape);

    /** How far gradients as they are fail the test (ConsistentGradients::defect()); all nodes of
     * the boundary must have numbers in the partition. Arguments as of establish(). Collective. */
    double defect(const std::vector<double> &volume, const NodalVector &position,
                  const Stencils &shape) const;

    /** What the last establish() did; null if off. */
    const GradientConsistency *consistency() const;

    std::size_t memory_consumption() const;

  private:
    /** The vectors b of owned nodes: where tractions of a constant stress act as nodal forces.
     * Collective. */
    NodalVector boundary_areas(const NodalVector &position, const Stencils &shape) const;

    bool is_chosen = false;
    double tolerance = 0;
    bool smooths_velocity = true;
    bool trace_bridge = false;
    std::vector<bool> has_unit_row; // of Φ, by particle: its motion is prescribed
    PartBoundary<dim> boundary;
    GradientConsistency result;
  };
} // namespace tombolo
