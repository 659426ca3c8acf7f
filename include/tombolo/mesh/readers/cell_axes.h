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
  /** The edges of cells, and sets of those that are opposite to each other. */
  class ParallelEdges
  {
  public:
    using Ends = std::pair<unsigned int, unsigned int>; // of an edge, in its direction

    explicit ParallelEdges(const std::vector<dealii::CellData<3>> &cells) : sets(12 * cells.size())
    {
      for (const dealii::CellData<3> &cell : cells)
        for (unsigned int axis = 0; axis < 3; ++axis)
          for (unsigned int corner = 0; corner < 8; ++corner)
            if (((corner >> axis) & 1u) == 0)
            {
              const std::size_t edge =
                  numbers.try_emplace(ends_in(cell, axis, corner), numbers.size()).first->second;
              sets.union_set(edge, numbers.at(ends_in(cell, axis, 0)));
            }
    }

    /** The edge of a cell along an axis from @p corner, which is at its lower end. */
    static Ends ends_in(const dealii::CellData<3> &cell, const unsigned int axis,
                        const unsigned int corner)
    {
      return {cell.vertices[corner], cell.vertices[corner | (1u << axis)]};
    }

    /** Whether no edge has one direction in one cell and the other in the next. */
    bool are_consistent() const
    {
      return std::none_of(numbers.begin(), numbers.end(),
                          [&](const auto &edge) {
                            return numbers.count({edge.first.second, edge.first.first}) > 0;
                          });
    }

    std::size_t set_of(const Ends &ends)
    {
      return sets.find_set(numbers.at(ends));
    }

    const std::map<Ends, std::size_t> &edges() const
    {
      return numbers;
    }

  private:
    std::map<Ends, std::size_t> numbers;
    boost::disjoint_sets_with_storage<> sets;
  };

  /** By set of parallel edges: whether they descend where they are lowest. */
  inline std::map<std::size_t, bool> descending_sets(const std::vector<dealii::Point<3>> &vertices,
                                                     ParallelEdges &edges)
  {
    // No plane of a mesh that somebody draws is normal to it.
    const dealii::Tensor<1, 3> up({1., 0.7548776662466927, 0.5698402909980532});
    std::map<std::size_t, std::pair<double, bool>> lowest;
    for (const auto &edge : edges.edges())
    {
      const dealii::Point<3> &from = vertices[edge.first.first], &to = vertices[edge.first.second];
      const double height = (from + to) * up;
      const auto [known, is_new] =
          lowest.try_emplace(edges.set_of(edge.first), height, (to - from) * up < 0.);
      if (!is_new && height < known->second.first)
        known->second = {height, (to - from) * up < 0.};
    }
    std::map<std::size_t, bool> result;
    for (const auto &[set, lowest_edge] : lowest)
      result[set] = lowest_edge.second;
    return result;
  }

  inline void turn_in_space(const std::vector<dealii::Point<3>> &vertices,
                            std::vector<dealii::CellData<3>> &cells)
  {
    ParallelEdges edges(cells);
    if (!edges.are_consistent())
      return;
    const std::map<std::size_t, bool> descends = descending_sets(vertices, edges);
    for (dealii::CellData<3> &cell : cells)
    {
      unsigned int reversed = 0, n_reversed = 0;
      for (unsigned int axis = 0; axis < 3; ++axis)
        if (descends.at(edges.set_of(ParallelEdges::ends_in(cell, axis, 0))))
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

  /**
   * Turns cells in space to axes that depend on their positions and not on the order in which a
   * file has their corners, so that neither do numbers that the axes decide, as which corners have
   * sub-cells (SubCells). Edges that are opposite to each other in cells have one direction: that
   * in which the lowest of them along a fixed direction ascends. Cells whose edges have no common
   * directions (which deal.II orders where it can) stay, and so do cells in the plane.
   */
  template <int dim>
  void turn_axes_by_position([[maybe_unused]] const std::vector<dealii::Point<dim>> &vertices,
                             [[maybe_unused]] std::vector<dealii::CellData<dim>> &cells)
  {
    if constexpr (dim == 3)
      turn_in_space(vertices, cells);
  }
} // namespace tombolo
