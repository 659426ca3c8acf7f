#pragma once

#include <deal.II/base/aligned_vector.h>

#include <tombolo/state/node_partition.h>

#include <cstdint>
#include <vector>

namespace tombolo
{
  /**
   * The shape functions of the particles of one part, as compressed rows: row i belongs to the i-th
   * particle of this rank (an owned node), and holds φ_J(x_I) and ∇φ_J(x_I) for its neighbours J
   * (owned or ghost nodes), eq. (6). Gradients are with respect to the reference configuration of
   * the kernel, padded to n_slots doubles (the pad, and z in two dimensions, zero).
   */
  struct ShapeFunctions
  {
    /** Local node number of each row's particle. */
    std::vector<unsigned int> particle_node;
    /** Rows: neighbours of row i are entries row_start[i] ... row_start[i+1]-1. */
    std::vector<std::size_t> row_start;
    /** Local node number of each neighbour. */
    std::vector<unsigned int> neighbour;
    dealii::AlignedVector<double> value;    ///< φ, one per entry
    dealii::AlignedVector<double> gradient; ///< ∇φ, n_slots per entry [1/L]
    /** Rows whose neighbours do not carry a linear basis, ascending: their φ is Shepard's,
     * w_J/Σw, and their ∇φ zero, so that the particle goes along with its neighbours and is not
     * strained. Their deformation counts as the identity. */
    std::vector<unsigned int> rigid_rows;
    /** m̂ of each particle: the share of the part's mass [M]. */
    std::vector<double> mass;
    /** Inverse of F_I = Σ_J x_J ⊗ ∇φ_J, the deformation since the kernel's reference, at the
     * present positions: three columns of n_slots doubles per particle. Current gradients are
     * F⁻ᵀ∇φ. Filled by update_inverse_deformation() or by the affine smoothing, whichever comes
     * first in a step. */
    dealii::AlignedVector<double> inverse_deformation;
    bool inverse_deformation_is_current = false;

    unsigned int n_particles() const
    {
      return static_cast<unsigned int>(particle_node.size());
    }

    std::size_t memory_consumption() const;
  };
} // namespace tombolo
