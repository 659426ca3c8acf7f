// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/readers/mesh_file.h>

#include <array>
#include <cmath>
#include <sstream>
#include <vector>

namespace tombolo
{
  /** The two corners between which a midside node lies. */
  using MidsideEdge = std::array<unsigned int, 2>;

  /** Corners of the midside nodes of quadrilaterals of 8 or 9 nodes, in the order of all formats.
   */
  inline const std::vector<MidsideEdge> quadrilateral_midsides = {
      {{0, 1}}, {{1, 2}}, {{2, 3}}, {{3, 0}}};

  /** What is lost where only the corners of cells of second order are used. */
  class MidsideNodes
  {
  public:
    /** Adds a cell whose node k is @p node(k), the corners first and then the midside nodes that
     * @p edges describes. @p line is its line or number. */
    template <typename Node>
    void add(const Node &node, const std::vector<MidsideEdge> &edges, const unsigned int n_corners,
             const unsigned int line)
    {
      ++n_cells;
      for (unsigned int k = 0; k < edges.size(); ++k)
        add_edge(node(edges[k][0]), node(edges[k][1]), node(n_corners + k), line);
    }

    /** Adds what was left out to the remarks of a file, if anything was. */
    void report(MeshFileContent &content) const
    {
      if (n_cells == 0)
        return;
      std::ostringstream text;
      text << n_cells
           << " cells of the mesh file are of second order. Their midside nodes are left "
           << "out: cells here have straight edges between their corners. ";
      // Round-off of written coordinates is no bend.
      if (largest_bend > 1e-6)
      {
        text.precision(3);
        text << "A midside node lies off the middle of its edge by up to " << largest_bend
             << " of the length of the edge (" << content.location(line_of_largest)
             << "); smaller cells follow curved surfaces better.";
      }
      else
        text << "All of them are in the middle of their edges, so that the shape is the same.";
      content.remarks.push_back(text.str());
    }

  private:
    void add_edge(const std::array<double, 3> &begin, const std::array<double, 3> &end,
                  const std::array<double, 3> &middle, const unsigned int line)
    {
      double distance = 0, length = 0;
      for (unsigned int d = 0; d < 3; ++d)
      {
        distance += std::pow(middle[d] - (begin[d] + end[d]) / 2, 2);
        length += std::pow(end[d] - begin[d], 2);
      }
      const double bend = length > 0 ? std::sqrt(distance / length) : 0;
      if (bend > largest_bend)
      {
        largest_bend = bend;
        line_of_largest = line;
      }
    }

    std::size_t n_cells = 0;
    double largest_bend = 0; ///< distance from the middle of the edge by the length of the edge
    unsigned int line_of_largest = 0;
  };
} // namespace tombolo
