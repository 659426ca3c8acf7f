// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/material.h>

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
    double of_element(unsigned int dim, unsigned int degree, unsigned int n_points,
                      double cost_per_point, const Material &material);
  } // namespace StepCost
} // namespace tombolo
