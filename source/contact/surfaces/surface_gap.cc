// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surfaces/surface_gap.h>

#include <tombolo/base/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

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
  SurfaceGap<dim> gap_to_surface(const ClosedSurface<dim> &surface, const FacetTree<dim> &tree,
                                 const Tensor<1, dim> &point)
  {
    const auto nearest = tree.nearest(point);
    const auto [gap, normal] = gap_at<dim>(surface, nearest, point);
    return {gap, normal, tree.facet_of(nearest)};
  }

  template <int dim>
  double distance_to_box(const ClosedSurface<dim> &surface, const Tensor<1, dim> &point)
  {
    double result = std::numeric_limits<double>::lowest();
    for (unsigned int d = 0; d < dim; ++d)
      result = std::max({result, surface.low[d] - point[d], point[d] - surface.high[d]});
    return result;
  }

  template <int dim>
  bool FacedSides<dim>::are_of(const Tensor<1, dim> &area, const Tensor<1, dim> &normal)
  {
    return normal * area < facing_limit * area.norm();
  }

  template <int dim>
  std::optional<FacedSides<dim>>
  faced_sides(const ClosedSurface<dim> &surface, const FacetTree<dim> &tree,
              const Tensor<1, dim> &point, const Tensor<1, dim> &area,
              const std::function<double(unsigned int facet)> &size_of)
  {
    if (!(area.norm_square() > 0.))
      return std::nullopt;
    const auto nearest = tree.nearest_facing(point, area, facing_limit * area.norm());
    if (!nearest)
      return std::nullopt;
    FacedSides<dim> result;
    result.gap.facet = tree.facet_of(*nearest);
    result.gap.normal = surface.facet_normals[result.gap.facet];
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

  template <int dim>
  std::vector<unsigned int> numbers_of_vertices(const FacetList<dim> &given,
                                                const ClosedSurface<dim> &surface)
  {
    std::vector<unsigned int> result(surface.vertices.size());
    for (std::size_t f = 0; f < given.facets.size(); ++f)
      for (const unsigned int v : surface.facets[f].vertex)
      {
        const auto &numbers = given.facets[f].vertex;
        const auto found = std::find_if(std::begin(numbers), std::end(numbers),
                                        [&](const unsigned int number)
                                        { return given.vertices[number] == surface.vertices[v]; });
        if (found == std::end(numbers))
          throw std::invalid_argument("it has two nodes at " + place_text(surface.vertices[v]));
        result[v] = *found;
      }
    return result;
  }

  template SurfaceGap<2> gap_to_surface(const ClosedSurface<2> &, const FacetTree<2> &,
                                        const Tensor<1, 2> &);
  template SurfaceGap<3> gap_to_surface(const ClosedSurface<3> &, const FacetTree<3> &,
                                        const Tensor<1, 3> &);
  template double distance_to_box(const ClosedSurface<2> &, const Tensor<1, 2> &);
  template double distance_to_box(const ClosedSurface<3> &, const Tensor<1, 3> &);
  template struct FacedSides<2>;
  template struct FacedSides<3>;
  template std::optional<FacedSides<2>> faced_sides(const ClosedSurface<2> &, const FacetTree<2> &,
                                                    const Tensor<1, 2> &, const Tensor<1, 2> &,
                                                    const std::function<double(unsigned int)> &);
  template std::optional<FacedSides<3>> faced_sides(const ClosedSurface<3> &, const FacetTree<3> &,
                                                    const Tensor<1, 3> &, const Tensor<1, 3> &,
                                                    const std::function<double(unsigned int)> &);
  template std::vector<unsigned int> numbers_of_vertices(const FacetList<2> &,
                                                         const ClosedSurface<2> &);
  template std::vector<unsigned int> numbers_of_vertices(const FacetList<3> &,
                                                         const ClosedSurface<3> &);
} // namespace tombolo
