// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/state/nodal_vector.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** How far the gradients of a part are from passing the linear patch test. */
  struct PatchTest
  {
    bool is_known = false;
    double defect = 0; ///< patch_test_defect()
    std::string cure;  ///< the entry that would take the defect away; empty: there is none
  };

  /**
   * How far gradients fail the linear patch test of the nodally integrated Galerkin form: a
   * constant stress makes no force inside, and at the boundary that of its traction alone, only if
   * Σ_I V_I ∇φ_J(x_I) = b_J, where b_J is the vector area of the boundary that belongs to J, as the
   * nodal forces of tractions see it. Returns |b - Σ_I V_I ∇φ(x_I)| / |b|, in the Euclidean norm
   * over all nodes; zero where b is.
   *
   * @p smooths tells whether velocities are smoothed by the rows of @p shape, @p volume is that of
   * each row in the reference of the kernels, @p position where the stencils were computed, on the
   * partition of their numbers, which has all nodes of the boundary, with current ghosts.
   * Collective.
   */
  template <int dim>
  double patch_test_defect(const PartSetup<dim> &setup, const ParticleSet<dim> &particles,
                           bool smooths, const std::vector<double> &volume,
                           const NodalVector &position, const Stencils &shape);
} // namespace tombolo
