// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/mesh/face_shapes.h>
#include <tombolo/state/nodal_vector.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The boundary of a part: faces of its cells on the boundary of the body (not in a plane of
   * symmetry), and faces that it shares with other parts. Gives the vector areas of nodes, A_k =
   * ∫ N_k n dA with the outward normal n, in given positions: Σ_k A_k = 0 and Σ_k A_k ⊗ x_k is the
   * part's volume times the identity. Each face is with the rank that owns its cell.
   */
  template <int dim>
  class PartBoundary
  {
  public:
    void initialize(const PartSetup<dim> &setup);

    /** Adds the areas of nodes on the boundary of the body to @p free, those on faces shared with
     * other parts to @p shared; ghosts are collected by the caller. The two can be the same. */
    void add_areas(const NodalVector &position, NodalVector &free, NodalVector &shared) const;

  private:
    std::vector<dealii::types::global_dof_index> face_nodes; ///< those of a face together
    std::vector<double> orientation; ///< of each face: the sign of t₁ × t₂ (in 2-D of (t_y, -t_x))
    std::vector<bool> is_shared;     ///< of each face
    FaceShapes<dim> shapes;
  };

  /** How far the gradients of a part are from passing the linear patch test. */
  struct PatchTest
  {
    bool is_known = false;
    double defect = 0; ///< patch_test_defect()
    std::string cure;  ///< the entry that would remove the defect; empty: there is none
  };

  /**
   * How far gradients fail the linear patch test of the nodally integrated Galerkin form: a
   * constant stress makes no force inside, and at the boundary that of its traction alone, only if
   * Σ_I V_I ∇φ_J(x_I) = b_J, where b_J is the vector area of the boundary that belongs to J, as the
   * nodal forces of tractions have it. Returns |b - Σ_I V_I ∇φ(x_I)| / |b|, in the Euclidean norm
   * over all nodes; zero where b is.
   *
   * @p smooths: whether velocities are smoothed by the rows of @p shape, @p volume is that of
   * each row in the reference of the kernels, @p position where the stencils were computed, on the
   * partition of their numbers, which has all nodes of the boundary, with current ghosts.
   * @p own_shares are those of the part in the volumes of particles around which equal parts have
   * cells, too: particles with one below 1 are not tested. Empty: all are 1. Collective.
   */
  template <int dim>
  double patch_test_defect(const PartSetup<dim> &setup, const ParticleSet<dim> &particles,
                           bool smooths, const std::vector<double> &volume,
                           const NodalVector &position, const Stencils &shape,
                           const std::vector<double> &own_shares = {});
} // namespace tombolo
