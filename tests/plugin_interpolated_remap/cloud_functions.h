// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/kernel.h>

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <vector>

namespace tombolo
{
  /**
   * Convex functions through a cloud of points that exist everywhere: those of
   * ConvexApproximation with the exponential basis and the cubic spline, with a bounded multiplier,
   *
   * @verbatim
   *   φ_j = w_j exp(λ·ξ_j) / Σ w exp(λ·ξ),   ξ_j = W (x_j - x),   W: the mean of W_j
   *   λ:  the minimum of ln Σ w exp(λ·ξ) + ½ (|λ| - L)₊²
   * @endverbatim
   *
   * w_j is the product of the kernel at the components of W_j (x_j - x): supports can have the
   * shape of sheared cells. Inside of the hull of the neighbours they reproduce linear fields.
   * Outside, where functions that are positive cannot, they are those of a point near the nearest
   * face of the hull, and depend continuously on the position.
   */
  template <int dim>
  class CloudFunctions
  {
  public:
    /** Sets @p values to φ_j at @p x for neighbours with these positions, and W_j as @p metrics.
     * Returns false, without values, where no support reaches x. */
    bool evaluate(const dealii::Point<dim> &x, const std::vector<dealii::Point<dim>> &positions,
                  const std::vector<dealii::Tensor<2, dim>> &metrics, std::vector<double> &values);

  private:
    /** What is minimized, with its derivatives; and φ. */
    struct Sums
    {
      bool is_bounded = false; ///< |λ| > L
      double potential = 0;
      dealii::Tensor<1, dim> gradient;
      dealii::Tensor<2, dim> hessian;

      double size() const
      {
        return gradient.norm();
      }
    };
    Sums sums_at(const dealii::Tensor<1, dim> &multiplier);
    void find_weights(const dealii::Point<dim> &x, const std::vector<dealii::Point<dim>> &positions,
                      const std::vector<dealii::Tensor<2, dim>> &metrics);

    std::shared_ptr<const Kernel> kernel = make_kernel("cubic spline");
    std::vector<double> coordinate, factor, slope; // of the kernel, axis by axis
    std::vector<std::size_t> active;               // neighbours with a weight
    std::vector<double> weight, share;             // of active ones
    std::vector<dealii::Tensor<1, dim>> offset;    // likewise
  };
} // namespace tombolo
