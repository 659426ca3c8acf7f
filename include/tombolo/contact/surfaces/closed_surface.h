// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/contact/surfaces/facet_list.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * The closed surface of a rigid body, of facets that are known to bound it: each edge (in two
   * dimensions each corner) belongs to two of them, all are oriented alike with normals out of the
   * body, and none is without area. Whether the surface crosses itself is not looked at here.
   *
   * The normals at edges and corners tell inside from outside for points whose nearest place is
   * there: sums of those of the facets, at corners weighted with the angles of the facets.
   */
  template <int dim>
  class ClosedSurface
  {
  public:
    using Facet = typename FacetList<dim>::Facet;

    /** Distances below this part of the extent are none: vertices as near are one, and a triangle
     * as low has no area. Single precision, which binary files have, is finer. */
    static constexpr double relative_tolerance = 1e-6;

    /** Sides of a facet, of which each belongs to a second facet. */
    static constexpr unsigned int n_sides = dim;

    ClosedSurface() = default;

    /** Merges vertices, drops what is not used, turns facets round where they do not agree; the
     * remarks say what was done. Throws std::invalid_argument with what cannot be mended: a surface
     * that is open, branches, has one side only, touches itself in a point, has triangles without
     * area, or encloses nothing. */
    explicit ClosedSurface(const FacetList<dim> &list);

    /** Vertices go to other places, one for each; normals and the box around the surface follow.
     * What the surface was refused for at the start is not looked at again. */
    void move_vertices(const std::vector<dealii::Tensor<1, dim>> &places);

    std::vector<dealii::Tensor<1, dim>> vertices;       ///< [L]
    std::vector<Facet> facets;                          ///< as in FacetList
    std::vector<dealii::Tensor<1, dim>> facet_normals;  ///< of length one
    std::vector<dealii::Tensor<1, dim>> vertex_normals; ///< likewise
    std::vector<dealii::Tensor<1, dim>> edge_normals;   ///< likewise; none in two dimensions
    struct Edge
    {
      unsigned int vertex[2];
    };
    std::vector<Edge> ends_of_edges; ///< likewise
    /** The edge from vertex k to the next is that of place n_sides*facet + k. */
    std::vector<unsigned int> edges;

    dealii::Tensor<1, dim> low, high; ///< the box around it
    double area = 0;                  ///< a length in two dimensions
    double volume = 0;                ///< an area in two dimensions
    double largest_slenderness = 1;   ///< longest edge over height, of all triangles
    unsigned int n_pieces = 0;        ///< not connected with each other
    unsigned int n_cavities = 0;      ///< of these, with the body outside

    std::vector<std::string> remarks; ///< sentences

  private:
    /** A side of a facet: the same numbers as those of the facet beyond it. */
    struct Side
    {
      unsigned int first, second; ///< vertices, the lower number first; one vertex if dim == 2
      unsigned int facet, number;
      bool is_forward; ///< whether the facet passes it from `first` to `second`
    };

    void merge_vertices(const FacetList<dim> &list);
    void drop_unused_vertices();
    void measure_facets();

    /** Finds the normals of facets, and at vertices and edges the unit vectors along their sums, at
     * vertices weighted with angles. Facets without area keep their normals; the edges of facets
     * must be known. */
    void set_normals();
    /** Sides sorted, those of two facets after each other. */
    std::vector<Side> paired_sides() const;
    /** Turns facets until neighbours agree. Returns the piece that each facet is of. */
    std::vector<unsigned int> orient(const std::vector<Side> &sides);
    void turn_outwards(const std::vector<unsigned int> &piece_of_facet);
    void turn(const std::size_t facet)
    {
      std::swap(facets[facet].vertex[dim - 2], facets[facet].vertex[dim - 1]);
    }

    void refuse_common_points_of_fans(const std::vector<Side> &sides) const;
    void number_edges(const std::vector<Side> &sides);

    double tolerance() const
    {
      return relative_tolerance * (high - low).norm();
    }

    dealii::Tensor<1, dim> center(std::size_t facet) const;
    dealii::Tensor<1, dim> area_vector(std::size_t facet) const;
  };
} // namespace tombolo
