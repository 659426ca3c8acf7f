// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/cell_overlap.h>
#include <tombolo/remesh/point_remap.h>

#include <vector>

namespace tombolo
{
  /**
   * The remap of nodal fields by interpolation (CloudInterpolation), as in Wu et al. 2015, eqs (65)
   * to (72): a node that has moved gets the value of before at its new position, where the numbers
   * at the nodes stand for values. Linear fields are exact; sums do not stay.
   *
   * @p before and @p after are the positions, owned ones; nodes of other parts may be among them.
   * All @p fields have node_stride slots, and get current ghosts. Supports are as sheared as the
   * cells around; half widths are 1.1 times the largest distance to a node of the same cell, along
   * each axis where these cells are cubes. Collective.
   */
  template <int dim>
  void interpolate_nodal_fields(const std::vector<RemapCell<dim>> &cells, const NodalVector &before,
                                const NodalVector &after, const std::vector<NodalVector *> &fields);

  /**
   * The same of the state of points, eqs (73) and (74): the points of cells that have moved get
   * the values of before at their new positions. What is interpolated has one point a cell, as in
   * the paper: the mean of its points, by mass. Several points of distorted cells would lie too
   * irregularly to solve for coefficients. New values are put within those of the points around
   * (CloudInterpolation::limit()), since negative lobes would make plastic strains negative and
   * stresses larger than the yield stress. Points beyond the outermost old ones get the values of
   * the nearest face of the hull of these.
   *
   * @p corner_shares: the shares of the corners of a cell in the position of each of its points.
   * @p points has the values by cell, point and component; masses stay. Collective.
   */
  template <int dim>
  void interpolate_points(const std::vector<RemapCell<dim>> &cells,
                          const std::shared_ptr<const NodePartition> &partition,
                          const std::vector<std::vector<double>> &corner_shares,
                          PointValues &points);
} // namespace tombolo
