// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surfaces/surface_gap.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** A node with faces touches facets whose normals have a cosine below this with its own. */
    constexpr double facing_limit = -0.1;
    /** The slope at which a side goes on beyond its edge. */
    constexpr double slope_beyond_edge = 0.1;
  } // namespace

  template <int dim>
  SurfaceGap<dim> SearchedSurface<dim>::gap(const Tensor<1, dim> &point,
                                            const unsigned int hint) const
  {
    using Feature = typename FacetTree<dim>::Feature;
    SurfaceGap<dim> result{tree.nearest(point, hint), 0., {}, 0};
    result.facet = tree.facet_of(result);
    const Tensor<1, dim> &outward =
        result.feature == Feature::facet  ? this->facet_normals[result.number]
        : result.feature == Feature::edge ? this->edge_normals[result.number]
                                          : this->vertex_normals[result.number];
    const Tensor<1, dim> away = point - result.place;
    const double distance = std::sqrt(result.distance_square);
    const double sign = away * outward < 0. ? -1. : 1.;
    result.gap = sign * distance;
    // On the surface itself the way to it has no direction.
    const bool has_direction =
        result.feature != Feature::facet && distance > 1e-12 * (this->high - this->low).norm();
    result.normal = has_direction ? sign / distance * away : outward;
    return result;
  }

  template <int dim>
  double SearchedSurface<dim>::distance_to_box(const Tensor<1, dim> &point) const
  {
    double result = std::numeric_limits<double>::lowest();
    for (unsigned int d = 0; d < dim; ++d)
      result = std::max({result, this->low[d] - point[d], point[d] - this->high[d]});
    return result;
  }

  template <int dim>
  bool FacedSides<dim>::are_of(const Tensor<1, dim> &area, const Tensor<1, dim> &normal)
  {
    return normal * area < facing_limit * area.norm();
  }

  template <int dim>
  std::optional<FacedSides<dim>>
  SearchedSurface<dim>::faced_sides(const Tensor<1, dim> &point, const Tensor<1, dim> &area,
                                    const std::function<double(unsigned int facet)> &size_of) const
  {
    if (!(area.norm_square() > 0.))
      return std::nullopt;
    const auto nearest = tree.nearest_facing(point, area, facing_limit * area.norm());
    if (!nearest)
      return std::nullopt;
    FacedSides<dim> result;
    result.gap.facet = tree.facet_of(*nearest);
    result.gap.normal = this->facet_normals[result.gap.facet];
    result.size = size_of(result.gap.facet);
    const Tensor<1, dim> away = point - nearest->place;
    const Tensor<1, dim> along = away - (away * result.gap.normal) * result.gap.normal;
    result.behind = -(away * result.gap.normal);
    result.outside = along.norm();
    const double beyond = std::max(0., result.outside - result.across_edge * result.size);
    result.gap.gap = slope_beyond_edge * beyond - result.behind;
    if (beyond > 0.)
    {
      result.gap.normal += slope_beyond_edge / result.outside * along;
      result.gap.normal /= result.gap.normal.norm();
    }
    return result;
  }

  template struct FacedSides<2>;
  template struct FacedSides<3>;
  template class SearchedSurface<2>;
  template class SearchedSurface<3>;
} // namespace tombolo
