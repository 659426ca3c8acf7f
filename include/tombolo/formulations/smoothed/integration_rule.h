// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/sub_cells.h>

#include <deal.II/base/quadrature.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** How cells are integrated with the functions of ConvexApproximation. */
  enum class SmoothedIntegrationRule
  {
    smoothed, ///< four sub-cells, gradients from their facets
    one_point,
    gauss ///< 2^dim Gauss points
  };

  /** That of the value @p name of `Integration`. */
  SmoothedIntegrationRule smoothed_integration_rule(const std::string &name);

  /** The points of a rule that has points, in the unit cell. */
  template <int dim>
  dealii::Quadrature<dim> quadrature_of(SmoothedIntegrationRule rule);

  /** A place in a cell, and the derivative of places by those in the unit cell. */
  template <int dim>
  struct PointOfCell
  {
    PointOfCell(const dealii::Point<dim> &unit, const typename SubCells<dim>::Corners &corners);

    dealii::Point<dim> place;
    dealii::Tensor<2, dim> jacobian;
  };

  /** The volumes of the points of a rule that has points [L^dim]. */
  template <int dim>
  std::vector<double> volumes_of_points(SmoothedIntegrationRule rule,
                                        const typename SubCells<dim>::Corners &corners);

  /** Of each point or sub-cell the shares of the corners of its cell in its place. */
  template <int dim>
  std::vector<std::vector<double>> corner_shares_of_points(SmoothedIntegrationRule rule);
} // namespace tombolo
