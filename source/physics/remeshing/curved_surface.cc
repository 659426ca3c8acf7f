// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/curved_surface.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void CurvedSurface<dim>::add(const std::vector<double> &of_rank)
  {
    const double *value = of_rank.data();
    const auto read = [&value](Tensor<1, dim> &vector)
    {
      for (unsigned int d = 0; d < dim; ++d)
        vector[d] = *value++;
    };
    while (value != of_rank.data() + of_rank.size())
    {
      typename ClosedSurface<dim>::Facet facet;
      for (unsigned int v = 0; v < dim; ++v)
      {
        facet.vertex[v] = static_cast<unsigned int>(facets.vertices.size());
        facets.vertices.emplace_back();
        read(facets.vertices.back());
      }
      facets.facets.push_back(facet);
      facets.facet_normals.emplace_back();
      read(facets.facet_normals.back());
      facets.edges.insert(facets.edges.end(), ClosedSurface<dim>::n_sides, 0u);
      shares.emplace_back();
      for (auto &of_vertex : shares.back())
        for (double &share : of_vertex)
          share = *value++;
      faces.emplace_back();
      for (auto &place : faces.back().places)
        read(place);
      for (auto &normal : faces.back().normals)
        read(normal);
    }
  }

  template <int dim>
  void CurvedSurface<dim>::complete()
  {
    constexpr double share_of_size = 1e-7;
    // No plane between two nodes of a lattice is along this direction.
    constexpr double direction[3] = {0.8192, 0.4657, 0.3346};
    tree = FacetTree<dim>(facets);
    double largest = 0; // so that it does not depend on the order of ranks
    for (const Face &face : faces)
      largest = std::max(largest, (face.places.back() - face.places.front()).norm_square());
    for (unsigned int d = 0; d < dim; ++d)
      aside[d] = share_of_size * std::sqrt(largest) * direction[d];
  }

  template <int dim>
  typename CurvedSurface<dim>::Nearest
  CurvedSurface<dim>::nearest(const Tensor<1, dim> &point) const
  {
    return tree.nearest_on_facet_of(tree.nearest(point + aside), point);
  }

  template <int dim>
  std::optional<typename CurvedSurface<dim>::Nearest>
  CurvedSurface<dim>::nearest_facing(const Tensor<1, dim> &point, const Tensor<1, dim> &direction,
                                     const double limit) const
  {
    const auto found = tree.nearest_facing(point + aside, direction, limit);
    return found ? std::optional<Nearest>(tree.nearest_on_facet_of(*found, point)) : std::nullopt;
  }

  template <int dim>
  Tensor<1, dim> CurvedSurface<dim>::raise(const Tensor<1, dim> &place,
                                           const unsigned int facet) const
  {
    const auto vertex = [&](const unsigned int v) -> const Tensor<1, dim> &
    { return facets.vertices[facets.facets[facet].vertex[v]]; };
    std::array<double, dim> coordinates{};
    if constexpr (dim == 2)
    {
      const Tensor<1, dim> along = vertex(1) - vertex(0);
      coordinates[1] = (place - vertex(0)) * along / along.norm_square();
    }
    else
    {
      const Tensor<1, dim> a = vertex(1) - vertex(0), b = vertex(2) - vertex(0),
                           r = place - vertex(0);
      const double aa = a * a, ab = a * b, bb = b * b, determinant = aa * bb - ab * ab;
      coordinates[1] = (bb * (r * a) - ab * (r * b)) / determinant;
      coordinates[2] = (aa * (r * b) - ab * (r * a)) / determinant;
    }
    coordinates[0] = 1.;
    for (unsigned int v = 1; v < dim; ++v)
      coordinates[0] -= coordinates[v];
    Tensor<1, dim> result = place;
    for (unsigned int k = 0; k < n_face_nodes; ++k)
    {
      double share = 0;
      for (unsigned int v = 0; v < dim; ++v)
        share += coordinates[v] * shares[facet][v][k];
      const Tensor<1, dim> &normal = faces[facet].normals[k];
      result += 0.5 * share * (normal * (faces[facet].places[k] - place)) * normal;
    }
    return result;
  }

  template <int dim>
  const Tensor<1, dim> &CurvedSurface<dim>::node_near(const Tensor<1, dim> &place,
                                                      const unsigned int facet) const
  {
    const auto &places = faces[facet].places;
    return *std::min_element(
        places.begin(), places.end(),
        [&](const Tensor<1, dim> &a, const Tensor<1, dim> &b)
        { return (a - place - aside).norm_square() < (b - place - aside).norm_square(); });
  }

  template struct CurvedSurface<2>;
  template struct CurvedSurface<3>;
} // namespace tombolo
