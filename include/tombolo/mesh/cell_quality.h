// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <algorithm>
#include <array>

namespace tombolo
{
  /** The vertices of a cell in deal.II's (lexicographic) order. */
  template <int dim>
  using CellVertices = std::array<dealii::Point<dim>, dealii::GeometryInfo<dim>::vertices_per_cell>;

  /** The edges at one corner, row by row, all taken in the direction of the axes. */
  template <int dim>
  dealii::Tensor<2, dim> corner_edges(const CellVertices<dim> &vertices, const unsigned int corner)
  {
    dealii::Tensor<2, dim> edges;
    for (unsigned int d = 0; d < dim; ++d)
      edges[d] = vertices[corner | (1u << d)] - vertices[corner & ~(1u << d)];
    return edges;
  }

  /** The smallest determinant of the unit edge vectors at the corners of a cell (the scaled
   * Jacobian): one for a brick of any proportions, zero where an edge has no length or a corner is
   * flat, negative where a corner is turned inside out. */
  template <int dim>
  double smallest_corner(const CellVertices<dim> &vertices)
  {
    double longest = 0;
    for (const auto &vertex : vertices)
      longest = std::max(longest, vertex.distance(vertices[0]));

    double smallest = 1;
    for (unsigned int corner = 0; corner < vertices.size(); ++corner)
    {
      auto edges = corner_edges(vertices, corner);
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double length = edges[d].norm();
        // Written so that a length that is not a number counts as none.
        if (!(length > 1e-12 * longest))
          return 0;
        edges[d] /= length;
      }
      smallest = std::min(smallest, dealii::determinant(edges));
    }
    return smallest;
  }

  /** The mean of the corner determinants: negative for a cell that is numbered the wrong way
   * round, zero for a flat one. Has the units of a volume. */
  template <int dim>
  double mean_corner_volume(const CellVertices<dim> &vertices)
  {
    double sum = 0;
    for (unsigned int corner = 0; corner < vertices.size(); ++corner)
      sum += dealii::determinant(corner_edges(vertices, corner));
    return sum / static_cast<double>(vertices.size());
  }

  /** The corners of @p cell moved towards its centre by this @p share of their distance to it. */
  template <int dim>
  CellVertices<dim> shrunk_corners(const CellVertices<dim> &cell, double share);

  /** Whether the convex hulls of two cells have points in common: those of which no normal of a
   * face, and in space no normal of two edges, is a direction in which one lies behind the other.
   * Faces that are not plane have the normal of their diagonals. */
  template <int dim>
  bool have_points_in_common(const CellVertices<dim> &a, const CellVertices<dim> &b);

  /** smallest_corner() of a cell that can be used is larger than this. */
  constexpr double smallest_usable_corner = 1e-6;
} // namespace tombolo
