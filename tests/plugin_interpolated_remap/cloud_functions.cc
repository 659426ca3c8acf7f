// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cloud_functions.h"

#include <tombolo/approximation/convex_approximation.h>
#include <tombolo/base/simd/vectorization.h>

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** L: functions of neighbours that are farther than a thirtieth of a support behind a face are
     * at round-off on it. */
    constexpr double largest_multiplier = 1000.;

    /** Near faces of the hull the Hessian is nearly singular across them: its eigenvalues are known
     * to round-off of the largest, where an inverse by determinants would lose half of the digits.
     */
    template <int dim>
    Tensor<1, dim> newton_step(const Tensor<2, dim> &hessian, const Tensor<1, dim> &gradient)
    {
      constexpr double smallest = 1e-15;
      Tensor<1, dim> step;
      for (const auto &pair :
           eigenvectors(symmetrize(hessian), SymmetricTensorEigenvectorMethod::jacobi))
        step -= (pair.second * gradient) / std::max(pair.first, smallest) * pair.second;
      return step;
    }
  } // namespace

  template <int dim>
  void CloudFunctions<dim>::find_weights(const Point<dim> &x,
                                         const std::vector<Point<dim>> &positions,
                                         const std::vector<Tensor<2, dim>> &metrics)
  {
    const std::size_t n = positions.size();
    const std::size_t n_padded = padded_to_lanes(static_cast<unsigned int>(n));
    coordinate.assign(dim * n_padded, 2.); // outside of any support
    factor.resize(coordinate.size());
    slope.resize(coordinate.size());
    for (std::size_t j = 0; j < n; ++j)
    {
      const Tensor<1, dim> scaled = metrics[j] * (positions[j] - x);
      for (unsigned int d = 0; d < dim; ++d)
        coordinate[d * n_padded + j] = scaled[d];
    }
    kernel->evaluate(coordinate.size(), coordinate.data(), factor.data(), slope.data());
    active.clear();
    weight.clear();
    offset.clear();
    Tensor<2, dim> mean;
    for (std::size_t j = 0; j < n; ++j)
    {
      double product = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        product *= factor[d * n_padded + j];
      if (!(product > 0.))
        continue;
      active.push_back(j);
      weight.push_back(product);
      offset.push_back(positions[j] - x);
      mean += metrics[j];
    }
    mean /= static_cast<double>(std::max<std::size_t>(1, active.size()));
    for (Tensor<1, dim> &distance : offset)
      distance = mean * distance;
    share.resize(active.size());
  }

  template <int dim>
  typename CloudFunctions<dim>::Sums CloudFunctions<dim>::sums_at(const Tensor<1, dim> &multiplier)
  {
    double total = 0, largest = -1e300;
    for (std::size_t j = 0; j < active.size(); ++j)
    {
      share[j] = multiplier * offset[j];
      largest = std::max(largest, share[j]);
    }
    for (std::size_t j = 0; j < active.size(); ++j)
    {
      share[j] = weight[j] * std::exp(share[j] - largest);
      total += share[j];
    }
    Sums sums;
    Tensor<2, dim> second;
    for (std::size_t j = 0; j < active.size(); ++j)
    {
      share[j] /= total;
      sums.gradient += share[j] * offset[j];
    }
    // About the mean, where nothing cancels.
    for (std::size_t j = 0; j < active.size(); ++j)
    {
      const Tensor<1, dim> distance = offset[j] - sums.gradient;
      sums.hessian += share[j] * outer_product(distance, distance);
    }
    sums.potential = std::log(total) + largest;
    const double length = multiplier.norm(), excess = length - largest_multiplier;
    sums.is_bounded = excess > 0.;
    if (sums.is_bounded)
    {
      const Tensor<1, dim> direction = multiplier / length;
      sums.potential += 0.5 * excess * excess;
      sums.gradient += excess * direction;
      sums.hessian += (1. - excess / length) * outer_product(direction, direction);
      for (unsigned int d = 0; d < dim; ++d)
        sums.hessian[d][d] += excess / length;
    }
    return sums;
  }

  template <int dim>
  bool CloudFunctions<dim>::evaluate(const Point<dim> &x, const std::vector<Point<dim>> &positions,
                                     const std::vector<Tensor<2, dim>> &metrics,
                                     std::vector<double> &values)
  {
    constexpr double tolerance = 1e-15, tolerance_at_bound = 1e-12, longest_step = 200.;
    constexpr MostSteps most{300, 40};
    find_weights(x, positions, metrics);
    if (active.empty())
      return false;
    Tensor<1, dim> multiplier;
    Sums sums;
    minimize_convex(
        most, [this](const Tensor<1, dim> &trial) { return sums_at(trial); },
        [](const Sums &trial_sums)
        {
          const Tensor<1, dim> step = newton_step(trial_sums.hessian, trial_sums.gradient);
          return std::min(1., longest_step / step.norm()) * step;
        },
        [](const Sums &trial_sums)
        { return trial_sums.size() <= (trial_sums.is_bounded ? tolerance_at_bound : tolerance); },
        multiplier, sums);
    sums_at(multiplier);
    values.assign(positions.size(), 0.);
    for (std::size_t j = 0; j < active.size(); ++j)
      values[active[j]] = share[j];
    return true;
  }

  template class CloudFunctions<2>;
  template class CloudFunctions<3>;
} // namespace tombolo
