// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/step_cost.h>

#include <deal.II/base/utilities.h>

namespace tombolo
{
  double StepCost::of_element(const unsigned int dim, const unsigned int degree,
                              const unsigned int n_points, const double cost_per_point,
                              const Material &material)
  {
    return per_node * dealii::Utilities::pow(degree, static_cast<int>(dim)) + per_cell +
           n_points * (cost_per_point + material.cost_per_point());
  }
} // namespace tombolo
