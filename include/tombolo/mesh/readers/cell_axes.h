// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>
#include <deal.II/grid/tria_description.h>

#include <boost/pending/disjoint_sets.hpp>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * Turns cells in space to axes that depend on their positions and not on the order in which a
   * file has their corners, so that neither do numbers that the axes decide, as which corners have
   * sub-cells (SubCells). Edges that are opposite to each other in cells have one direction: that
   * in which the lowest of them along a fixed direction ascends. Cells whose edges have no common
   * directions (which deal.II orders where it can) stay.
   */
  inline void turn_axes_by_position(const std::vector<dealii::Point<3>> &vertices,
                                    std::vector<dealii::CellData<3>> &cells)
  {
    using Ends = std::pair<unsigned int, unsigned int>; // of an edge, in its direction
    const auto edge_from = [](const dealii::CellData<3> &cell, const unsigned int axis,
                              const unsigned int corner) -> Ends {
      return {cell.vertices[corner], cell.vertices[corner | (1u << axis)]};
    };
    std::map<Ends, std::size_t> edges; // with their numbers
    boost::disjoint_sets_with_storage<> parallel(12 * cells.size());
    for (const dealii::CellData<3> &cell : cells)
      for (unsigned int axis = 0; axis < 3; ++axis)
        for (unsigned int corner = 0; corner < 8; ++corner)
          if (((corner >> axis) & 1u) == 0)
          {
            const std::size_t edge =
                edges.try_emplace(edge_from(cell, axis, corner), edges.size()).first->second;
            parallel.union_set(edge, edges.at(edge_from(cell, axis, 0)));
          }
    const auto goes_both_ways = [&](const auto &edge) {
      return edges.count({edge.first.second, edge.first.first}) > 0;
    };
    if (std::any_of(edges.begin(), edges.end(), goes_both_ways))
      return;

    // No plane of a mesh that somebody draws is normal to it.
    const dealii::Tensor<1, 3> up({1., 0.7548776662466927, 0.5698402909980532});
    // By set of parallel edges: where they are lowest, and whether they descend there.
    std::map<std::size_t, std::pair<double, bool>> lowest;
    for (const auto &[ends, number] : edges)
    {
      const dealii::Point<3> &from = vertices[ends.first], &to = vertices[ends.second];
      const double height = (from + to) * up;
      const bool descends = (to - from) * up < 0.;
      const auto [known, is_new] = lowest.try_emplace(parallel.find_set(number), height, descends);
      if (!is_new && height < known->second.first)
        known->second = {height, descends};
    }
    for (dealii::CellData<3> &cell : cells)
    {
      unsigned int reversed = 0, n_reversed = 0;
      for (unsigned int axis = 0; axis < 3; ++axis)
        if (lowest.at(parallel.find_set(edges.at(edge_from(cell, axis, 0)))).second)
        {
          reversed |= 1u << axis;
          ++n_reversed;
        }
      const auto was = cell.vertices;
      for (unsigned int corner = 0; corner < 8; ++corner)
      {
        // An odd number of reversed axes would turn the cell inside out: x and y are exchanged.
        const unsigned int swapped = (corner & 4u) | ((corner & 1u) << 1) | ((corner & 2u) >> 1);
        cell.vertices[corner] = was[(n_reversed % 2 == 0 ? corner : swapped) ^ reversed];
      }
    }
  }
} // namespace tombolo
