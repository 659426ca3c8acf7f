// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/material.h>

#include <deal.II/base/utilities.h>

namespace tombolo
{
  /** The parts of Formulation::cost_per_cell() in relative cost units: only their ratios matter,
   * and a node is 20 units. doc/performance.md says how the ratios were measured. */
  namespace StepCost
  {
    constexpr double per_node = 20.; ///< acceleration, motion and energies
    constexpr double per_cell = 40.; ///< nodes gathered and forces added, geometry of a cell
    constexpr double per_point =
        17.; ///< strain and force of an element's point, without its stress

    /** Of a cell with nodes of this degree and @p n_points points. */
    inline double of_element(const unsigned int dim, const unsigned int degree,
                             const unsigned int n_points, const double cost_per_point,
                             const Material &material)
    {
      return per_node * dealii::Utilities::pow(degree, static_cast<int>(dim)) + per_cell +
             n_points * (cost_per_point + material.cost_per_point());
    }
  } // namespace StepCost
} // namespace tombolo
