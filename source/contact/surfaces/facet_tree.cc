// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surfaces/facet_tree.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr std::size_t largest_leaf = 4;
    // Halves of unsigned numbers of facets are of one facet sooner.
    constexpr unsigned int largest_depth = 40;
  } // namespace

  template <int dim>
  FacetTree<dim>::FacetTree(const ClosedSurface<dim> &surface)
  {
    std::vector<unsigned int> order(surface.facets.size());
    std::iota(order.begin(), order.end(), 0u);
    facets.reserve(order.size());
    build(surface, order, 0, order.size());
  }

  template <int dim>
  void FacetTree<dim>::build(const ClosedSurface<dim> &surface, std::vector<unsigned int> &order,
                             const std::size_t begin, const std::size_t end)
  {
    Box box;
    box.low = box.high = surface.vertices[surface.facets[order[begin]].vertex[0]];
    for (std::size_t i = begin; i < end; ++i)
      for (const unsigned int v : surface.facets[order[i]].vertex)
        widen_box(box.low, box.high, surface.vertices[v]);
    const std::size_t number = boxes.size();
    if (end - begin <= largest_leaf)
    {
      box.begin = static_cast<unsigned int>(facets.size());
      box.n_facets = static_cast<unsigned int>(end - begin);
      boxes.push_back(box);
      for (std::size_t i = begin; i < end; ++i)
      {
        PackedFacet facet;
        facet.number = order[i];
        facet.normal = surface.facet_normals[order[i]];
        for (unsigned int k = 0; k < dim; ++k)
        {
          facet.vertices[k] = surface.facets[order[i]].vertex[k];
          facet.corners[k] = surface.vertices[facet.vertices[k]];
          facet.edges[k] = dim == 3 ? surface.edges[ClosedSurface<dim>::n_sides * order[i] + k] : 0;
        }
        facets.push_back(facet);
      }
      return;
    }
    box.n_facets = 0;
    boxes.push_back(box);
    unsigned int axis = 0;
    for (unsigned int d = 1; d < dim; ++d)
      if (box.high[d] - box.low[d] > box.high[axis] - box.low[axis])
        axis = d;
    const auto key = [&](const unsigned int facet)
    {
      double sum = 0;
      for (const unsigned int v : surface.facets[facet].vertex)
        sum += surface.vertices[v][axis];
      return sum;
    };
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](const std::size_t i)
    { return order.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end),
                     [&](const unsigned int a, const unsigned int b)
                     {
                       const double key_a = key(a), key_b = key(b);
                       return key_a < key_b || (key_a == key_b && a < b);
                     });
    build(surface, order, begin, middle);
    boxes[number].begin = static_cast<unsigned int>(boxes.size());
    build(surface, order, middle, end);
  }

  template <int dim>
  bool FacetTree<dim>::consider_side(const PackedFacet &facet, const unsigned int side,
                                     const Tensor<1, dim> &point, Nearest &nearest)
  {
    const unsigned int next = (side + 1) % dim;
    const Tensor<1, dim> along = facet.corners[next] - facet.corners[side];
    const double t = (point - facet.corners[side]) * along / along.norm_square();
    const bool is_first = !(t > 0.), is_second = t >= 1.;
    const Tensor<1, dim> point_on_side = is_first    ? facet.corners[side]
                                         : is_second ? facet.corners[next]
                                                     : facet.corners[side] + t * along;
    const double square = (point - point_on_side).norm_square();
    if (!(square < nearest.distance_square))
      return false;
    nearest.distance_square = square;
    nearest.point = point_on_side;
    if (is_first || is_second)
    {
      nearest.feature = Feature::vertex;
      nearest.number = facet.vertices[is_first ? side : next];
    }
    else
    {
      nearest.feature = dim == 2 ? Feature::facet : Feature::edge;
      nearest.number = dim == 2 ? facet.number : facet.edges[side];
    }
    return true;
  }

  template <int dim>
  void FacetTree<dim>::consider(const unsigned int index, const Tensor<1, dim> &point,
                                Nearest &nearest) const
  {
    const PackedFacet &facet = facets[index];
    bool is_nearer = false;
    if constexpr (dim == 2)
      is_nearer = consider_side(facet, 0, point, nearest);
    else
    {
      const double height = (point - facet.corners[0]) * facet.normal;
      if (!(height * height < nearest.distance_square))
        return;
      bool is_above = true;
      for (unsigned int k = 0; k < 3; ++k)
      {
        const Tensor<1, 3> along = facet.corners[(k + 1) % 3] - facet.corners[k];
        // The nearest point of the border is on a side that the point is beyond.
        if (cross_product_3d(along, point - facet.corners[k]) * facet.normal < 0.)
        {
          is_above = false;
          is_nearer = consider_side(facet, k, point, nearest) || is_nearer;
        }
      }
      if (is_above)
      {
        nearest = {height * height, point - height * facet.normal, Feature::facet, facet.number, 0};
        is_nearer = true;
      }
    }
    if (is_nearer)
      nearest.hint = index;
  }

  template <int dim>
  template <typename Accepts>
  void FacetTree<dim>::search(const Tensor<1, dim> &point, const Accepts &accepts,
                              Nearest &result) const
  {
    struct Waiting
    {
      unsigned int box;
      double distance_square;
    };
    Waiting waiting[largest_depth];
    unsigned int n_waiting = 0;
    waiting[n_waiting++] = {0, 0.};
    while (n_waiting > 0)
    {
      const Waiting next = waiting[--n_waiting];
      if (!(next.distance_square < result.distance_square))
        continue;
      const Box &box = boxes[next.box];
      if (box.n_facets > 0)
      {
        for (unsigned int k = 0; k < box.n_facets; ++k)
          if (accepts(facets[box.begin + k]))
            consider(box.begin + k, point, result);
        continue;
      }
      const auto waits = [&](const unsigned int number) -> Waiting
      {
        const Box &within = boxes[number];
        return {number, distance_square_to_box(within.low, within.high, point)};
      };
      const Waiting first = waits(next.box + 1), second = waits(box.begin);
      const bool first_is_nearer = first.distance_square <= second.distance_square;
      waiting[n_waiting++] = first_is_nearer ? second : first;
      waiting[n_waiting++] = first_is_nearer ? first : second;
    }
  }

  template <int dim>
  typename FacetTree<dim>::Nearest FacetTree<dim>::nearest(const Tensor<1, dim> &point,
                                                           const unsigned int hint) const
  {
    Nearest result{};
    result.distance_square = std::numeric_limits<double>::max();
    consider(hint, point, result);
    search(
        point, [](const PackedFacet &) { return true; }, result);
    return result;
  }

  template <int dim>
  typename FacetTree<dim>::Nearest
  FacetTree<dim>::nearest_on_facet_of(const Nearest &found, const Tensor<1, dim> &point) const
  {
    Nearest result{};
    result.distance_square = std::numeric_limits<double>::max();
    consider(found.hint, point, result);
    return result;
  }

  template <int dim>
  std::optional<typename FacetTree<dim>::Nearest>
  FacetTree<dim>::nearest_facing(const Tensor<1, dim> &point, const Tensor<1, dim> &direction,
                                 const double limit) const
  {
    constexpr double none = std::numeric_limits<double>::max();
    Nearest result{};
    result.distance_square = none;
    search(
        point, [&](const PackedFacet &facet) { return facet.normal * direction < limit; }, result);
    if (result.distance_square < none)
      return result;
    return std::nullopt;
  }

  template <int dim>
  void FacetTree<dim>::refit(const ClosedSurface<dim> &surface)
  {
    for (PackedFacet &facet : facets)
    {
      facet.normal = surface.facet_normals[facet.number];
      for (unsigned int k = 0; k < dim; ++k)
        facet.corners[k] = surface.vertices[facet.vertices[k]];
    }
    // Boxes within a box follow it.
    for (std::size_t number = boxes.size(); number-- > 0;)
    {
      Box &box = boxes[number];
      const bool is_leaf = box.n_facets > 0;
      box.low = is_leaf ? facets[box.begin].corners[0] : boxes[number + 1].low;
      box.high = is_leaf ? facets[box.begin].corners[0] : boxes[number + 1].high;
      if (!is_leaf)
        for (const auto &corner : {boxes[box.begin].low, boxes[box.begin].high})
          widen_box(box.low, box.high, corner);
      for (unsigned int k = 0; k < box.n_facets; ++k)
        for (const Tensor<1, dim> &corner : facets[box.begin + k].corners)
          widen_box(box.low, box.high, corner);
    }
  }

  template <int dim>
  bool FacetTree<dim>::passes_through(const PackedFacet &facet, const Tensor<1, dim> &begin,
                                      const Tensor<1, dim> &end, const double tolerance,
                                      Tensor<1, dim> &crossing)
  {
    const double from = (begin - facet.corners[0]) * facet.normal;
    const double to = (end - facet.corners[0]) * facet.normal;
    if (!(from * to < 0. && std::abs(from) > tolerance && std::abs(to) > tolerance))
      return false;
    crossing = begin + from / (from - to) * (end - begin);
    for (unsigned int k = 0; k < dim; ++k)
    {
      const Tensor<1, dim> along = facet.corners[(k + 1) % dim] - facet.corners[k];
      const Tensor<1, dim> arm = crossing - facet.corners[k];
      double inside;
      if constexpr (dim == 2)
        inside = along * arm;
      else
        inside = cross_product_3d(along, arm) * facet.normal;
      if (!(inside > tolerance * along.norm()))
        return false;
    }
    return true;
  }

  template <int dim>
  std::optional<Tensor<1, dim>>
  FacetTree<dim>::find_crossing(const ClosedSurface<dim> &surface) const
  {
    const double tolerance =
        ClosedSurface<dim>::relative_tolerance * (surface.high - surface.low).norm();
    const auto pass_from = [&](const unsigned int *const ends) -> std::optional<Tensor<1, dim>>
    {
      const Tensor<1, dim> &begin = surface.vertices[ends[0]], &end = surface.vertices[ends[1]];
      const auto is_beside = [&](const Box &box)
      {
        for (unsigned int d = 0; d < dim; ++d)
          if (std::max(begin[d], end[d]) < box.low[d] || std::min(begin[d], end[d]) > box.high[d])
            return true;
        return false;
      };
      unsigned int waiting[largest_depth];
      unsigned int n_waiting = 0;
      waiting[n_waiting++] = 0;
      while (n_waiting > 0)
      {
        const unsigned int number = waiting[--n_waiting];
        const Box &box = boxes[number];
        if (is_beside(box))
          continue;
        if (box.n_facets == 0)
        {
          waiting[n_waiting++] = box.begin;
          waiting[n_waiting++] = number + 1;
        }
        for (unsigned int k = 0; k < box.n_facets; ++k)
        {
          Tensor<1, dim> crossing;
          if (passes_through(facets[box.begin + k], begin, end, tolerance, crossing))
            return crossing;
        }
      }
      return std::nullopt;
    };
    if constexpr (dim == 2)
    {
      for (const auto &facet : surface.facets)
        if (const auto crossing = pass_from(facet.vertex))
          return crossing;
    }
    else
      for (const auto &edge : surface.ends_of_edges)
        if (const auto crossing = pass_from(edge.vertex))
          return crossing;
    return std::nullopt;
  }

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
    const Tensor<1, dim> away = point - result.point;
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
    const Tensor<1, dim> away = point - nearest->point;
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
  template class FacetTree<2>;
  template class FacetTree<3>;
} // namespace tombolo
