// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/readers/mesh_file.h>

#include <array>
#include <vector>

namespace tombolo
{
  /** The two corners between which a midside node lies. */
  using MidsideEdge = std::array<unsigned int, 2>;

  /** Corners of the midside nodes of quadrilaterals of 8 or 9 nodes, in the order of all formats.
   */
  extern const std::vector<MidsideEdge> quadrilateral_midsides;

  /** What is lost where only the corners of cells of second order are used. */
  class MidsideNodes
  {
  public:
    /** Adds a cell whose node k is @p node(k), the corners first and then the midside nodes that
     * @p edges describes. @p place is its line or number. */
    template <typename Node>
    void add(const Node &node, const std::vector<MidsideEdge> &edges, const unsigned int n_corners,
             const unsigned int place)
    {
      ++n_cells;
      for (unsigned int k = 0; k < edges.size(); ++k)
        add_edge(node(edges[k][0]), node(edges[k][1]), node(n_corners + k), place);
    }

    /** Adds what was left out to the remarks of a file, if anything was. */
    void report(MeshFileContent &content) const;

  private:
    void add_edge(const std::array<double, 3> &begin, const std::array<double, 3> &end,
                  const std::array<double, 3> &middle, unsigned int place);

    std::size_t n_cells = 0;
    double largest_bend = 0; ///< distance from the middle of the edge by the length of the edge
    unsigned int place_of_largest = 0;
  };
} // namespace tombolo
