// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/kernel.h>
#include <tombolo/base/simd/eight_doubles.h>
#include <tombolo/base/simd/vector_math.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace tombolo
{
  struct MostSteps
  {
    unsigned int iterations, halvings;
  };

  /**
   * Goes from @p x to the minimum of a smooth convex function by Newton's method, with steps that
   * are halved until the function or its gradient is enough smaller. Returns the number of steps;
   * it ends where is_solved(values), or where no step helps any more.
   *
   * values_at(x) has the members `potential` (not finite: outside of the function's domain),
   * `gradient`, and `size()` of the gradient; @p values are those at the @p x that is returned.
   * step_from(values) is Newton's step.
   */
  template <int dim, typename Values, typename ValuesAt, typename StepFrom, typename IsSolved>
  unsigned int minimize_convex(const MostSteps &most, const ValuesAt &values_at,
                               const StepFrom &step_from, const IsSolved &is_solved,
                               dealii::Tensor<1, dim> &x, Values &values)
  {
    constexpr double least_decrease = 1e-4, least_share = 0.5;
    values = values_at(x);
    unsigned int n_steps = 0;
    while (n_steps < most.iterations && !is_solved(values))
    {
      ++n_steps;
      const dealii::Tensor<1, dim> step = step_from(values);
      const double predicted = step * values.gradient; // negative
      double length = 1.;
      bool is_accepted = false;
      for (unsigned int halving = 0; halving < most.halvings && !is_accepted; ++halving)
      {
        const dealii::Tensor<1, dim> trial = x + length * step;
        const Values at_trial = values_at(trial);
        // With the decrease alone the last steps would drown in round-off.
        is_accepted =
            std::isfinite(at_trial.potential) &&
            (at_trial.potential <= values.potential + least_decrease * length * predicted ||
             at_trial.size() <= least_share * values.size());
        if (is_accepted)
        {
          x = trial;
          values = at_trial;
        }
        length *= 0.5;
      }
      if (!is_accepted)
        break;
    }
    return n_steps;
  }

  /**
   * The positive functions of largest entropy (Arroyo and Ortiz, Int. J. Numer. Meth. Engng 65,
   * 2167-2202, 2006), one of the bases of Wu, Park and Chen (ibid. 85, 693-722, 2011): at a point x
   * with neighbours J and weights w_J = Π_k w((x_J,k - x_k)/a_J,k),
   *
   * @verbatim
   *   Ψ_J = w_J exp(λ·ξ_J) / Σ w exp,   ξ_J = (x_J - x)/a,   a: the mean half width
   *   λ:  r(λ) = Σ w_J exp(λ·ξ_J) ξ_J = 0
   * @endverbatim
   *
   * so that Σ Ψ_J = 1, Σ Ψ_J x_J = x and Ψ_J >= 0. r is the gradient of F(λ) = Σ w exp(λ·ξ), which
   * is strictly convex, and has a minimum where x is inside of the convex hull of its
   * neighbours; Newton's method with a rule of acceptance finds it. Neighbours in one plane (on one
   * line) with x have the functions of that plane.
   */
  template <int dim>
  class ConvexApproximation
  {
  public:
    explicit ConvexApproximation(std::shared_ptr<const Kernel> kernel)
        : chosen_kernel(std::move(kernel))
    {}

    struct Result
    {
      bool is_inside = false; ///< otherwise x is outside of the hull, and there are no values
      unsigned int n_iterations = 0;
    };

    /** Ψ_J at @p x for the @p n neighbours, which have node_stride doubles each in @p position and
     * in the half widths @p support. Values go to @p value, n of them; those outside of their
     * support are zero. With @p gradient, ∇Ψ_J goes there. Buffers are kept. */
    Result evaluate(const dealii::Point<dim> &x, const unsigned int n, const double *const position,
                    const double *const support, double *const value,
                    dealii::Tensor<1, dim> *const gradient = nullptr)
    {
      const double mean_support = find_weights(x, n, position, support, gradient != nullptr);
      return solve(n, mean_support, value, gradient);
    }

    /** The same where the neighbours and the point have moved to @p present (node_stride doubles
     * each) and @p present_x: weights are those at @p position and @p x, offsets are present ones.
     * So an affine motion changes no value. With @p gradient, the gradients by the present position
     * go there, where x moves with the present position by @p inverse, ∂x/∂(present x). */
    Result evaluate_moved(const dealii::Point<dim> &x, const unsigned int n,
                          const double *const position, const double *const support,
                          const dealii::Point<dim> &present_x, const double *const present,
                          double *const value, dealii::Tensor<1, dim> *const gradient = nullptr,
                          const dealii::Tensor<2, dim> &inverse = dealii::Tensor<2, dim>())
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
      for (dealii::Tensor<1, dim> &node_gradient : weight_gradient)
        node_gradient = node_gradient * inverse;
      return solve(n, sum, value, gradient);
    }

  private:
    static std::size_t padded_to_eight(const std::size_t n)
    {
      return (n + 7) / 8 * 8;
    }

    /** Neighbours in one plane leave the Hessian singular, and the residual without a part across
     * it: this share of its trace makes the plane's problem solvable. */
    static constexpr double relative_shift = 1e-14;

    static dealii::Tensor<1, dim> solve_shifted(dealii::Tensor<2, dim> matrix,
                                                const dealii::Tensor<1, dim> &right_hand_side)
    {
      const double shift = relative_shift * trace(matrix);
      for (unsigned int d = 0; d < dim; ++d)
        matrix[d][d] += shift;
      return invert(matrix) * right_hand_side;
    }

    /** Weights, with gradients or without, and offsets; returns the mean half width. */
    double find_weights(const dealii::Point<dim> &x, const unsigned int n,
                        const double *const position, const double *const support,
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
        dealii::Tensor<1, dim> gradient;
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

    /** F = Σ w exp, r and the Hessian at one λ. */
    struct Sums
    {
      double potential = 0, total = 0; ///< F; the former not finite where it is not positive
      dealii::Tensor<1, dim> gradient;
      dealii::Tensor<2, dim> hessian;

      double size() const
      {
        return gradient.norm() / total;
      }
    };
    Sums sums_at(const dealii::Tensor<1, dim> &multiplier)
    {
      find_basis(multiplier);
      // Σ w exp, the gradient, and then the lower half of the Hessian.
      constexpr unsigned int n_hessian = dim * (dim + 1) / 2;
      EightDoubles first[8], hessian[8];
      for (unsigned int i = 0; i < 8; ++i)
        first[i] = hessian[i] = 0.;
      for (std::size_t k = 0; k < active.size(); k += 8)
      {
        const EightDoubles eight_weights = load_eight(weight.data() + k);
        const EightDoubles value = eight_weights * load_eight(basis_value.data() + k);
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
      double first_sums[8], hessian_sums[8];
      store_eight(sums_of(first), first_sums);
      store_eight(sums_of(hessian), hessian_sums);
      static_assert(1 + dim <= 8 && n_hessian <= 8, "Sums fit into eight doubles.");
      Sums sums;
      sums.potential = sums.total = first_sums[0];
      if (!(sums.total > 0.))
        sums.potential = std::numeric_limits<double>::infinity();
      for (unsigned int i = 0; i < dim; ++i)
      {
        sums.gradient[i] = first_sums[1 + i];
        for (unsigned int j = 0; j <= i; ++j)
          sums.hessian[i][j] = sums.hessian[j][i] = hessian_sums[i * (i + 1) / 2 + j];
      }
      return sums;
    }

    /** exp(λ·ξ) of all active neighbours. */
    void find_basis(const dealii::Tensor<1, dim> &multiplier)
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

    /** Newton's method from λ = 0; ∇Ψ_J unless @p gradient is null. Offsets are over @p size. */
    Result solve(const unsigned int n, const double size, double *const value,
                 dealii::Tensor<1, dim> *const gradient)
    {
      constexpr double tolerance = 1e-13, sufficient = 1e-11;
      constexpr MostSteps most{100, 50};
      Result result;
      std::fill_n(value, n, 0.);
      if (active.empty())
        return result;
      dealii::Tensor<1, dim> multiplier;
      Sums sums;
      result.n_iterations = minimize_convex(
          most, [this](const dealii::Tensor<1, dim> &trial) { return sums_at(trial); },
          [](const Sums &trial_sums)
          { return -1. * solve_shifted(trial_sums.hessian, trial_sums.gradient); },
          [](const Sums &trial_sums) { return trial_sums.size() < tolerance; }, multiplier, sums);
      result.is_inside = sums.gradient.norm() < sufficient * sums.total;
      if (!result.is_inside)
        return result;
      find_basis(multiplier);
      for (std::size_t k = 0; k < active.size(); ++k)
        value[active[k]] = weight[k] * basis_value[k] / sums.total;
      if (gradient != nullptr)
      {
        std::fill_n(gradient, n, dealii::Tensor<1, dim>());
        find_gradients(multiplier, sums, size, gradient);
      }
      return result;
    }

    void find_gradients(const dealii::Tensor<1, dim> &multiplier, const Sums &sums,
                        const double mean_support, dealii::Tensor<1, dim> *const gradient)
    {
      for (unsigned int axis = 0; axis < dim; ++axis)
      {
        dealii::Tensor<1, dim> right_hand_side;
        for (std::size_t k = 0; k < active.size(); ++k)
        {
          right_hand_side += (weight_gradient[k][axis] * basis_value[k] -
                              weight[k] * basis_value[k] * multiplier[axis] / mean_support) *
                             offset_of(k);
          right_hand_side[axis] -= weight[k] * basis_value[k] / mean_support;
        }
        dealii::Tensor<1, dim> change = -1. * solve_shifted(sums.hessian, right_hand_side);
        change -= solve_shifted(sums.hessian, sums.hessian * change + right_hand_side);
        double sum = 0;
        for (std::size_t k = 0; k < active.size(); ++k)
        {
          const double numerator = weight_gradient[k][axis] * basis_value[k] +
                                   weight[k] * basis_value[k] *
                                       (change * offset_of(k) - multiplier[axis] / mean_support);
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

    /** ξ of an active neighbour. */
    dealii::Tensor<1, dim> offset_of(const std::size_t k) const
    {
      dealii::Tensor<1, dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = offset[d][k];
      return result;
    }

    std::shared_ptr<const Kernel> chosen_kernel;
    std::vector<double> coordinate, factor, slope; // of the kernel, axis by axis
    std::vector<unsigned int> active;              // neighbours with a weight
    // Of active ones, padded to multiples of eight by neighbours at the point without a weight.
    std::vector<double> weight, basis_value;
    std::array<std::vector<double>, dim> offset;
    std::vector<dealii::Tensor<1, dim>> weight_gradient; // of active ones
  };
} // namespace tombolo
