// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>

#include <tombolo/base/simd/unroll.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * The shape functions of the particles of one part, as compressed rows: row i belongs to the i-th
   * particle of this rank (an owned node), and holds φ_J(x_I) and ∇φ_J(x_I) for its neighbours J
   * (owned or ghost nodes), eq. (6). Gradients are with respect to the reference configuration of
   * the kernel, three doubles each (z zero in two dimensions).
   *
   * Rows with the same φ and ∇φ, as they are on lattices and along extruded bodies, may keep them
   * once (RowSharing): then what a sweep reads of them stays in the caches.
   */
  struct Stencils
  {
    /** Local node number of each row's particle. */
    std::vector<unsigned int> particle_node;
    /** Rows: neighbours of row i are entries row_start[i] ... row_start[i+1]-1. */
    std::vector<std::size_t> row_start;
    /** Local node number of each neighbour. */
    std::vector<unsigned int> neighbour;
    /** Where φ of the first neighbour of each row is in value; ∇φ is at three times that. */
    std::vector<std::size_t> coefficient_start;
    dealii::AlignedVector<double> value;
    /** Three for each of value, and one more, so that four can be read. [1/L] */
    dealii::AlignedVector<double> gradient;
    /** Rounded rows instead of both, each φ before ∇φ; empty where there are none. */
    dealii::AlignedVector<float> rounded;
    /** Rows whose neighbours do not carry a linear basis, ascending: their φ is Shepard's,
     * w_J/Σw, and their ∇φ zero, so that the particle moves with its neighbours and is not
     * strained. Their deformation counts as the identity. */
    std::vector<unsigned int> rank_deficient_rows;
    /** Rows whose ∇φ counts as it is, ascending, where others have their deformation taken into
     * account: that of these counts as the identity. */
    std::vector<unsigned int> uncorrected_rows;
    /** Whether that holds for all rows. */
    bool is_uncorrected = false;
    /** Rows whose negative φ were removed (remove_negative_values()); in no order. */
    std::vector<unsigned int> non_negative_rows;
    /** Whether the nodal forces of a constant stress are those of its tractions, lumped as by
     * linear elements: then the mass that they accelerate is the lumped one, too, and loads act at
     * the nodes themselves. Otherwise both are spread by Φᵀ. */
    bool is_lumped = false;
    /** Of lumped rows: the mass that their forces accelerate over the lumped one. It differs from
     * one next to other parts, where what S does to long waves ends. */
    std::vector<double> accelerated_share;
    /** Lumped mass of each particle: the share of the part's mass [M]. */
    std::vector<double> mass;
    /** Where the particles are in the kernel's reference, with current ghosts: what the affine
     * smoothing takes its offsets from. Empty where nothing needs it. [L] */
    NodalVector reference_position;
    /** Inverse of F_I = Σ_J x_J ⊗ ∇φ_J, the deformation since the kernel's reference, at the
     * present positions: three rows of node_stride doubles per particle. Current gradients are
     * F⁻ᵀ∇φ. Filled by update_inverse_deformation(). */
    dealii::AlignedVector<double> inverse_deformation;
    bool inverse_deformation_is_current = false;

    /** Doubles for each ∇φ. */
    static constexpr unsigned int n_gradient = 3;

    /** The neighbours of one particle, and their φ and ∇φ. */
    struct Row
    {
      unsigned int size;
      const unsigned int *neighbour;
      const double *value;
      const double *gradient; ///< n_gradient a neighbour

      /** Whether neighbour @p k is within the support. At the edge of a lattice φ itself is zero
       * but for round-off at neighbours further in, where ∇φ is not. */
      bool is_within_support(const unsigned int k) const
      {
        const double *const neighbour_gradient = gradient + k * n_gradient;
        return value[k] != 0. || neighbour_gradient[0] != 0. || neighbour_gradient[1] != 0. ||
               neighbour_gradient[2] != 0.;
      }
    };

    /** Of rounded rows, it holds until the next call of one of these three. */
    TOMBOLO_ALWAYS_INLINE Row row(const unsigned int i) const
    {
      return find_row(i, true, true);
    }
    /** The same where ∇φ is not needed; it is undefined. */
    TOMBOLO_ALWAYS_INLINE Row row_of_values(const unsigned int i) const
    {
      return find_row(i, true, false);
    }
    /** The same where φ is not needed; it is undefined. */
    TOMBOLO_ALWAYS_INLINE Row row_of_gradients(const unsigned int i) const
    {
      return find_row(i, false, true);
    }

    bool is_rigid(const unsigned int i) const
    {
      return !rank_deficient_rows.empty() &&
             std::binary_search(rank_deficient_rows.begin(), rank_deficient_rows.end(), i);
    }

    /** Whether the deformation of row @p i since the kernel's reference counts as the identity. */
    bool is_undeformed(const unsigned int i) const
    {
      return is_uncorrected || is_rigid(i) ||
             (!uncorrected_rows.empty() &&
              std::binary_search(uncorrected_rows.begin(), uncorrected_rows.end(), i));
    }

    unsigned int n_particles() const
    {
      return static_cast<unsigned int>(particle_node.size());
    }

    /** Puts negative φ of row @p i to zero and scales the others so that their sum stays one: no
     * linear functions any more, but no extrapolation either. ∇φ stays. */
    void remove_negative_values(unsigned int i);

    /** Keeps all rows in single precision: φ, and each component of ∇φ, as multiples of a power of
     * two of at most 2⁻²² of the largest in the row. Sums over the row stay, one of φ and zero of
     * ∇φ, without round-off: momentum stays and a translation strains nothing. */
    void round();

  private:
    TOMBOLO_ALWAYS_INLINE Row find_row(const unsigned int i, const bool with_values,
                                       const bool with_gradients) const
    {
      if (!rounded.empty())
        return rounded_row(i, with_values, with_gradients);
      const std::size_t begin = row_start[i], coefficients = coefficient_start[i];
      return {static_cast<unsigned int>(row_start[i + 1] - begin), neighbour.data() + begin,
              value.data() + coefficients, gradient.data() + n_gradient * coefficients};
    }
    Row rounded_row(unsigned int i, bool with_values, bool with_gradients) const;
    /** Writes a row behind the others and returns where. */
    std::size_t append(const std::vector<double> &values, const std::vector<double> &gradients);

    mutable dealii::AlignedVector<double> last_row; // of rounded_row(): a quarter for φ, then ∇φ
  };

  /** A particle that has lost what carried it, and its row of φ before. */
  struct LeavingParticle
  {
    unsigned int row; ///< of the shape functions
    /** Local nodes of the partition in force before, and φ. */
    std::vector<std::pair<unsigned int, double>> entries;
  };

  /** The shape functions of one part as they were before they changed. */
  class FormerRows
  {
  public:
    /** Copies φ of all rows, unless it has a copy already. */
    void remember(const Stencils &shape);

    /** Which of the ascending @p candidates, rows of @p shape, were not rigid or had more
     * neighbours with φ ≠ 0 before. Forgets the copy; without one, none. */
    std::vector<LeavingParticle> leaving(const Stencils &shape,
                                         const std::vector<unsigned int> &candidates);

  private:
    bool is_kept = false;
    Stencils former; // as it was, without ∇φ
  };
} // namespace tombolo
