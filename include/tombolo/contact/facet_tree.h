#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/contact/closed_surface.h>

#include <cstddef>
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
    };

    FacetTree() = default;
    explicit FacetTree(const ClosedSurface<dim> &surface);

    Nearest nearest(const dealii::Tensor<1, dim> &point) const;

    /** Of the tree and its facets, in bytes. */
    std::size_t memory_consumption() const;

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
    static void consider(const PackedFacet &facet, const dealii::Tensor<1, dim> &point,
                         Nearest &nearest);
    static void consider_side(const PackedFacet &facet, unsigned int side,
                              const dealii::Tensor<1, dim> &point, Nearest &nearest);

    std::vector<Box> boxes;
    std::vector<PackedFacet> facets;
  };
} // namespace tombolo
