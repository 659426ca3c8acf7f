// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/elements/conversion_criterion.h>
#include <tombolo/formulations/elements/converting_cells.h>
#include <tombolo/formulations/plastic_heating.h>
#include <tombolo/state/material_points.h>

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

  /** The numbers of the cells at marked places, ascending. */
  template <int dim>
  std::vector<unsigned int> cells_at(const CellBatches<dim> &cells,
                                     const std::vector<bool> &converts);

  /** ConvertingCells::add_state() of cells with these points; @p shape_values of node k at point q
   * of a cell are [q][k], and the points have the initial @p density. */
  template <int dim>
  void add_state_of_cells(const CellBatches<dim> &cells, const MaterialPoints &points,
                          const PlasticHeating &plastic_heating, double density,
                          const std::vector<std::vector<double>> &shape_values,
                          const std::vector<unsigned int> &converted, StateTransfer &state);

  /** CellBatches::remove(), and @p points, @p n_points of each cell, go with their cells: those of
   * unused lanes repeat the last cell, and these and those of removed cells have no volume. Returns
   * where what is at each place was before. */
  template <int dim>
  std::vector<unsigned int> remove_cells(const std::vector<bool> &is_removed, unsigned int n_points,
                                         CellBatches<dim> &cells, MaterialPoints &points);
} // namespace tombolo
