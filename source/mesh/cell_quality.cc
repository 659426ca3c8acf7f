// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/tensor.h>

#include <tombolo/mesh/cell_quality.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    /** The edges at one corner, row by row, all taken in the direction of the axes. */
    template <int dim>
    dealii::Tensor<2, dim> corner_edges(const CellVertices<dim> &vertices,
                                        const unsigned int corner)
    {
      dealii::Tensor<2, dim> edges;
      for (unsigned int d = 0; d < dim; ++d)
        edges[d] = vertices[corner | (1u << d)] - vertices[corner & ~(1u << d)];
      return edges;
    }
  } // namespace

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

  template <int dim>
  double mean_corner_volume(const CellVertices<dim> &vertices)
  {
    double sum = 0;
    for (unsigned int corner = 0; corner < vertices.size(); ++corner)
      sum += dealii::determinant(corner_edges(vertices, corner));
    return sum / static_cast<double>(vertices.size());
  }

  template double smallest_corner(const CellVertices<2> &);
  template double smallest_corner(const CellVertices<3> &);
  template double mean_corner_volume(const CellVertices<2> &);
  template double mean_corner_volume(const CellVertices<3> &);
} // namespace tombolo
