// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <array>
#include <vector>

namespace tombolo
{
  /**
   * The four sub-cells of a quadrilateral or a hexahedron, and the plane facets that bound them,
   * all known from the corners of the cell: the centre of a face and of the cell is the mean of
   * their corners. A quadrilateral is cut into four triangles, one a face, about its centre. A
   * hexahedron consists of 24 tetrahedra (an edge, the centre of a face at this edge, the centre of
   * the cell); a sub-cell has the six at the three edges of one corner with an even number of
   * coordinates that are one. Every edge has exactly one such end, and neighbours cut the face
   * between them alike, warped or not.
   */
  template <int dim>
  class SubCells
  {
  public:
    static constexpr unsigned int n_corners = dealii::GeometryInfo<dim>::vertices_per_cell;
    static constexpr unsigned int n_sub_cells = 4;
    /** SubCells::Facet::to of facets of the boundary of the cell. */
    static constexpr unsigned int outside = n_sub_cells;

    /** The shares of the corners in a point. */
    using Shares = std::array<double, n_corners>;
    using Corners = std::array<dealii::Point<dim>, n_corners>;

    /** A triangle (in two dimensions a segment) between two sub-cells or on a face. */
    struct Facet
    {
      std::array<Shares, dim> vertices;
      Shares centroid;    ///< on a face also the linear interpolation of its nodes
      double orientation; ///< of the order of the vertices, 1 or -1
      unsigned int from;  ///< the sub-cell that the normal leaves
      unsigned int to;    ///< the one that it enters, or outside
      unsigned int face;  ///< of the cell; faces_per_cell for inner facets
    };

    static const std::vector<Facet> &facets();

    /** Whether a corner, lexicographic, has an even number of coordinates that are one. */
    static constexpr bool is_even(const unsigned int corner)
    {
      return ((corner ^ (corner >> 1) ^ (corner >> 2)) & 1u) == 0;
    }

    /** Whether a corner, lexicographic, is one of a face. */
    static constexpr bool is_on_face(const unsigned int corner, const unsigned int face)
    {
      return ((corner >> (face / 2)) & 1u) == face % 2;
    }

    static dealii::Point<dim> point_at(const Shares &shares, const Corners &corners);

    static dealii::Point<dim> centre(const Corners &corners)
    {
      dealii::Point<dim> result;
      for (const dealii::Point<dim> &corner : corners)
        result += corner / static_cast<double>(n_corners);
      return result;
    }

    /** Area times normal, from `from` to `to` [L^(dim-1)]. */
    static dealii::Tensor<1, dim> area(const Facet &facet, const Corners &corners);

    /** The same of a facet with these vertices. */
    static dealii::Tensor<1, dim> area_of(const std::array<dealii::Point<dim>, dim> &vertices,
                                          const double orientation)
    {
      const dealii::Tensor<1, dim> a = vertices[1] - vertices[0];
      if constexpr (dim == 2)
        return orientation * dealii::cross_product_2d(a);
      else
        return 0.5 * orientation * dealii::cross_product_3d(a, vertices[2] - vertices[0]);
    }

    /** The centroids of the sub-cells of a parallelepiped. */
    static const std::array<Shares, n_sub_cells> &centroids();
  };

  /** How cells are integrated with the functions of ConvexApproximation. */
  enum class SmoothedIntegrationRule
  {
    smoothed, ///< four sub-cells, gradients from their facets
    one_point
  };

  /** The middle of a cell, and the derivative of positions with respect to those in the unit cell
   * there, whose determinant is the volume of the point. */
  template <int dim>
  struct PointOfCell
  {
    explicit PointOfCell(const typename SubCells<dim>::Corners &corners);

    dealii::Point<dim> position;
    dealii::Tensor<2, dim> jacobian;
  };

  /** Of each point or sub-cell the shares of the corners of its cell in its position. */
  template <int dim>
  std::vector<std::vector<double>> corner_shares_of_points(SmoothedIntegrationRule rule);
} // namespace tombolo
