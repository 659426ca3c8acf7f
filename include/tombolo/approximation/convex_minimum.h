// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <cmath>

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
} // namespace tombolo
