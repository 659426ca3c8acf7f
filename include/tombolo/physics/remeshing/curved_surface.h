// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surfaces/facet_tree.h>

#include <deal.II/base/geometry_info.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace tombolo
{
  /** A piece of the boundary of a part, of all ranks: facets that are curved between the nodes of
   * their faces. Where several points are equally near, one direction decides, and no round-off. */
  template <int dim>
  struct CurvedSurface
  {
    using Nearest = typename FacetTree<dim>::Nearest;

    static constexpr unsigned int n_face_nodes = dealii::GeometryInfo<dim>::vertices_per_face;

    /** The nodes of a face of the boundary, and the normals there; zero at edges of the body. */
    struct Face
    {
      std::array<dealii::Tensor<1, dim>, n_face_nodes> positions, normals;
    };

    /** The position of each vertex of a facet is this mean of the positions of the nodes of its
     * face. */
    using Shares = std::array<std::array<double, n_face_nodes>, dim>;

    ClosedSurface<dim> facets;
    FacetTree<dim> tree;
    std::vector<Face> faces;    ///< of each facet
    std::vector<Shares> shares; ///< of each facet

    /** A facet in messages between ranks. */
    struct Piece
    {
      std::array<dealii::Tensor<1, dim>, dim> vertices;
      dealii::Tensor<1, dim> normal;
      Shares shares;
      Face face;
    };

    void add(const std::vector<Piece> &rank_pieces)
    {
      for (const Piece &piece : rank_pieces)
      {
        typename ClosedSurface<dim>::Facet facet;
        for (unsigned int v = 0; v < dim; ++v)
        {
          facet.vertex[v] = static_cast<unsigned int>(facets.vertices.size());
          facets.vertices.push_back(piece.vertices[v]);
        }
        facets.facets.push_back(facet);
        facets.facet_normals.push_back(piece.normal);
        facets.edges.insert(facets.edges.end(), ClosedSurface<dim>::n_sides, 0u);
        shares.push_back(piece.shares);
        faces.push_back(piece.face);
      }
    }

    /** All facets were added. */
    void complete()
    {
      constexpr double share_of_size = 1e-7;
      // No plane between two nodes of a lattice is along this direction.
      constexpr double direction[3] = {0.8192, 0.4657, 0.3346};
      tree = FacetTree<dim>(facets);
      double largest = 0; // so that it does not depend on the order of ranks
      for (const Face &face : faces)
        largest = std::max(largest, (face.positions.back() - face.positions.front()).norm_square());
      for (unsigned int d = 0; d < dim; ++d)
        aside[d] = share_of_size * std::sqrt(largest) * direction[d];
    }

    /** See FacetTree. */
    Nearest nearest(const dealii::Tensor<1, dim> &point) const
    {
      return tree.nearest_on_facet_of(tree.nearest(point + aside), point);
    }

    std::optional<Nearest> nearest_facing(const dealii::Tensor<1, dim> &point,
                                          const dealii::Tensor<1, dim> &direction,
                                          const double limit) const
    {
      const auto found = tree.nearest_facing(point + aside, direction, limit);
      return found ? std::optional<Nearest>(tree.nearest_on_facet_of(*found, point)) : std::nullopt;
    }

    /** The point of the curved surface over a point of a facet: half of the way to the tangent
     * planes at the nodes of the face. */
    dealii::Tensor<1, dim> raise(const dealii::Tensor<1, dim> &point,
                                 const unsigned int facet) const
    {
      const auto vertex = [&](const unsigned int v) -> const dealii::Tensor<1, dim> &
      { return facets.vertices[facets.facets[facet].vertex[v]]; };
      std::array<double, dim> coordinates{};
      if constexpr (dim == 2)
      {
        const dealii::Tensor<1, dim> along = vertex(1) - vertex(0);
        coordinates[1] = (point - vertex(0)) * along / along.norm_square();
      }
      else
      {
        const dealii::Tensor<1, dim> a = vertex(1) - vertex(0), b = vertex(2) - vertex(0),
                                     r = point - vertex(0);
        const double aa = a * a, ab = a * b, bb = b * b, determinant = aa * bb - ab * ab;
        coordinates[1] = (bb * (r * a) - ab * (r * b)) / determinant;
        coordinates[2] = (aa * (r * b) - ab * (r * a)) / determinant;
      }
      coordinates[0] = 1.;
      for (unsigned int v = 1; v < dim; ++v)
        coordinates[0] -= coordinates[v];
      dealii::Tensor<1, dim> result = point;
      for (unsigned int k = 0; k < n_face_nodes; ++k)
      {
        double share = 0;
        for (unsigned int v = 0; v < dim; ++v)
          share += coordinates[v] * shares[facet][v][k];
        const dealii::Tensor<1, dim> &normal = faces[facet].normals[k];
        result += 0.5 * share * (normal * (faces[facet].positions[k] - point)) * normal;
      }
      return result;
    }

    /** The node of the face of a facet that is nearest to a point. */
    const dealii::Tensor<1, dim> &node_near(const dealii::Tensor<1, dim> &point,
                                            const unsigned int facet) const
    {
      const auto &positions = faces[facet].positions;
      return *std::min_element(
          positions.begin(), positions.end(),
          [&](const dealii::Tensor<1, dim> &a, const dealii::Tensor<1, dim> &b)
          { return (a - point - aside).norm_square() < (b - point - aside).norm_square(); });
    }

    dealii::Tensor<1, dim> aside; ///< a small way, by which ties are decided [L]
  };
} // namespace tombolo
