// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/kernel.h>
#include <tombolo/approximation/stencils.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /** A particle whose neighbours do not carry the linear basis. */
  struct BasisDefect
  {
    unsigned int row;          ///< index into Stencils::particle_node
    unsigned int n_neighbours; ///< with a weight above zero, the particle itself included
    /** Condition number of the moment matrix in coordinates scaled by the particle's support;
     * infinite where it is singular. */
    double condition;
  };

  /**
   * Moving least squares with the basis [1, x, y, z] and tensor products of a kernel, at the
   * particles: fills value and gradient of Stencils for given neighbours (eq. 6 of Pan et
   * al. 2019; doc/method.md, section 2),
   *
   * @verbatim
   *   φ_J(x) = q(x)ᵀ M(x)⁻¹ q(x_J) w_J(x)
   *   M(x) = Σ_J w_J(x) q(x_J) q(x_J)ᵀ
   *   w_J(x) = Π_k w((x_J,k - x_k) / a_J,k)
   * @endverbatim
   *
   * with q = [1, (y - x_I)/a_I] about the evaluation point x_I, so that nothing is lost far from
   * the origin, and the full gradient, with c = M⁻¹ e_0,
   *
   * @verbatim
   *   ∇φ_J = (b · q_J) w_J + (c · q_J) ∇w_J
   *   b_k = M⁻¹ (e_k / a_I,k - Σ_J ∂_k w_J (c · q_J) q_J)
   * @endverbatim
   *
   * Neighbours that are outside their own support keep φ = 0, ∇φ = 0. Eight particles go through
   * the lanes of one batch. Buffers are kept: a second call of the same size allocates nothing.
   */
  template <int dim>
  class MovingLeastSquares
  {
  public:
    /** Moment matrices above this condition number are reported, not solved with. */
    static constexpr double largest_condition = 1e8;

    explicit MovingLeastSquares(std::shared_ptr<const Kernel> kernel);

    /**
     * Computes value and gradient of all rows from @p position and half widths @p support,
     * node_stride doubles per local node. @p nodes lists the local nodes that occur as particle or
     * neighbour. A particle with a defect gets Shepard's functions, w_J/Σw, and no gradient. The
     * reference stays valid until the next call. With @p share_rows, rows that are the same are
     * kept once (RowSharing), where that at least halves what is kept; the others then have their
     * own.
     */
    const std::vector<BasisDefect> &compute(const std::vector<unsigned int> &nodes,
                                            const double *position, const double *support,
                                            Stencils &shape, bool share_rows = false);

    /**
     * The smallest factor, on a scale of 5 % steps up to @p largest_factor, by which all supports
     * would have to grow for the particle at local node @p particle to have a condition below
     * @p sufficient_condition; zero if none does. Searches all @p nodes: for messages.
     */
    double sufficient_support_factor(unsigned int particle, const std::vector<unsigned int> &nodes,
                                     const double *position, const double *support,
                                     double largest_factor = 8.,
                                     double sufficient_condition = 1e4) const;

    const Kernel &kernel() const
    {
      return *chosen_kernel;
    }

  private:
    /** One node as the batches read it: position and inverse support in one cache line. */
    struct alignas(64) NodeRecord
    {
      double position[node_stride];
      double inverse_support[node_stride];
    };

    /** The moment matrix of a particle, row-major, with weights counted in @p n_neighbours. */
    void moment_matrix(const double *center, const double *center_support,
                       const std::vector<const NodeRecord *> &neighbours, double support_factor,
                       double (&moment)[dim + 1][dim + 1], unsigned int &n_neighbours) const;

    /** w_J/Σw about a centre. */
    void set_shepard(const double *center, const unsigned int *neighbours,
                     unsigned int n_neighbours, double *value) const;

    /** Rows first_row ... first_row + 7 below @p end_row; their coefficients go to @p value and @p
     * gradient, which begin with those of the first neighbour of first_row. */
    void compute_batch(unsigned int first_row, unsigned int end_row, const Stencils &shape,
                       double *value, double *gradient);

    /** Gives a row Shepard's functions if its moment matrix has too large a condition number, and
     * remembers its defect. */
    void check_basis(unsigned int row, const Stencils &shape, double *value, double *gradient);

    /** False, and without a result, where too few rows are the same. */
    bool compute_shared(Stencils &shape);

    std::shared_ptr<const Kernel> chosen_kernel;
    std::vector<BasisDefect> defects;
    dealii::AlignedVector<NodeRecord> records;
    dealii::AlignedVector<double> coordinate, offset, inverse_support, weight, weight_slope, result;
  };
} // namespace tombolo
