// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_points.h>
#include <tombolo/formulations/elements/conversion_criterion.h>
#include <tombolo/formulations/elements/converting_cells.h>

#include <vector>

namespace tombolo
{
  /** Marks the places of cells with @p n_points points in which the mean strain or damage of @p
   * criterion is reached. @p converts: by place. */
  void mark_by_points(const ConversionCriterion &criterion, const MaterialPoints &points,
                      unsigned int n_points, std::vector<bool> &converts);

  /** Marks the places of cells of this @p degree whose corners are too sharp at these positions. */
  template <int dim>
  void mark_by_shape(const ConversionCriterion &criterion, const CellBatches<dim> &cells,
                     unsigned int degree, const NodalVector &position, std::vector<bool> &converts);

  /** ConvertingCells::add_state() of cells with these points. */
  template <int dim>
  void add_state_of_cells(const PointsInCells<dim> &cell_points, const PartPoints &part_points,
                          const std::vector<unsigned int> &converted, StateTransfer &state);
} // namespace tombolo
