// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surfaces/facet_tree.h>

#include <tombolo/base/format.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/point.h>
#include <deal.II/numerics/rtree.h>

#include <boost/pending/disjoint_sets.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <tuple>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    double angle_at(const ClosedSurface<dim> &surface, const std::size_t facet,
                    const unsigned int k)
    {
      if constexpr (dim == 3)
      {
        const auto &v = surface.facets[facet].vertex;
        const Tensor<1, 3> &corner = surface.vertices[v[k]];
        const Tensor<1, 3> a = surface.vertices[v[(k + 1) % 3]] - corner;
        const Tensor<1, 3> b = surface.vertices[v[(k + 2) % 3]] - corner;
        return std::atan2(cross_product_3d(a, b).norm(), a * b);
      }
      return 1.;
    }

    /** Sums of nothing are at folds without a thickness, where any direction will do. */
    template <int dim>
    void make_unit(std::vector<Tensor<1, dim>> &normals)
    {
      for (Tensor<1, dim> &normal : normals)
      {
        const double size = normal.norm();
        if (size > 0.)
          normal /= size;
        else
          normal[dim - 1] = 1.;
      }
    }

    template <int dim>
    constexpr const char *facets_text = dim == 2 ? "sides" : "triangles";

    constexpr unsigned int no_number = static_cast<unsigned int>(-1);
  } // namespace

  template <int dim>
  void ClosedSurface<dim>::set_normals()
  {
    facet_normals.resize(facets.size());
    vertex_normals.assign(vertices.size(), Tensor<1, dim>());
    edge_normals.assign(ends_of_edges.size(), Tensor<1, dim>());
    for (std::size_t f = 0; f < facets.size(); ++f)
    {
      const Tensor<1, dim> outward = area_vector(f);
      Tensor<1, dim> &normal = facet_normals[f];
      if (const double size = outward.norm(); size > 0.)
        normal = outward / size;
      for (unsigned int k = 0; k < dim; ++k)
      {
        vertex_normals[facets[f].vertex[k]] += angle_at(*this, f, k) * normal;
        if (dim == 3)
          edge_normals[edges[dim * f + k]] += normal;
      }
    }
    make_unit(vertex_normals);
    make_unit(edge_normals);
  }

  template <int dim>
  void ClosedSurface<dim>::move_vertices(const std::vector<Tensor<1, dim>> &positions)
  {
    vertices = positions;
    low = high = positions[0];
    for (const Tensor<1, dim> &position : positions)
      widen_box(low, high, position);
    set_normals();
  }

  template <int dim>
  ClosedSurface<dim>::ClosedSurface(const FacetList<dim> &list)
  {
    merge_vertices(list);
    drop_unused_vertices();
    measure_facets();
    const std::vector<Side> sides = paired_sides();
    turn_outwards(orient(sides));
    refuse_common_points_of_fans(sides);
    number_edges(sides);
    set_normals();
  }

  template <int dim>
  Tensor<1, dim> ClosedSurface<dim>::area_vector(const std::size_t facet) const
  {
    const auto &v = facets[facet].vertex;
    const Tensor<1, dim> first = vertices[v[1]] - vertices[v[0]];
    if constexpr (dim == 2)
      return Tensor<1, 2>({first[1], -first[0]});
    else
      return 0.5 * cross_product_3d(first, vertices[v[2]] - vertices[v[0]]);
  }

  template <int dim>
  void ClosedSurface<dim>::merge_vertices(const FacetList<dim> &list)
  {
    if (list.facets.empty())
      throw std::invalid_argument(std::string("there are no ") + facets_text<dim>);
    low = high = list.vertices[list.facets[0].vertex[0]];
    for (const Facet &facet : list.facets)
      for (const unsigned int v : facet.vertex)
        widen_box(low, high, list.vertices[v]);
    // Squares and cubes of these are numbers, too.
    const double extent = (high - low).norm();
    if (!(extent > 1e-50 && low.norm() < 1e50 && high.norm() < 1e50))
      throw std::invalid_argument("its extent from " + position_text(low) + " to " +
                                  position_text(high) + " is not that of a body");
    if (!(extent > 1e-6 * (low.norm() + high.norm())))
      throw std::invalid_argument("it is so far from its own origin that the numbers do not "
                                  "resolve it, from " +
                                  position_text(low) + " to " + position_text(high));

    const std::vector<Point<dim>> points(list.vertices.begin(), list.vertices.end());
    const auto tree = pack_rtree_of_indices(points);
    std::vector<unsigned int> number(list.vertices.size(), no_number);
    std::vector<std::size_t> near;
    // The number of a vertex that is at almost the same point and has one, or a new one.
    const auto merged_number = [&](const Tensor<1, dim> &point)
    {
      BoundingBox<dim> box({Point<dim>(point), Point<dim>(point)});
      box.extend(tolerance());
      near.clear();
      tree.query(boost::geometry::index::intersects(box), std::back_inserter(near));
      unsigned int result = no_number;
      for (const std::size_t v : near)
        if (number[v] < result &&
            (vertices[number[v]] - point).norm_square() <= tolerance() * tolerance())
          result = number[v];
      if (result != no_number)
        return result;
      vertices.push_back(point);
      return static_cast<unsigned int>(vertices.size() - 1);
    };
    std::size_t n_without_extent = 0;
    for (const Facet &facet : list.facets)
    {
      Facet merged;
      bool has_extent = true;
      for (unsigned int k = 0; k < dim; ++k)
      {
        unsigned int &vertex_number = number[facet.vertex[k]];
        if (vertex_number == no_number)
          vertex_number = merged_number(list.vertices[facet.vertex[k]]);
        merged.vertex[k] = vertex_number;
        for (unsigned int other = 0; other < k; ++other)
          has_extent = has_extent && merged.vertex[other] != vertex_number;
      }
      if (has_extent)
        facets.push_back(merged);
      else
        ++n_without_extent;
    }
    if (n_without_extent > 0)
      remarks.push_back(std::to_string(n_without_extent) + " " + facets_text<dim> +
                        " were left out, because corners of them are at the same place.");
    if (facets.size() < dim + 1)
      throw std::invalid_argument("a body needs " + std::to_string(dim + 1) + " " +
                                  facets_text<dim> + " or more with extent; there are " +
                                  std::to_string(facets.size()));
  }

  template <int dim>
  void ClosedSurface<dim>::drop_unused_vertices()
  {
    std::vector<unsigned int> number(vertices.size(), no_number);
    std::vector<Tensor<1, dim>> used;
    for (Facet &facet : facets)
      for (unsigned int &v : facet.vertex)
      {
        if (number[v] == no_number)
        {
          number[v] = static_cast<unsigned int>(used.size());
          used.push_back(vertices[v]);
        }
        v = number[v];
      }
    vertices = std::move(used);
  }

  template <int dim>
  void ClosedSurface<dim>::measure_facets()
  {
    std::size_t n_without_area = 0, first = 0;
    for (std::size_t f = 0; f < facets.size(); ++f)
    {
      const double size = area_vector(f).norm();
      area += size;
      if constexpr (dim == 3)
      {
        double longest = 0;
        for (unsigned int k = 0; k < 3; ++k)
          longest = std::max(
              longest,
              (vertices[facets[f].vertex[(k + 1) % 3]] - vertices[facets[f].vertex[k]]).norm());
        const double height = 2. * size / longest;
        largest_slenderness = std::max(largest_slenderness, longest / height);
        if (!(height > tolerance()) && n_without_area++ == 0)
          first = f;
      }
    }
    if (n_without_area > 0)
      throw std::invalid_argument(
          std::to_string(n_without_area) +
          " triangles have no area, their corners being on a line; the first is at " +
          position_text(center(first)));
  }

  template <int dim>
  std::vector<typename ClosedSurface<dim>::Side> ClosedSurface<dim>::paired_sides() const
  {
    std::vector<Side> sides;
    sides.reserve(n_sides * facets.size());
    for (unsigned int f = 0; f < facets.size(); ++f)
      for (unsigned int k = 0; k < n_sides; ++k)
      {
        const unsigned int from = facets[f].vertex[k];
        const unsigned int to = dim == 2 ? from : facets[f].vertex[(k + 1) % dim];
        sides.push_back(
            {std::min(from, to), std::max(from, to), f, k, dim == 2 ? k == 0 : from < to});
      }
    std::sort(sides.begin(), sides.end(),
              [](const Side &a, const Side &b)
              {
                return std::tie(a.first, a.second, a.facet, a.number) <
                       std::tie(b.first, b.second, b.facet, b.number);
              });

    std::size_t n_open = 0, n_branching = 0;
    std::string first_open, first_branching;
    for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end)
    {
      while (end < sides.size() && sides[end].first == sides[begin].first &&
             sides[end].second == sides[begin].second)
        ++end;
      const std::string where =
          end - begin == 2
              ? ""
              : position_text(0.5 * (vertices[sides[begin].first] + vertices[sides[begin].second]));
      if (end - begin == 1 && n_open++ == 0)
        first_open = where;
      if (end - begin > 2 && n_branching++ == 0)
        first_branching = where;
    }
    const std::string which = dim == 2 ? " corners" : " edges";
    if (n_open > 0)
      throw std::invalid_argument("it is open: " + std::to_string(n_open) + which +
                                  " belong to one of the " + facets_text<dim> +
                                  " only; the first is at " + first_open);
    if (n_branching > 0)
      throw std::invalid_argument("it branches: " + std::to_string(n_branching) + which +
                                  " belong to more than two " + facets_text<dim> +
                                  "; the first is at " + first_branching);
    return sides;
  }

  template <int dim>
  std::vector<unsigned int> ClosedSurface<dim>::orient(const std::vector<Side> &sides)
  {
    struct Neighbour
    {
      unsigned int facet;
      bool disagrees;
    };
    std::vector<Neighbour> neighbours(sides.size());
    for (std::size_t i = 0; i < sides.size(); i += 2)
    {
      const Side &a = sides[i], &b = sides[i + 1];
      const bool disagrees = a.is_forward == b.is_forward;
      neighbours[n_sides * a.facet + a.number] = {b.facet, disagrees};
      neighbours[n_sides * b.facet + b.number] = {a.facet, disagrees};
    }

    std::vector<unsigned int> piece(facets.size(), no_number);
    std::vector<bool> is_turned(facets.size(), false);
    std::vector<unsigned int> front;
    std::size_t n_turned_in_all = 0;
    for (unsigned int start = 0; start < facets.size(); ++start)
    {
      if (piece[start] != no_number)
        continue;
      std::size_t n_facets = 0, n_turned = 0;
      front.assign(1, start);
      piece[start] = n_pieces;
      while (!front.empty())
      {
        const unsigned int f = front.back();
        front.pop_back();
        ++n_facets;
        n_turned += is_turned[f] ? 1 : 0;
        for (unsigned int k = 0; k < n_sides; ++k)
        {
          const auto [other, disagrees] = neighbours[n_sides * f + k];
          const bool turns = is_turned[f] != disagrees;
          if (piece[other] == no_number)
          {
            piece[other] = n_pieces;
            is_turned[other] = turns;
            front.push_back(other);
          }
          else if (is_turned[other] != turns)
            throw std::invalid_argument("it has no inside: its two sides are one, as those of a "
                                        "Möbius strip; seen at " +
                                        position_text(center(other)));
        }
      }
      n_turned_in_all += std::min(n_turned, n_facets - n_turned);
      ++n_pieces;
    }
    for (std::size_t f = 0; f < facets.size(); ++f)
      if (is_turned[f])
        turn(f);
    if (n_turned_in_all > 0)
      remarks.push_back(std::to_string(n_turned_in_all) + " " + facets_text<dim> +
                        " were turned round to agree with their neighbours.");
    return piece;
  }

  template <int dim>
  void ClosedSurface<dim>::turn_outwards(const std::vector<unsigned int> &piece_of_facet)
  {
    struct Piece
    {
      Tensor<1, dim> low, high, point;
      double volume = 0, area = 0;
      bool is_empty = true;
    };
    std::vector<Piece> pieces(n_pieces);
    const Tensor<1, dim> middle = 0.5 * (low + high);
    for (std::size_t f = 0; f < facets.size(); ++f)
    {
      Piece &piece = pieces[piece_of_facet[f]];
      if (piece.is_empty)
        piece.low = piece.high = piece.point = center(f);
      piece.is_empty = false;
      const Tensor<1, dim> area_of_facet = area_vector(f);
      piece.area += area_of_facet.norm();
      piece.volume += (center(f) - middle) * area_of_facet / dim;
      for (const unsigned int v : facets[f].vertex)
        widen_box(piece.low, piece.high, vertices[v]);
    }
    for (const Piece &piece : pieces)
    {
      if (!(std::abs(piece.volume) > tolerance() * piece.area))
        throw std::invalid_argument("it encloses nothing: the piece at " +
                                    position_text(piece.point) + " is flat");
      volume += piece.volume;
    }
    if (volume < 0.)
    {
      for (std::size_t f = 0; f < facets.size(); ++f)
        turn(f);
      for (Piece &piece : pieces)
        piece.volume = -piece.volume;
      volume = -volume;
      remarks.push_back("It was inside out and has been turned.");
    }
    const auto is_within = [](const Piece &inner, const Piece &outer)
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (!(outer.low[d] < inner.low[d] && inner.high[d] < outer.high[d]))
          return false;
      return outer.volume > -inner.volume;
    };
    constexpr unsigned int largest_number_of_pieces = 10000;
    if (n_pieces > largest_number_of_pieces)
      throw std::invalid_argument("it consists of " + std::to_string(n_pieces) +
                                  " pieces that are not connected; at most " +
                                  std::to_string(largest_number_of_pieces) + " are allowed");
    for (const Piece &piece : pieces)
      if (piece.volume < 0.)
      {
        ++n_cavities;
        if (std::none_of(pieces.begin(), pieces.end(),
                         [&](const Piece &outer) { return is_within(piece, outer); }))
          throw std::invalid_argument("its piece at " + position_text(piece.point) +
                                      " is inside out, while others are not");
      }
  }

  template <int dim>
  void ClosedSurface<dim>::refuse_common_points_of_fans(const std::vector<Side> &sides) const
  {
    if constexpr (dim == 3)
    {
      // The corners of facets at a vertex are one set if ways across edges lead through all.
      boost::disjoint_sets_with_storage<> sets(dim * facets.size());
      const auto corner = [&](const unsigned int facet, const unsigned int vertex)
      {
        unsigned int k = 0;
        while (facets[facet].vertex[k] != vertex)
          ++k;
        return dim * facet + k;
      };
      for (std::size_t i = 0; i < sides.size(); i += 2)
        for (const unsigned int vertex : {sides[i].first, sides[i].second})
          sets.union_set(corner(sides[i].facet, vertex), corner(sides[i + 1].facet, vertex));
      std::vector<std::size_t> set_of_vertex(vertices.size(), no_number);
      for (unsigned int c = 0; c < dim * facets.size(); ++c)
      {
        std::size_t &vertex_set = set_of_vertex[facets[c / dim].vertex[c % dim]];
        if (vertex_set == no_number)
          vertex_set = sets.find_set(c);
        else if (vertex_set != sets.find_set(c))
          throw std::invalid_argument("it touches itself in the point " +
                                      position_text(vertices[facets[c / dim].vertex[c % dim]]));
      }
    }
  }

  template <int dim>
  void ClosedSurface<dim>::number_edges(const std::vector<Side> &sides)
  {
    if constexpr (dim == 3)
    {
      ends_of_edges.resize(sides.size() / 2);
      edges.resize(n_sides * facets.size());
      for (std::size_t i = 0; i < sides.size(); i += 2)
      {
        const auto edge = static_cast<unsigned int>(i / 2);
        ends_of_edges[edge] = {{sides[i].first, sides[i].second}};
        for (const Side &side : {sides[i], sides[i + 1]})
          for (unsigned int k = 0; k < 3; ++k)
          {
            // Facets may have been turned since the sides were numbered.
            const auto &v = facets[side.facet].vertex;
            if (std::min(v[k], v[(k + 1) % 3]) == side.first &&
                std::max(v[k], v[(k + 1) % 3]) == side.second)
              edges[n_sides * side.facet + k] = edge;
          }
      }
    }
  }

  template class ClosedSurface<2>;
  template class ClosedSurface<3>;
} // namespace tombolo
