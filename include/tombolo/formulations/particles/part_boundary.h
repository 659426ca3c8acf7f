// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/formulation.h>
#include <tombolo/mesh/face_shapes.h>
#include <tombolo/state/nodal_vector.h>

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
} // namespace tombolo
