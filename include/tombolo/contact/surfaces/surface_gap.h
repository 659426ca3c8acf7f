// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surfaces/facet_tree.h>

#include <deal.II/base/tensor.h>

#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace tombolo
{
  /** The surface next to a point. */
  template <int dim>
  struct SurfaceGap
  {
    double gap; ///< negative behind it [L]
    dealii::Tensor<1, dim> normal;
    unsigned int facet;
  };

  /** The signed distance of @p point from the place of @p surface that is @p nearest to it, and the
   * normal there. */
  template <int dim>
  std::pair<double, dealii::Tensor<1, dim>> gap_at(const ClosedSurface<dim> &surface,
                                                   const typename FacetTree<dim>::Nearest &nearest,
                                                   const dealii::Tensor<1, dim> &point)
  {
    using Feature = typename FacetTree<dim>::Feature;
    const dealii::Tensor<1, dim> &outward =
        nearest.feature == Feature::facet  ? surface.facet_normals[nearest.number]
        : nearest.feature == Feature::edge ? surface.edge_normals[nearest.number]
                                           : surface.vertex_normals[nearest.number];
    const dealii::Tensor<1, dim> away = point - nearest.place;
    const double distance = std::sqrt(nearest.distance_square);
    const double sign = away * outward < 0. ? -1. : 1.;
    // On the surface itself the way to it has no direction.
    if (nearest.feature != Feature::facet && distance > 1e-12 * (surface.high - surface.low).norm())
      return {sign * distance, sign / distance * away};
    return {sign * distance, outward};
  }

  /** The signed distance to @p surface, of which this is the tree. */
  template <int dim>
  SurfaceGap<dim> gap_to_surface(const ClosedSurface<dim> &surface, const FacetTree<dim> &tree,
                                 const dealii::Tensor<1, dim> &point);

  /** How far a point is outside of the box around a surface; negative inside [L]. */
  template <int dim>
  double distance_to_box(const ClosedSurface<dim> &surface, const dealii::Tensor<1, dim> &point);

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

  /** Nothing where there are no such sides. @p size_of: the size of the cell behind a facet. */
  template <int dim>
  std::optional<FacedSides<dim>>
  faced_sides(const ClosedSurface<dim> &surface, const FacetTree<dim> &tree,
              const dealii::Tensor<1, dim> &point, const dealii::Tensor<1, dim> &area,
              const std::function<double(unsigned int facet)> &size_of);

  /** The number in @p given of each vertex of the @p surface that was made of it. Throws
   * std::invalid_argument where two of them are at one place. */
  template <int dim>
  std::vector<unsigned int> numbers_of_vertices(const FacetList<dim> &given,
                                                const ClosedSurface<dim> &surface);
} // namespace tombolo
