// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The outline of a rigid body in the half-plane of (r, z): r the distance from the body's axis, z
   * along it. Turned about the axis it is a body of revolution, mirrored a body in two dimensions.
   * It leads from the axis around the body and back to the axis, the body to its left, in straight
   * lines whose convex corners are rounded by arcs.
   *
   * Nodes in contact are inside of the body, where the point next to them jumps from one side to
   * the other as they pass under a sharp convex corner. Under an arc of radius R the normal turns
   * with the node down to a depth of R, so that its force is continuous; under a concave corner it
   * always does.
   */
  class RigidProfile
  {
  public:
    /** A point, or a direction. */
    struct Point
    {
      double r, z; ///< [L]
    };

    /** The signed distance, positive outside [L], and the unit normal out of the body. */
    struct Nearest
    {
      double gap;
      Point normal;
    };

    RigidProfile() = default;

    /** @p corners from the axis to the axis (r = 0 at the first and the last, above zero between
     * them). Convex corners, those on the axis too, are rounded with @p edge_radius. Throws
     * std::invalid_argument with what is wrong with the corners, or with a radius that the lines
     * between corners are too short for. */
    RigidProfile(const std::vector<Point> &corners, const double edge_radius) : radius(edge_radius)
    {
      check(corners, edge_radius);
      refuse_crossing_sides(corners);
      const std::size_t n_sides = corners.size() - 1;
      std::vector<double> free_length(n_sides);
      for (std::size_t i = 0; i < n_sides; ++i)
      {
        Line line;
        const Point side = difference(corners[i + 1], corners[i]);
        line.begin = corners[i];
        line.length = free_length[i] = length(side);
        line.along = unit(side);
        line.normal = {line.along.z, -line.along.r};
        line.normal_at_begin = line.normal_at_end = line.normal;
        lines.push_back(line);
      }
      low = high = corners.front();
      for (const Point &corner : corners)
      {
        low = {std::min(low.r, corner.r), std::min(low.z, corner.z)};
        high = {std::max(high.r, corner.r), std::max(high.z, corner.z)};
      }

      for (std::size_t i = 0; i <= n_sides; ++i)
      {
        // Beyond the axis the profile goes on as its mirror image.
        const auto mirrored = [](const Point &along) -> Point { return {along.r, -along.z}; };
        const Point before = i == 0 ? mirrored(lines[0].along) : lines[i - 1].along;
        const Point after = i == n_sides ? mirrored(lines[n_sides - 1].along) : lines[i].along;
        const Point normal_before = {before.z, -before.r}, normal_after = {after.z, -after.r};
        const double turn = std::atan2(cross(before, after), dot(before, after));
        if (!(turn > 1e-12))
        {
          const Point mean = {normal_before.r + normal_after.r, normal_before.z + normal_after.z};
          if (!(length(mean) > 1e-9))
            throw std::invalid_argument("the profile turns back at " + text_of(corners[i]));
          if (i > 0)
            lines[i - 1].normal_at_end = unit(mean);
          if (i < n_sides)
            lines[i].normal_at_begin = unit(mean);
          continue;
        }
        const double cut = radius * std::tan(0.5 * turn);
        const auto shorten = [&](const std::size_t side)
        {
          free_length[side] -= cut;
          if (free_length[side] < -1e-12 * length(difference(high, low)))
            throw std::invalid_argument("an edge radius of " + std::to_string(radius) +
                                        " does not fit between the corners at " +
                                        text_of(corners[side]) + " and " +
                                        text_of(corners[side + 1]));
          lines[side].length = std::max(0., lines[side].length - cut);
        };
        if (i > 0)
          shorten(i - 1);
        if (i < n_sides)
        {
          shorten(i);
          lines[i].begin = moved(lines[i].begin, cut, lines[i].along);
        }
        const Point tangent_point = moved(corners[i], -cut, before);
        arcs.push_back(
            {moved(tangent_point, -radius, normal_before), normal_before, normal_after, i});
      }
    }

    /** @p point with r >= 0. */
    Nearest nearest(const Point &point) const
    {
      Nearest result = {std::numeric_limits<double>::max(), {0., 1.}};
      const auto consider = [&](const double distance, const Point &away, const Point &outward)
      {
        if (!(distance < std::abs(result.gap)))
          return;
        const double sign = dot(away, outward) < 0. ? -1. : 1.;
        // On the surface itself the way to it has no direction.
        const bool is_on_it = distance < 1e-12 * (high.z - low.z);
        result.gap = sign * distance;
        result.normal =
            is_on_it ? outward : Point{sign * away.r / distance, sign * away.z / distance};
      };
      for (const Line &line : lines)
      {
        const Point from_begin = difference(point, line.begin);
        const double s = dot(from_begin, line.along);
        const double clamped = std::clamp(s, 0., line.length);
        const Point away = moved(from_begin, -clamped, line.along);
        consider(length(away), away,
                 s <= 0.            ? line.normal_at_begin
                 : s >= line.length ? line.normal_at_end
                                    : line.normal);
      }
      for (const Arc &arc : arcs)
      {
        const Point from_center = difference(point, arc.center);
        const double distance = length(from_center);
        if (!(distance > 0.) || cross(arc.first_normal, from_center) < 0. ||
            cross(from_center, arc.last_normal) < 0.)
          continue;
        const Point outward = unit(from_center);
        const double gap = distance - radius;
        consider(std::abs(gap), {gap * outward.r, gap * outward.z}, outward);
      }
      return result;
    }

    /** At most the distance to the body, positive only outside of a cylinder around it: cheap. */
    double distance_from_box(const Point &point) const
    {
      return std::max({point.r - high.r, low.z - point.z, point.z - high.z});
    }

    /** Points along the profile from the axis to the axis, for pictures: ends of the lines, and
     * arcs in pieces of at most @p largest_turn [rad]. */
    std::vector<Point> outline(const double largest_turn) const
    {
      std::vector<Point> result;
      const double tolerance = 1e-9 * length(difference(high, low));
      const auto add = [&](const Point &point)
      {
        if (point.r < -tolerance) // an arc on the axis goes on beyond it
          return;
        const Point on_this_side = {point.r > tolerance ? point.r : 0., point.z};
        if (result.empty() || length(difference(on_this_side, result.back())) > tolerance)
          result.push_back(on_this_side);
      };
      for (std::size_t i = 0; i <= lines.size(); ++i)
      {
        for (const Arc &arc : arcs)
          if (arc.next_line == i)
          {
            const double turn = std::atan2(cross(arc.first_normal, arc.last_normal),
                                           dot(arc.first_normal, arc.last_normal));
            // An even number, so that an arc across the axis has a point on it.
            const unsigned int n =
                2 * static_cast<unsigned int>(std::ceil(0.5 * turn / largest_turn));
            for (unsigned int k = 0; k <= n; ++k)
            {
              const double angle = turn * k / n, cosine = std::cos(angle), sine = std::sin(angle);
              const Point &from = arc.first_normal;
              add(moved(arc.center, radius,
                        {cosine * from.r - sine * from.z, sine * from.r + cosine * from.z}));
            }
          }
        if (i == lines.size())
          break;
        add(lines[i].begin);
        add(moved(lines[i].begin, lines[i].length, lines[i].along));
      }
      return result;
    }

  private:
    struct Line
    {
      Point begin, along, normal; ///< unit vectors
      double length;
      Point normal_at_begin, normal_at_end; ///< where two lines meet: the mean of theirs
    };
    struct Arc
    {
      Point center, first_normal, last_normal;
      std::size_t next_line; ///< the number of lines before it
    };

    static Point difference(const Point &a, const Point &b)
    {
      return {a.r - b.r, a.z - b.z};
    }

    static Point moved(const Point &from, const double factor, const Point &along)
    {
      return {from.r + factor * along.r, from.z + factor * along.z};
    }

    static double dot(const Point &a, const Point &b)
    {
      return a.r * b.r + a.z * b.z;
    }

    /** Positive where b turns left from a. */
    static double cross(const Point &a, const Point &b)
    {
      return a.r * b.z - a.z * b.r;
    }

    static double length(const Point &a)
    {
      return std::sqrt(dot(a, a));
    }

    static Point unit(const Point &a)
    {
      const double size = length(a);
      return {a.r / size, a.z / size};
    }

    static std::string text_of(const Point &corner)
    {
      return as_text("(", corner.r, ", ", corner.z, ")");
    }

    static void check(const std::vector<Point> &corners, const double edge_radius)
    {
      if (corners.size() < 3)
        throw std::invalid_argument("a profile needs three corners or more");
      for (const Point &corner : corners)
        if (!std::isfinite(corner.r) || !std::isfinite(corner.z))
          throw std::invalid_argument("the corner " + text_of(corner) + " is not finite");
      for (const Point &end : {corners.front(), corners.back()})
        if (end.r != 0.)
          throw std::invalid_argument("the profile must begin and end on the axis, r = 0, not at " +
                                      text_of(end));
      double area = 0;
      for (std::size_t i = 0; i < corners.size(); ++i)
      {
        if (i > 0 && i + 1 < corners.size() && !(corners[i].r > 0.))
          throw std::invalid_argument("r must be above 0 between the ends, not at " +
                                      text_of(corners[i]));
        const Point &next = corners[(i + 1) % corners.size()];
        if (corners[i].r == next.r && corners[i].z == next.z)
          throw std::invalid_argument("the corner " + text_of(next) + " is there twice in a row");
        area += 0.5 * cross(corners[i], next);
      }
      if (!(area > 0.))
        throw std::invalid_argument("the body must be to the left of the profile: turn the order "
                                    "of the corners around");
      if (!(edge_radius >= 0. && std::isfinite(edge_radius)))
        throw std::invalid_argument("the edge radius must be zero or a positive number");
    }

    /** Whether two sides cross, other than neighbours in their common corner. */
    static void refuse_crossing_sides(const std::vector<Point> &corners)
    {
      for (std::size_t i = 0; i + 1 < corners.size(); ++i)
        for (std::size_t j = i + 2; j + 1 < corners.size(); ++j)
        {
          const Point a = difference(corners[i + 1], corners[i]);
          const Point b = difference(corners[j + 1], corners[j]);
          const Point between = difference(corners[j], corners[i]);
          const double determinant = cross(a, b);
          if (determinant == 0.)
            continue;
          const double s = cross(between, b) / determinant;
          const double t = cross(between, a) / determinant;
          if (s >= 0. && s <= 1. && t >= 0. && t <= 1.)
            throw std::invalid_argument("the sides from " + text_of(corners[i]) + " and from " +
                                        text_of(corners[j]) + " cross");
        }
    }

    std::vector<Line> lines;
    std::vector<Arc> arcs;
    double radius = 0; ///< of the arcs
    Point low{}, high{};
  };
} // namespace tombolo
