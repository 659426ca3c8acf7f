// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/cell_overlap.h>
#include <tombolo/remesh/point_integrals.h>
#include <tombolo/remesh/received_cell.h>
#include <tombolo/remesh/simplex_pairs.h>

#include <cstddef>
#include <vector>

namespace tombolo
{
  /** Cuts cells of before by the simplices of cells of after. Buffers are kept from one cell to the
   * next. */
  template <int dim>
  class CellCutting
  {
  public:
    using Integrals = typename CellOverlap<dim>::Integrals;
    using Share = typename CellOverlap<dim>::Share;
    using Corners = typename SubCells<dim>::Corners;

    /** @p received must outlive this. */
    CellCutting(std::vector<ReceivedCell<dim>> &received, const unsigned int n_fields)
        : received(received), integrals(n_fields), of_points(n_fields)
    {}

    /** Adds what the cell with the number @p cell and these corners has of received cells, of which
     * those with the numbers @p near are all that it can have something of: to its integrals, with
     * the densities, to the cells, and its shares. */
    void cut(unsigned int cell, const Corners &corners, const std::vector<std::size_t> &near,
             Integrals &of_cell, std::vector<Share> &shares);

    /** Adds what the changes of densities change of the integrals. */
    void add_changes(const Corners &corners, const std::vector<std::size_t> &near,
                     Integrals &of_cell);

  private:
    static constexpr unsigned int n_sub_cells = SubCells<dim>::n_sub_cells;

    using Densities = std::array<double, n_sub_cells> ReceivedCell<dim>::*;

    /** Calls @p note(simplex of the cell, pair, moments) for each pair as well. */
    template <typename Note>
    void add_pairs(const SimplexCell<dim> &of_after, const std::vector<std::size_t> &near,
                   Densities densities, Integrals &of_cell, const Note &note);

    std::vector<ReceivedCell<dim>> &received;
    SimplexPairs<dim> pairs;
    SimplexIntegrals<dim> integrals;
    PointIntegrals<dim> of_points;
    std::vector<double> found; ///< ∫ (x - centre of the cell) and ∫ 1 by sub-cells of both cells
    std::vector<double> offsets; ///< of the centres of cells that are near, with a zero each
  };
} // namespace tombolo
