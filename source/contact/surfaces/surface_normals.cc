// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surfaces/surface_normals.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    Tensor<1, dim> facet_area(const ClosedSurface<dim> &surface, const std::size_t facet)
    {
      const auto &v = surface.facets[facet].vertex;
      const Tensor<1, dim> first = surface.vertices[v[1]] - surface.vertices[v[0]];
      if constexpr (dim == 2)
        return Tensor<1, 2>({first[1], -first[0]});
      else
        return 0.5 * cross_product_3d(first, surface.vertices[v[2]] - surface.vertices[v[0]]);
    }

    template <int dim>
    double angle_at(const ClosedSurface<dim> &surface, const std::size_t facet,
                    const unsigned int k)
    {
      if constexpr (dim == 3)
      {
        const auto &v = surface.facets[facet].vertex;
        const Tensor<1, 3> &corner = surface.vertices[v[k]];
        const Tensor<1, 3> a = surface.vertices[v[(k + 1) % 3]] - corner;
        const Tensor<1, 3> b = surface.vertices[v[(k + 2) % 3]] - corner;
        return std::atan2(cross_product_3d(a, b).norm(), a * b);
      }
      return 1.;
    }

    /** Sums of nothing are at folds without a thickness, where any direction will do. */
    template <int dim>
    void make_unit(std::vector<Tensor<1, dim>> &normals)
    {
      for (Tensor<1, dim> &normal : normals)
      {
        const double size = normal.norm();
        if (size > 0.)
          normal /= size;
        else
          normal[dim - 1] = 1.;
      }
    }
  } // namespace

  template <int dim>
  void set_normals(ClosedSurface<dim> &surface)
  {
    surface.facet_normals.resize(surface.facets.size());
    surface.vertex_normals.assign(surface.vertices.size(), Tensor<1, dim>());
    surface.edge_normals.assign(surface.ends_of_edges.size(), Tensor<1, dim>());
    for (std::size_t f = 0; f < surface.facets.size(); ++f)
    {
      const Tensor<1, dim> area = facet_area(surface, f);
      Tensor<1, dim> &normal = surface.facet_normals[f];
      if (const double size = area.norm(); size > 0.)
        normal = area / size;
      for (unsigned int k = 0; k < dim; ++k)
      {
        surface.vertex_normals[surface.facets[f].vertex[k]] += angle_at(surface, f, k) * normal;
        if (dim == 3)
          surface.edge_normals[surface.edges[dim * f + k]] += normal;
      }
    }
    make_unit(surface.vertex_normals);
    make_unit(surface.edge_normals);
  }

  template <int dim>
  void move_vertices(ClosedSurface<dim> &surface, const std::vector<Tensor<1, dim>> &places)
  {
    surface.vertices = places;
    surface.low = surface.high = places[0];
    for (const Tensor<1, dim> &place : places)
      for (unsigned int d = 0; d < dim; ++d)
      {
        surface.low[d] = std::min(surface.low[d], place[d]);
        surface.high[d] = std::max(surface.high[d], place[d]);
      }
    set_normals(surface);
  }

  template void set_normals(ClosedSurface<2> &);
  template void set_normals(ClosedSurface<3> &);
  template void move_vertices(ClosedSurface<2> &, const std::vector<Tensor<1, 2>> &);
  template void move_vertices(ClosedSurface<3> &, const std::vector<Tensor<1, 3>> &);
} // namespace tombolo
