// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/contact/surfaces/facet_list.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * The closed surface of a rigid body, of facets that bound it: each edge (in two dimensions each
   * corner) belongs to two of them, all are oriented alike with normals out of the body, and none
   * is without area. Whether the surface crosses itself is not checked here.
   *
   * The normals at edges and corners separate inside from outside for points whose nearest point of
   * the surface is there: sums of those of the facets, at corners weighted with the angles of the
   * facets.
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
     * remarks describe it. Throws std::invalid_argument with what cannot be corrected: a surface
     * that is open, branches, has one side only, touches itself in a point, has triangles without
     * area, or encloses nothing. */
    explicit ClosedSurface(const FacetList<dim> &list);

    /** Moves the vertices to these positions, one for each; normals and the box around the surface
     * follow. The checks of the start are not repeated. */
    void move_vertices(const std::vector<dealii::Tensor<1, dim>> &positions);

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
    /** The edge from vertex k to the next has the index n_sides*facet + k. */
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

    /** Finds normals of facets, and at vertices (weighted with angles) and edges the unit vectors
     * along their sums. Facets without area keep theirs; edges of facets must be numbered. */
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

    dealii::Tensor<1, dim> center(const std::size_t facet) const
    {
      dealii::Tensor<1, dim> sum;
      for (const unsigned int v : facets[facet].vertex)
        sum += vertices[v];
      return sum / dim;
    }
    dealii::Tensor<1, dim> area_vector(std::size_t facet) const;
  };

  /** Finds the point of a closed surface that is nearest to a given one: a binary tree of boxes
   * along the axes around the facets, each halved at the median. */
  template <int dim>
  class FacetTree
  {
  public:
    enum class Feature : unsigned char
    {
      facet,
      edge, ///< in three dimensions
      vertex
    };

    /** A point of the surface, and the facet, edge or vertex of ClosedSurface that it is in. */
    struct Nearest
    {
      double distance_square; ///< [L^2]
      dealii::Tensor<1, dim> point;
      Feature feature;
      unsigned int number; ///< of the facet, edge or vertex
      unsigned int hint;   ///< for points near by
    };

    FacetTree() = default;
    explicit FacetTree(const ClosedSurface<dim> &surface);

    /** The search is shorter where @p hint is that of a point near by. */
    Nearest nearest(const dealii::Tensor<1, dim> &point, unsigned int hint = 0) const;

    /** The same of facets whose normals have a product with @p direction below @p limit, if any. */
    std::optional<Nearest> nearest_facing(const dealii::Tensor<1, dim> &point,
                                          const dealii::Tensor<1, dim> &direction,
                                          double limit) const;

    /** The same of one facet alone, that on which @p found is. */
    Nearest nearest_on_facet_of(const Nearest &found, const dealii::Tensor<1, dim> &point) const;

    /** A facet that the point found is on. */
    unsigned int facet_of(const Nearest &nearest) const
    {
      return facets[nearest.hint].number;
    }

    /** Vertices of @p surface, that of the tree, have moved: boxes keep their facets. */
    void refit(const ClosedSurface<dim> &surface);

    /** A point where the edge of a facet (in two dimensions a side) passes through another one, if
     * there is any on @p surface, that of the tree: the ends of the edge and the border of the
     * facet are farther away than the tolerance of the surface. */
    std::optional<dealii::Tensor<1, dim>> find_crossing(const ClosedSurface<dim> &surface) const;

  private:
    struct Box
    {
      dealii::Tensor<1, dim> low, high;
      /** Of its facets, or of the second of the boxes within it; the first one follows it. */
      unsigned int begin;
      unsigned int n_facets; ///< zero if there are boxes within it
    };
    struct PackedFacet
    {
      dealii::Tensor<1, dim> corners[dim];
      dealii::Tensor<1, dim> normal;
      unsigned int vertices[dim];
      unsigned int edges[dim];
      unsigned int number;
    };

    void build(const ClosedSurface<dim> &surface, std::vector<unsigned int> &order,
               std::size_t begin, std::size_t end);
    void consider(unsigned int index, const dealii::Tensor<1, dim> &point, Nearest &nearest) const;
    /** Considers all facets that @p accepts and that can be nearer than the present result. */
    template <typename Accepts>
    void search(const dealii::Tensor<1, dim> &point, const Accepts &accepts, Nearest &result) const;
    /** Whether the line from @p begin to @p end passes through a facet, and where. */
    static bool passes_through(const PackedFacet &facet, const dealii::Tensor<1, dim> &begin,
                               const dealii::Tensor<1, dim> &end, double tolerance,
                               dealii::Tensor<1, dim> &crossing);
    static bool consider_side(const PackedFacet &facet, unsigned int side,
                              const dealii::Tensor<1, dim> &point, Nearest &nearest);

    std::vector<Box> boxes;
    std::vector<PackedFacet> facets;
  };

  /** The surface next to a point, and its nearest point. */
  template <int dim>
  struct SurfaceGap : FacetTree<dim>::Nearest
  {
    double gap; ///< negative behind it [L]
    dealii::Tensor<1, dim> normal;
    unsigned int facet;
  };

  /** The sides of a surface that the outward area of a node faces. */
  template <int dim>
  struct FacedSides
  {
    /** How far beyond their edge a node belongs to these sides, over the size of the cell there. */
    static constexpr double across_edge = 0.01;

    /** That to the plane of the nearest side, which goes on beyond its edge, and from across_edge
     * on falls off slowly: so the gap is continuous. */
    SurfaceGap<dim> gap;
    double behind;  ///< the depth behind the plane of the nearest side [L]
    double outside; ///< the distance from the side, within this plane [L]
    double size;    ///< of the cell at the nearest side [L]

    static bool are_of(const dealii::Tensor<1, dim> &area, const dealii::Tensor<1, dim> &normal);
  };

  /** A closed surface with the tree of its facets. */
  template <int dim>
  class SearchedSurface : public ClosedSurface<dim>
  {
  public:
    SearchedSurface() = default;

    explicit SearchedSurface(const ClosedSurface<dim> &surface)
        : ClosedSurface<dim>(surface), tree(*this)
    {}

    /** The signed distance of a point from the surface, and the normal at the nearest point;
     * @p hint as in FacetTree. */
    SurfaceGap<dim> gap(const dealii::Tensor<1, dim> &point, unsigned int hint = 0) const;

    /** How far a point is outside of the box around the surface; negative inside [L]. */
    double distance_to_box(const dealii::Tensor<1, dim> &point) const
    {
      double result = std::numeric_limits<double>::lowest();
      for (unsigned int d = 0; d < dim; ++d)
        result = std::max({result, this->low[d] - point[d], point[d] - this->high[d]});
      return result;
    }

    /** Empty where there are no such sides. @p size_of: the size of the cell behind a facet. */
    std::optional<FacedSides<dim>>
    faced_sides(const dealii::Tensor<1, dim> &point, const dealii::Tensor<1, dim> &area,
                const std::function<double(unsigned int facet)> &size_of) const;

    /** See FacetTree. */
    std::optional<dealii::Tensor<1, dim>> find_crossing() const
    {
      return tree.find_crossing(*this);
    }

    /** See ClosedSurface. */
    void move_vertices(const std::vector<dealii::Tensor<1, dim>> &positions)
    {
      ClosedSurface<dim>::move_vertices(positions);
      tree.refit(*this);
    }

  private:
    FacetTree<dim> tree;
  };

  extern template class ClosedSurface<2>;
  extern template class ClosedSurface<3>;
} // namespace tombolo
