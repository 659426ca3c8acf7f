// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/contact/surfaces/closed_surface.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace tombolo
{
  /** Finds the place of a closed surface that is next to a point: a binary tree of boxes along the
   * axes around the facets, each halved at the median. */
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

    /** A place of the surface, and the facet, edge or vertex of ClosedSurface that it is in. */
    struct Nearest
    {
      double distance_square; ///< [L^2]
      dealii::Tensor<1, dim> place;
      Feature feature;
      unsigned int number; ///< of the facet, edge or vertex
      unsigned int hint;   ///< for places near by
    };

    FacetTree() = default;
    explicit FacetTree(const ClosedSurface<dim> &surface);

    /** The search is shorter where @p hint is that of the nearest place of a point near by. */
    Nearest nearest(const dealii::Tensor<1, dim> &point, unsigned int hint = 0) const;

    /** The same of the facets whose normals have a product with @p direction below @p limit;
     * nothing where there are none. */
    std::optional<Nearest> nearest_facing(const dealii::Tensor<1, dim> &point,
                                          const dealii::Tensor<1, dim> &direction,
                                          double limit) const;

    /** The same of one facet alone, that on which @p found is. */
    Nearest nearest_on_facet_of(const Nearest &found, const dealii::Tensor<1, dim> &point) const;

    /** A facet that the place found is on. */
    unsigned int facet_of(const Nearest &nearest) const
    {
      return facets[nearest.hint].number;
    }

    /** Vertices of @p surface, that of the tree, have moved: boxes grow or shrink, and keep their
     * facets. */
    void refit(const ClosedSurface<dim> &surface);

    /** A place where the edge of a facet (in two dimensions a side) passes through another one, if
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
    static double distance_square(const Box &box, const dealii::Tensor<1, dim> &point);
    void consider(unsigned int place, const dealii::Tensor<1, dim> &point, Nearest &nearest) const;
    /** Considers all facets that @p takes and that can be nearer than what is known. */
    template <typename Takes>
    void search(const dealii::Tensor<1, dim> &point, const Takes &takes, Nearest &result) const;
    /** Whether the line from @p begin to @p end passes through a facet, and where. */
    static bool passes_through(const PackedFacet &facet, const dealii::Tensor<1, dim> &begin,
                               const dealii::Tensor<1, dim> &end, double tolerance,
                               dealii::Tensor<1, dim> &place);
    static bool consider_side(const PackedFacet &facet, unsigned int side,
                              const dealii::Tensor<1, dim> &point, Nearest &nearest);

    std::vector<Box> boxes;
    std::vector<PackedFacet> facets;
  };

  /** The surface next to a point, and the place on it that is nearest. */
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
    /** How far beyond the edge of these sides a node belongs to them as within, over the size of
     * the cell there. */
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

    /** The signed distance of a point from the place that is nearest to it, and the normal there;
     * @p hint as in FacetTree. */
    SurfaceGap<dim> gap(const dealii::Tensor<1, dim> &point, unsigned int hint = 0) const;

    /** How far a point is outside of the box around the surface; negative inside [L]. */
    double distance_to_box(const dealii::Tensor<1, dim> &point) const;

    /** Nothing where there are no such sides. @p size_of: the size of the cell behind a facet. */
    std::optional<FacedSides<dim>>
    faced_sides(const dealii::Tensor<1, dim> &point, const dealii::Tensor<1, dim> &area,
                const std::function<double(unsigned int facet)> &size_of) const;

    /** See FacetTree. */
    std::optional<dealii::Tensor<1, dim>> find_crossing() const
    {
      return tree.find_crossing(*this);
    }

    /** See ClosedSurface. */
    void move_vertices(const std::vector<dealii::Tensor<1, dim>> &places)
    {
      ClosedSurface<dim>::move_vertices(places);
      tree.refit(*this);
    }

  private:
    FacetTree<dim> tree;
  };
} // namespace tombolo
