// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <tombolo/approximation/kernel.h>

#include <array>
#include <cmath>
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
   * line) with x give the functions of that plane.
   */
  template <int dim>
  class ConvexApproximation
  {
  public:
    explicit ConvexApproximation(std::shared_ptr<const Kernel> kernel);

    /** What evaluate() found. */
    struct Result
    {
      bool is_inside = false; ///< otherwise x is outside of the hull, and there are no values
      unsigned int n_iterations = 0;
    };

    /** Ψ_J at @p x for the @p n neighbours, which have node_stride doubles each in @p position and
     * in the half widths @p support. Values go to @p value, n of them; those outside of their
     * support are zero. With @p gradient, ∇Ψ_J goes there. Buffers are kept. */
    Result evaluate(const dealii::Point<dim> &x, unsigned int n, const double *position,
                    const double *support, double *value,
                    dealii::Tensor<1, dim> *gradient = nullptr);

    /** The same where the neighbours and the point have moved to @p present (node_stride doubles
     * each) and @p present_x: weights are those at @p position and @p x, offsets are present ones.
     * So an affine motion changes no value. With @p gradient, the gradients by the present place
     * go there, where x moves with the present place by @p inverse, ∂x/∂(present x). */
    Result evaluate_moved(const dealii::Point<dim> &x, unsigned int n, const double *position,
                          const double *support, const dealii::Point<dim> &present_x,
                          const double *present, double *value,
                          dealii::Tensor<1, dim> *gradient = nullptr,
                          const dealii::Tensor<2, dim> &inverse = dealii::Tensor<2, dim>());

  private:
    /** Weights, with gradients or without, and offsets; returns the mean half width of the
     * neighbours. */
    double find_weights(const dealii::Point<dim> &x, unsigned int n, const double *position,
                        const double *support, bool with_gradients);

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
    Sums sums_at(const dealii::Tensor<1, dim> &multiplier);

    /** exp(λ·ξ) of all active neighbours. */
    void find_basis(const dealii::Tensor<1, dim> &multiplier);

    /** Newton's method from λ = 0; Ψ_J to @p value and, unless it is null, ∇Ψ_J to @p gradient.
     * Offsets are over @p size. */
    Result solve(unsigned int n, double size, double *value, dealii::Tensor<1, dim> *gradient);

    void find_gradients(const dealii::Tensor<1, dim> &multiplier, const Sums &sums,
                        double mean_support, dealii::Tensor<1, dim> *gradient);

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
