// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/convex_hulls.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    bool is_separated_along(const Tensor<1, dim> &direction, const CellCorners<dim> &a,
                            const CellCorners<dim> &b)
    {
      const auto extent = [&](const CellCorners<dim> &cell)
      {
        double begin = std::numeric_limits<double>::max(), end = -begin;
        for (const Point<dim> &corner : cell)
        {
          const double place = direction * corner;
          begin = std::min(begin, place);
          end = std::max(end, place);
        }
        return std::make_pair(begin, end);
      };
      const auto [begin_of_a, end_of_a] = extent(a);
      const auto [begin_of_b, end_of_b] = extent(b);
      return end_of_a < begin_of_b || end_of_b < begin_of_a;
    }

    template <int dim>
    Tensor<1, dim> edge_of(const CellCorners<dim> &cell, const unsigned int line)
    {
      using Geometry = GeometryInfo<dim>;
      return cell[Geometry::line_to_cell_vertices(line, 1)] -
             cell[Geometry::line_to_cell_vertices(line, 0)];
    }

    template <int dim>
    Tensor<1, dim> normal_of_face(const CellCorners<dim> &cell, const unsigned int face)
    {
      const auto corner = [&](const unsigned int k)
      { return cell[GeometryInfo<dim>::face_to_cell_vertices(face, k)]; };
      if constexpr (dim == 2)
        return cross_product_2d(corner(1) - corner(0));
      else
        return cross_product_3d(corner(3) - corner(0), corner(2) - corner(1));
    }
  } // namespace

  template <int dim>
  CellCorners<dim> shrunk_corners(const CellCorners<dim> &cell, const double share)
  {
    Tensor<1, dim> centre;
    for (const Point<dim> &corner : cell)
      centre += corner / static_cast<double>(cell.size());
    CellCorners<dim> result = cell;
    for (Point<dim> &corner : result)
      corner += share * (centre - corner);
    return result;
  }

  template <int dim>
  bool have_points_in_common(const CellCorners<dim> &a, const CellCorners<dim> &b)
  {
    for (const CellCorners<dim> *const cell : {&a, &b})
      for (const unsigned int f : GeometryInfo<dim>::face_indices())
        if (is_separated_along(normal_of_face(*cell, f), a, b))
          return false;
    if constexpr (dim == 3)
      for (unsigned int k = 0; k < GeometryInfo<dim>::lines_per_cell; ++k)
        for (unsigned int l = 0; l < GeometryInfo<dim>::lines_per_cell; ++l)
          if (is_separated_along(cross_product_3d(edge_of(a, k), edge_of(b, l)), a, b))
            return false;
    return true;
  }

  template CellCorners<2> shrunk_corners<2>(const CellCorners<2> &, double);
  template CellCorners<3> shrunk_corners<3>(const CellCorners<3> &, double);
  template bool have_points_in_common<2>(const CellCorners<2> &, const CellCorners<2> &);
  template bool have_points_in_common<3>(const CellCorners<3> &, const CellCorners<3> &);
} // namespace tombolo
