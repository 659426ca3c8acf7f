// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/base/format.h>
#include <tombolo/contact/surfaces/facet_tree.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace tombolo
{
  /**
   * A rigid body by its closed surface of facets, with convex edges and corners rounded: the body
   * is what balls of the edge radius R sweep that roll inside of the surface.
   *
   * The normal of a point inside of the body jumps where it passes from below one facet to below
   * another, if the edge between them is sharp and convex. The centres of the balls fill a smaller
   * body, of all points at least R below the surface; a point nearer to the surface than R is
   * |x - c| - R below the rounded one, where c is the nearest of the centres, and x - c is the
   * normal. Both are continuous down to the depth R, at convex edges, where the balls round the
   * body, as at concave ones, where they follow the surface. The point c is found by projection: a
   * facet, edge or corner that is nearer to it than R pushes it back by a half space, until none
   * is.
   */
  template <int dim>
  class RigidMesh
  {
  public:
    /** The signed distance, positive outside [L], and the unit normal out of the body. */
    struct Nearest
    {
      double gap;
      dealii::Tensor<1, dim> normal;
    };

    RigidMesh() = default;

    /** Throws std::invalid_argument where the surface crosses itself, or where a ball of the radius
     * does not fit into the body below a facet. */
    RigidMesh(const ClosedSurface<dim> &surface, const double edge_radius)
        : sharp_surface(surface), radius(edge_radius)
    {
      if (const auto crossing = sharp_surface.find_crossing())
        throw std::invalid_argument("it passes through itself at " + position_text(*crossing) +
                                    "; join its pieces, or make a contact of each");
      fill_voxels();
      if (!(radius > 0.))
        return;
      for (std::size_t f = 0; f < sharp_surface.facets.size(); ++f)
      {
        SurfaceGap<dim> sharp{};
        for (const unsigned int v : sharp_surface.facets[f].vertex)
          sharp.point += sharp_surface.vertices[v] / dim;
        sharp.normal = sharp_surface.facet_normals[f];
        sharp.feature = Feature::facet;
        sharp.number = static_cast<unsigned int>(f);
        dealii::Tensor<1, dim> center;
        if (find_center(sharp.point, sharp, center))
          continue;
        throw std::invalid_argument(as_text(
            "an edge radius of ", radius, " does not fit below the surface at ",
            position_text(sharp.point), ", where the body is thinner than a ball of this radius"));
      }
    }

    /** Points outside up to this distance [L] have their distance to the rounded surface, too. */
    void set_reach(double distance)
    {
      reach = distance;
    }

    /** Points outside of the sharp surface, beyond the reach, have their distance to that, which is
     * not more than the one to the rounded one. */
    Nearest nearest(const dealii::Tensor<1, dim> &point) const
    {
      dealii::Tensor<1, dim> middle;
      const SurfaceGap<dim> sharp = sharp_surface.gap(point, voxels[voxel_at(point, middle)].hint);
      if (!(sharp.gap < reach) || !(sharp.gap > -radius) || radius == 0.)
        return {sharp.gap, sharp.normal};
      dealii::Tensor<1, dim> center;
      if (!find_center(point, sharp, center))
        return {sharp.gap, sharp.normal};
      const dealii::Tensor<1, dim> away = point - center;
      const double distance = away.norm();
      // As deep as the radius the way from the centre has no direction.
      if (!(distance > 1e-9 * radius))
        return {sharp.gap, sharp.normal};
      return {distance - radius, away / distance};
    }

    /** The gap of nearest(), if it is below the reach (zero, if that is not set); else a larger
     * number that is at most the gap, and cheap where the point is not next to the surface. */
    double gap_or_less(const dealii::Tensor<1, dim> &point) const
    {
      const double square = distance_square_to_box(sharp_surface.low, sharp_surface.high, point);
      if (!(square <= reach * reach)) // nor is what is not a number near the box
        return std::sqrt(square);
      dealii::Tensor<1, dim> middle;
      const double middle_gap = voxels[voxel_at(point, middle)].gap;
      const double at_least = middle_gap - (point - middle).norm();
      return at_least > reach ? at_least : nearest(point).gap;
    }

    /** The surface without rounding. */
    const ClosedSurface<dim> &surface() const
    {
      return sharp_surface;
    }

  private:
    using Feature = typename FacetTree<dim>::Feature;

    /** Points with normal * x <= offset, the constraint on centres by a feature of the surface. */
    struct HalfSpace
    {
      dealii::Tensor<1, dim> normal;
      double offset;
      Feature feature;
      unsigned int number;
    };

    /** The half spaces that hold a centre where it is: not more than dim, and another. */
    struct HalfSpaces
    {
      HalfSpace member[dim + 1];
      unsigned int n = 0;
    };

    /** Turns the half space of an edge or a corner to @p center. Returns whether it is one. */
    bool turn(HalfSpace &space, const dealii::Tensor<1, dim> &center) const
    {
      if (space.feature == Feature::facet)
        return false;
      dealii::Tensor<1, dim> nearest_point;
      if (space.feature == Feature::vertex)
        nearest_point = sharp_surface.vertices[space.number];
      else
      {
        const auto &ends = sharp_surface.ends_of_edges[space.number].vertex;
        const dealii::Tensor<1, dim> &begin = sharp_surface.vertices[ends[0]];
        const dealii::Tensor<1, dim> along = sharp_surface.vertices[ends[1]] - begin;
        const double t = (center - begin) * along / along.norm_square();
        nearest_point = begin + std::clamp(t, 0., 1.) * along;
      }
      const dealii::Tensor<1, dim> away = nearest_point - center;
      const double distance = away.norm();
      if (!(away * space.normal > 0.5 * distance))
        return false;
      space.normal = away / distance;
      space.offset = space.normal * nearest_point - radius;
      return true;
    }

    /** The multipliers of chosen half spaces, as planes. Returns false where their normals depend
     * on each other. */
    static bool solve(const HalfSpaces &spaces, const unsigned int *const chosen,
                      const unsigned int n, const dealii::Tensor<1, dim> &point,
                      double *const multiplier)
    {
      double matrix[dim][dim + 1];
      for (unsigned int i = 0; i < n; ++i)
      {
        const HalfSpace &space = spaces.member[chosen[i]];
        for (unsigned int j = 0; j < n; ++j)
          matrix[i][j] = space.normal * spaces.member[chosen[j]].normal;
        matrix[i][n] = space.normal * point - space.offset;
      }
      // Symmetric and positive: no pivoting is needed.
      for (unsigned int i = 0; i < n; ++i)
      {
        if (!(matrix[i][i] > 1e-12))
          return false;
        for (unsigned int row = i + 1; row < n; ++row)
        {
          const double factor = matrix[row][i] / matrix[i][i];
          for (unsigned int j = i; j <= n; ++j)
            matrix[row][j] -= factor * matrix[i][j];
        }
      }
      for (unsigned int i = n; i-- > 0;)
      {
        multiplier[i] = matrix[i][n];
        for (unsigned int j = i + 1; j < n; ++j)
          multiplier[i] -= matrix[i][j] * multiplier[j];
        multiplier[i] /= matrix[i][i];
      }
      return true;
    }

    /** The point next to @p point in all half spaces; drops those that do not hold it. Returns
     * false where there is no such point. */
    static bool project(HalfSpaces &spaces, const dealii::Tensor<1, dim> &point,
                        const double tolerance, dealii::Tensor<1, dim> &result)
    {
      for (unsigned int subset = 1; subset < (1u << spaces.n); ++subset)
      {
        unsigned int chosen[dim + 1] = {}, n = 0;
        for (unsigned int i = 0; i < spaces.n; ++i)
          if ((subset >> i) & 1u)
            chosen[n++] = i;
        double multiplier[dim] = {};
        if (n > dim || !solve(spaces, chosen, n, point, multiplier))
          continue;
        bool is_right = true;
        result = point;
        for (unsigned int i = 0; i < n; ++i)
        {
          is_right = is_right && multiplier[i] >= 0.;
          result -= multiplier[i] * spaces.member[chosen[i]].normal;
        }
        for (unsigned int i = 0; i < spaces.n; ++i)
          is_right =
              is_right && spaces.member[i].normal * result <= spaces.member[i].offset + tolerance;
        if (!is_right)
          continue;
        HalfSpaces kept;
        for (unsigned int i = 0; i < n; ++i)
          kept.member[kept.n++] = spaces.member[chosen[i]];
        spaces = kept;
        return true;
      }
      return false;
    }

    /** The centre of a ball next to @p point, which is nearer to the sharp surface (at @p sharp)
     * than the radius, or outside and nearer than the reach. Returns whether there is one. */
    bool find_center(const dealii::Tensor<1, dim> &point, const SurfaceGap<dim> &sharp,
                     dealii::Tensor<1, dim> &center) const
    {
      // Enough for a ball that touches many small facets, which come one after another.
      constexpr unsigned int most_tries = 50;
      const double tolerance = 1e-10 * radius, smallest_step = 1e-8 * radius;
      HalfSpaces spaces;
      SurfaceGap<dim> nearest = sharp;
      center = point;
      if (sharp.gap >= 0.)
      {
        // Balls touch the facets from inside: a convex edge that is next to the point holds none.
        center = sharp.point - 0.5 * radius * sharp.normal;
        nearest = sharp_surface.gap(center, sharp.hint);
      }
      for (unsigned int i = 0; i < most_tries; ++i)
      {
        bool has_turned = false;
        if (spaces.n > 1)
          for (unsigned int k = 0; k < spaces.n; ++k)
            has_turned = turn(spaces.member[k], center) || has_turned;
        if (nearest.gap > -radius + tolerance)
        {
          unsigned int n_kept = 0;
          for (unsigned int k = 0; k < spaces.n; ++k)
            if (spaces.member[k].feature != nearest.feature ||
                spaces.member[k].number != nearest.number)
              spaces.member[n_kept++] = spaces.member[k];
          spaces.member[n_kept] = {nearest.normal, nearest.normal * nearest.point - radius,
                                   nearest.feature, nearest.number};
          spaces.n = n_kept + 1;
        }
        else if (!has_turned)
          return true;
        const dealii::Tensor<1, dim> before = center;
        if (!project(spaces, point, tolerance, center))
          return false;
        nearest = sharp_surface.gap(center, nearest.hint);
        if (nearest.gap <= -radius + smallest_step && (center - before).norm() <= smallest_step)
          return true;
      }
      return nearest.gap < -0.99 * radius;
    }

    /** The middle of a part of the box around the body. */
    struct Voxel
    {
      double gap = 0; ///< to the sharp surface [L]
      unsigned int hint = 0;
    };
    void fill_voxels()
    {
      // As many as facets have it on the whole, so that loading costs what the facets cost.
      const double target =
          std::clamp(4. * static_cast<double>(sharp_surface.facets.size()), 4096., 262144.);
      const dealii::Tensor<1, dim> extent = sharp_surface.high - sharp_surface.low;
      double size = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        size *= std::pow(extent[d] / target, 1. / dim);
      size *= std::pow(target, 1. - 1. / dim);
      std::size_t n = 1;
      for (unsigned int d = 0; d < dim; ++d)
      {
        n_voxels[d] = static_cast<unsigned int>(std::clamp(extent[d] / size, 1., 1000.));
        voxel_size[d] = extent[d] / n_voxels[d];
        n *= n_voxels[d];
      }
      std::vector<Voxel> filled(n);
      unsigned int hint = 0;
      for (std::size_t i = 0; i < n; ++i)
      {
        dealii::Tensor<1, dim> middle = sharp_surface.low;
        std::size_t rest = i;
        for (unsigned int d = 0; d < dim; ++d)
        {
          middle[d] += (0.5 + static_cast<double>(rest % n_voxels[d])) * voxel_size[d];
          rest /= n_voxels[d];
        }
        const SurfaceGap<dim> nearest = sharp_surface.gap(middle, hint);
        filled[i] = {nearest.gap, nearest.hint};
        hint = nearest.hint;
      }
      voxels = std::move(filled);
    }

    /** The number of the voxel next to a point, and the middle of it. */
    std::size_t voxel_at(const dealii::Tensor<1, dim> &point, dealii::Tensor<1, dim> &middle) const
    {
      std::size_t number = 0;
      for (unsigned int d = dim; d-- > 0;)
      {
        const double coordinate = (point[d] - sharp_surface.low[d]) / voxel_size[d];
        const auto along = static_cast<unsigned int>(
            std::clamp(coordinate, 0., static_cast<double>(n_voxels[d] - 1)));
        middle[d] = sharp_surface.low[d] + (0.5 + along) * voxel_size[d];
        number = number * n_voxels[d] + along;
      }
      return number;
    }

    SearchedSurface<dim> sharp_surface;
    std::vector<Voxel> voxels; ///< in the order of x, then y, then z
    unsigned int n_voxels[dim] = {};
    dealii::Tensor<1, dim> voxel_size;
    double radius = 0, reach = 0;
  };
} // namespace tombolo
