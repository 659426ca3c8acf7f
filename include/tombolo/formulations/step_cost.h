// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/material.h>
#include <tombolo/mesh/part_cells.h>

#include <deal.II/base/utilities.h>

namespace tombolo
{
  /** Parts of Formulation::step_cost() in relative cost units: only their ratios matter, and a node
   * is 20 units. doc/performance.md says how the ratios were measured. */
  namespace StepCosts
  {
    constexpr double per_node = 20.;  ///< acceleration, motion and energies
    constexpr double per_cell = 40.;  ///< nodes gathered and forces added, geometry of a cell
    constexpr double per_point = 17.; ///< of elements: strain and force, without the stress

    /** Of cells with nodes of this degree, whose work is @p per_cell each. */
    inline StepCost cell_cost(const unsigned int dim, const unsigned int degree,
                              const double per_cell)
    {
      const int n_nodes = dealii::Utilities::pow(degree, static_cast<int>(dim));
      return {per_cell + per_node * (n_nodes - 1), per_node};
    }

    inline StepCost element_cost(const unsigned int dim, const unsigned int degree,
                                 const unsigned int n_points, const double cost_per_point,
                                 const Material &material)
    {
      return cell_cost(dim, degree,
                       per_cell + n_points * (cost_per_point + material.cost_per_point()));
    }
  } // namespace StepCosts
} // namespace tombolo
