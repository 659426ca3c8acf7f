// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/sub_cells.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** How cells are integrated with the functions of ConvexApproximation. */
  enum class SmoothedIntegrationRule
  {
    smoothed, ///< four sub-cells, gradients from their facets
    one_point
  };

  /** That of the value @p name of `Integration`. */
  SmoothedIntegrationRule smoothed_integration_rule(const std::string &name);

  /** The middle of a cell, and the derivative of places by those in the unit cell there, whose
   * determinant is the volume of the point. */
  template <int dim>
  struct PointOfCell
  {
    explicit PointOfCell(const typename SubCells<dim>::Corners &corners);

    dealii::Point<dim> place;
    dealii::Tensor<2, dim> jacobian;
  };

  /** Of each point or sub-cell the shares of the corners of its cell in its place. */
  template <int dim>
  std::vector<std::vector<double>> corner_shares_of_points(SmoothedIntegrationRule rule);
} // namespace tombolo
