// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/cell_overlap.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * Sub-cells of before that no cell of after covers (CellOverlap::is_uncovered) give their mass,
   * and what it carries, to those around that are covered, by their masses: first to all of cells
   * that share a node with theirs. They have no mass then. Sums over all sub-cells of m and of m s
   * stay to round-off.
   *
   * @p mass by cell and sub-cell [M]; @p values by cell, sub-cell and component, @p n_components
   * per mass. Throws a RunError with the place where there is nothing around to take it.
   * Collective.
   */
  template <int dim>
  void give_to_neighbours(const CellOverlap<dim> &overlap,
                          const std::shared_ptr<const NodePartition> &partition,
                          unsigned int n_components, std::vector<double> &mass,
                          std::vector<double> &values);
} // namespace tombolo
