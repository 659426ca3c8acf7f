// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/simd/vectorization.h>

#include <vector>

namespace tombolo
{
  /**
   * The sweeps over shape function rows that Φ, S and their affine forms are made of. All vectors
   * are nodal, node_stride doubles a node, at the address of local node 0; @p row_mass has
   * node_stride doubles per row: the mass that the row smooths, by component. Sweeps that scatter
   * add at ghosts too; the caller collects.
   */
  namespace NodalSmoothing
  {
    inline const double *node(const double *field, const unsigned int local)
    {
      return field + static_cast<std::size_t>(local) * node_stride;
    }
    inline double *node(double *field, const unsigned int local)
    {
      return field + static_cast<std::size_t>(local) * node_stride;
    }

    /** result_J += φ_J(x_I) @p value, for the neighbours of one particle. */
    void scatter_row(const Stencils::Row &row, const NodeLanes &value, double *result);

    /** Σ_J φ_J(x_I) a_J of one particle. */
    NodeLanes gather_row(const Stencils::Row &row, const double *field);

    /** F_I = Σ_J x_J ⊗ ∇φ_J and its inverse, to @p shape. Throws RunError where F is singular. */
    template <int dim>
    void update_inverse_deformation(const double *position, Stencils &shape);
    /** The same, unless it is current or a determinant is not positive; the caller reports that. */
    template <int dim>
    void try_inverse_deformation(const double *position, Stencils &shape);

    /** momentum_J += Σ_I φ_J(x_I) m_I v_I: the numerator of eq. (12), Φᵀ M̂ v̂. */
    void scatter(const Stencils &shape, const double *row_mass, const double *velocity,
                 double *momentum);

    /** result_I += w_I Σ_J φ_J(x_I) a_J, w of node_stride per row: rows of Φ, eqs (22), (25). */
    void gather(const Stencils &shape, const double *row_weight, const double *field,
                double *result);

    /** Two gathers in one sweep, and the scatter of the following step: for every row
     *
     * @verbatim
     *   v̂_I += w_I Δt_n Σ_J φ_J(x_I) a_J
     *   x_I += w_I Δt Σ_J φ_J(x_I) (v_J + Δt_n a_J)
     *   momentum_J += φ_J(x_I) m_I v̂_I
     * @endverbatim
     *
     * The last line is done where @p momentum is not null. */
    void gather_motion(const Stencils &shape, const double *row_weight, const double *row_mass,
                       const double *velocity, const double *acceleration,
                       double velocity_time_step, double position_time_step,
                       double *unsmoothed_velocity, double *position, double *momentum);

    /** momentum_I += Σ_J φ_I(x_J) m_J [v̂_J + (∇v̂)_J (X_I - X_J)], with gradients and offsets in
     * the kernel's reference: the numerator of the affine smoothing (doc/method.md, M12). Of some
     * @p rows, or null: of all. */
    void scatter_affine(const Stencils &shape, const double *row_mass, const double *velocity,
                        double *momentum, const std::vector<unsigned int> *rows = nullptr);

    /** The transpose of scatter_affine: for the row of every particle J and its neighbours K
     *
     * @verbatim
     *   result_J += m_J Σ_I φ_I(x_J) a_I
     *   result_K += (Σ_I m_J φ_I(x_J) a_I ⊗ (X_I - X_J)) ∇φ_K
     *   result_J -= the sum of the second line over K
     * @endverbatim */
    void gather_affine(const Stencils &shape, const double *row_mass, const double *field,
                       double *result, const std::vector<unsigned int> *rows = nullptr);
  } // namespace NodalSmoothing
} // namespace tombolo
