// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/convex_approximation.h>

#include <tombolo/base/simd/eight_doubles.h>
#include <tombolo/base/simd/vector_math.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/state/node_partition.h>

#include <algorithm>
#include <limits>

namespace tombolo
{
  namespace
  {
    std::size_t padded_to_eight(const std::size_t n)
    {
      return (n + 7) / 8 * 8;
    }

    /** Neighbours in one plane leave the Hessian singular, and the residual without a part across
     * it: this share of its trace makes the plane's problem solvable. */
    constexpr double relative_shift = 1e-14;

    template <int dim>
    Tensor<1, dim> solve_shifted(Tensor<2, dim> matrix, const Tensor<1, dim> &right_hand_side)
    {
      const double shift = relative_shift * trace(matrix);
      for (unsigned int d = 0; d < dim; ++d)
        matrix[d][d] += shift;
      return invert(matrix) * right_hand_side;
    }
  } // namespace

  template <int dim>
  ConvexApproximation<dim>::ConvexApproximation(std::shared_ptr<const Kernel> kernel)
      : chosen_kernel(std::move(kernel))
  {}

  template <int dim>
  double ConvexApproximation<dim>::find_weights(const Point<dim> &x, const unsigned int n,
                                                const double *const position,
                                                const double *const support,
                                                const bool with_gradients)
  {
    const auto n_padded = static_cast<unsigned int>(padded_to_eight(n));
    coordinate.assign(std::size_t(dim) * n_padded, 2.); // outside of any support
    factor.resize(coordinate.size());
    slope.resize(coordinate.size());
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int k = 0; k < n; ++k)
        coordinate[d * n_padded + k] =
            (position[k * node_stride + d] - x[d]) / support[k * node_stride + d];
    chosen_kernel->evaluate(coordinate.size(), coordinate.data(), factor.data(), slope.data());

    active.clear();
    weight.assign(n_padded, 0.);
    for (std::vector<double> &component : offset)
      component.assign(n_padded, 0.);
    weight_gradient.clear();
    double sum = 0;
    for (unsigned int k = 0; k < n; ++k)
    {
      double product = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        product *= factor[d * n_padded + k];
      if (product == 0.)
        continue;
      weight[active.size()] = product;
      for (unsigned int d = 0; d < dim; ++d)
      {
        offset[d][active.size()] = position[k * node_stride + d] - x[d];
        sum += support[k * node_stride + d];
      }
      active.push_back(k);
      if (!with_gradients)
        continue;
      Tensor<1, dim> gradient;
      for (unsigned int d = 0; d < dim; ++d)
      {
        gradient[d] = -slope[d * n_padded + k] / support[k * node_stride + d];
        for (unsigned int e = 0; e < dim; ++e)
          if (e != d)
            gradient[d] *= factor[e * n_padded + k];
      }
      weight_gradient.push_back(gradient);
    }
    const double mean = active.empty() ? 1. : sum / (dim * static_cast<double>(active.size()));
    for (std::vector<double> &component : offset)
      for (std::size_t k = 0; k < active.size(); ++k)
        component[k] /= mean;
    return mean;
  }

  template <int dim>
  void ConvexApproximation<dim>::find_basis(const Tensor<1, dim> &multiplier)
  {
    const std::size_t n = padded_to_eight(active.size());
    if (basis_value.size() < n)
      basis_value.resize(n);
    double *const value = basis_value.data();
    for (std::size_t k = 0; k < n; ++k)
    {
      double argument = multiplier[0] * offset[0][k];
      for (unsigned int d = 1; d < dim; ++d)
        argument += multiplier[d] * offset[d][k];
      value[k] = argument;
    }
    for (std::size_t k = 0; k < n; ++k)
      value[k] = std::exp(value[k]);
  }

  template <int dim>
  typename ConvexApproximation<dim>::Sums
  ConvexApproximation<dim>::sums_at(const Tensor<1, dim> &multiplier)
  {
    find_basis(multiplier);
    // Σ w exp, the gradient, and then the lower half of the Hessian.
    constexpr unsigned int n_hessian = dim * (dim + 1) / 2;
    EightDoubles first[8], hessian[8];
    for (unsigned int i = 0; i < 8; ++i)
      first[i] = hessian[i] = 0.;
    for (std::size_t k = 0; k < active.size(); k += 8)
    {
      const EightDoubles of_weight = load_eight(weight.data() + k);
      const EightDoubles value = of_weight * load_eight(basis_value.data() + k);
      first[0] += value;
      EightDoubles at[dim];
      TOMBOLO_UNROLL
      for (unsigned int i = 0; i < dim; ++i)
      {
        at[i] = load_eight(offset[i].data() + k);
        first[1 + i] += value * at[i];
        TOMBOLO_UNROLL
        for (unsigned int j = 0; j <= i; ++j)
          hessian[i * (i + 1) / 2 + j] += value * at[i] * at[j];
      }
    }
    double of_first[8], of_hessian[8];
    store_eight(sums_of(first), of_first);
    store_eight(sums_of(hessian), of_hessian);
    static_assert(1 + dim <= 8 && n_hessian <= 8, "Sums fit into eight doubles.");
    Sums sums;
    sums.potential = sums.total = of_first[0];
    if (!(sums.total > 0.))
      sums.potential = std::numeric_limits<double>::infinity();
    for (unsigned int i = 0; i < dim; ++i)
    {
      sums.gradient[i] = of_first[1 + i];
      for (unsigned int j = 0; j <= i; ++j)
        sums.hessian[i][j] = sums.hessian[j][i] = of_hessian[i * (i + 1) / 2 + j];
    }
    return sums;
  }

  template <int dim>
  void ConvexApproximation<dim>::find_gradients(const Tensor<1, dim> &multiplier, const Sums &sums,
                                                const double mean_support,
                                                Tensor<1, dim> *const gradient)
  {
    for (unsigned int axis = 0; axis < dim; ++axis)
    {
      Tensor<1, dim> right_hand_side;
      for (std::size_t k = 0; k < active.size(); ++k)
      {
        right_hand_side += (weight_gradient[k][axis] * basis_value[k] -
                            weight[k] * basis_value[k] * multiplier[axis] / mean_support) *
                           offset_of(k);
        right_hand_side[axis] -= weight[k] * basis_value[k] / mean_support;
      }
      Tensor<1, dim> change = -1. * solve_shifted(sums.hessian, right_hand_side);
      change -= solve_shifted(sums.hessian, sums.hessian * change + right_hand_side);
      double sum = 0;
      for (std::size_t k = 0; k < active.size(); ++k)
      {
        const double numerator =
            weight_gradient[k][axis] * basis_value[k] +
            weight[k] * basis_value[k] * (change * offset_of(k) - multiplier[axis] / mean_support);
        gradient[active[k]][axis] = numerator;
        sum += numerator;
      }
      for (std::size_t k = 0; k < active.size(); ++k)
      {
        double &entry = gradient[active[k]][axis];
        entry = (entry - weight[k] * basis_value[k] / sums.total * sum) / sums.total;
      }
    }
  }

  template <int dim>
  typename ConvexApproximation<dim>::Result
  ConvexApproximation<dim>::solve(const unsigned int n, const double size, double *const value,
                                  Tensor<1, dim> *const gradient)
  {
    constexpr double tolerance = 1e-13, sufficient = 1e-11;
    constexpr MostSteps most{100, 50};
    Result result;
    std::fill_n(value, n, 0.);
    if (active.empty())
      return result;
    Tensor<1, dim> multiplier;
    Sums sums;
    result.n_iterations = minimize_convex(
        most, [this](const Tensor<1, dim> &trial) { return sums_at(trial); },
        [](const Sums &of_trial)
        { return -1. * solve_shifted(of_trial.hessian, of_trial.gradient); },
        [](const Sums &of_trial) { return of_trial.size() < tolerance; }, multiplier, sums);
    result.is_inside = sums.gradient.norm() < sufficient * sums.total;
    if (!result.is_inside)
      return result;
    find_basis(multiplier);
    for (std::size_t k = 0; k < active.size(); ++k)
      value[active[k]] = weight[k] * basis_value[k] / sums.total;
    if (gradient != nullptr)
    {
      std::fill_n(gradient, n, Tensor<1, dim>());
      find_gradients(multiplier, sums, size, gradient);
    }
    return result;
  }

  template <int dim>
  typename ConvexApproximation<dim>::Result
  ConvexApproximation<dim>::evaluate(const Point<dim> &x, const unsigned int n,
                                     const double *const position, const double *const support,
                                     double *const value, Tensor<1, dim> *const gradient)
  {
    const double mean_support = find_weights(x, n, position, support, gradient != nullptr);
    return solve(n, mean_support, value, gradient);
  }

  template <int dim>
  typename ConvexApproximation<dim>::Result ConvexApproximation<dim>::evaluate_moved(
      const Point<dim> &x, const unsigned int n, const double *const position,
      const double *const support, const Point<dim> &present_x, const double *const present,
      double *const value, Tensor<1, dim> *const gradient, const Tensor<2, dim> &inverse)
  {
    find_weights(x, n, position, support, gradient != nullptr);
    double sum = 0;
    for (std::size_t k = 0; k < active.size(); ++k)
    {
      for (unsigned int d = 0; d < dim; ++d)
        offset[d][k] = present[std::size_t(active[k]) * node_stride + d] - present_x[d];
      sum += offset_of(k).norm() / static_cast<double>(active.size());
    }
    for (std::vector<double> &component : offset)
      for (std::size_t k = 0; k < active.size(); ++k)
        component[k] /= sum;
    for (Tensor<1, dim> &of_weight : weight_gradient)
      of_weight = of_weight * inverse;
    return solve(n, sum, value, gradient);
  }

  template class ConvexApproximation<2>;
  template class ConvexApproximation<3>;
} // namespace tombolo
