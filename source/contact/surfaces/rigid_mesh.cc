// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/contact/surfaces/rigid_mesh.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  RigidMesh<dim>::RigidMesh(const ClosedSurface<dim> &surface, const double edge_radius)
      : sharp_surface(surface), radius(edge_radius)
  {
    if (const auto crossing = sharp_surface.find_crossing())
      throw std::invalid_argument("it passes through itself at " + place_text(*crossing) +
                                  "; join its pieces, or make a contact of each");
    fill_voxels();
    if (!(radius > 0.))
      return;
    for (std::size_t f = 0; f < sharp_surface.facets.size(); ++f)
    {
      SurfaceGap<dim> sharp{};
      for (const unsigned int v : sharp_surface.facets[f].vertex)
        sharp.place += sharp_surface.vertices[v] / dim;
      sharp.normal = sharp_surface.facet_normals[f];
      sharp.feature = Feature::facet;
      sharp.number = static_cast<unsigned int>(f);
      Tensor<1, dim> center;
      if (find_center(sharp.place, sharp, center))
        continue;
      throw std::invalid_argument(as_text(
          "an edge radius of ", radius, " does not fit below the surface at ",
          place_text(sharp.place), ", where the body is thinner than a ball of this radius"));
    }
  }

  template <int dim>
  bool RigidMesh<dim>::solve(const HalfSpaces &spaces, const unsigned int *const chosen,
                             const unsigned int n, const Tensor<1, dim> &point,
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

  template <int dim>
  bool RigidMesh<dim>::project(HalfSpaces &spaces, const Tensor<1, dim> &point,
                               const double tolerance, Tensor<1, dim> &result)
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

  template <int dim>
  bool RigidMesh<dim>::turn(HalfSpace &space, const Tensor<1, dim> &center) const
  {
    if (space.feature == Feature::facet)
      return false;
    Tensor<1, dim> place;
    if (space.feature == Feature::vertex)
      place = sharp_surface.vertices[space.number];
    else
    {
      const auto &ends = sharp_surface.ends_of_edges[space.number].vertex;
      const Tensor<1, dim> &begin = sharp_surface.vertices[ends[0]];
      const Tensor<1, dim> along = sharp_surface.vertices[ends[1]] - begin;
      const double t = (center - begin) * along / along.norm_square();
      place = begin + std::clamp(t, 0., 1.) * along;
    }
    const Tensor<1, dim> away = place - center;
    const double distance = away.norm();
    if (!(away * space.normal > 0.5 * distance))
      return false;
    space.normal = away / distance;
    space.offset = space.normal * place - radius;
    return true;
  }

  template <int dim>
  bool RigidMesh<dim>::find_center(const Tensor<1, dim> &point, const SurfaceGap<dim> &sharp,
                                   Tensor<1, dim> &center) const
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
      center = sharp.place - 0.5 * radius * sharp.normal;
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
        spaces.member[n_kept] = {nearest.normal, nearest.normal * nearest.place - radius,
                                 nearest.feature, nearest.number};
        spaces.n = n_kept + 1;
      }
      else if (!has_turned)
        return true;
      const Tensor<1, dim> before = center;
      if (!project(spaces, point, tolerance, center))
        return false;
      nearest = sharp_surface.gap(center, nearest.hint);
      if (nearest.gap <= -radius + smallest_step && (center - before).norm() <= smallest_step)
        return true;
    }
    return nearest.gap < -0.99 * radius;
  }

  template <int dim>
  typename RigidMesh<dim>::Nearest RigidMesh<dim>::nearest(const Tensor<1, dim> &point) const
  {
    Tensor<1, dim> middle;
    const SurfaceGap<dim> sharp = sharp_surface.gap(point, voxels[voxel_at(point, middle)].hint);
    if (!(sharp.gap < reach) || !(sharp.gap > -radius) || radius == 0.)
      return {sharp.gap, sharp.normal};
    Tensor<1, dim> center;
    if (!find_center(point, sharp, center))
      return {sharp.gap, sharp.normal};
    const Tensor<1, dim> away = point - center;
    const double distance = away.norm();
    // As deep as the radius the way from the centre has no direction.
    if (!(distance > 1e-9 * radius))
      return {sharp.gap, sharp.normal};
    return {distance - radius, away / distance};
  }

  template <int dim>
  void RigidMesh<dim>::fill_voxels()
  {
    // As many as facets have it on the whole, so that loading costs what the facets cost.
    const double wanted =
        std::clamp(4. * static_cast<double>(sharp_surface.facets.size()), 4096., 262144.);
    const Tensor<1, dim> extent = sharp_surface.high - sharp_surface.low;
    double size = 1.;
    for (unsigned int d = 0; d < dim; ++d)
      size *= std::pow(extent[d] / wanted, 1. / dim);
    size *= std::pow(wanted, 1. - 1. / dim);
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
      Tensor<1, dim> middle = sharp_surface.low;
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

  template <int dim>
  std::size_t RigidMesh<dim>::voxel_at(const Tensor<1, dim> &point, Tensor<1, dim> &middle) const
  {
    std::size_t number = 0;
    for (unsigned int d = dim; d-- > 0;)
    {
      const double place = (point[d] - sharp_surface.low[d]) / voxel_size[d];
      const auto along =
          static_cast<unsigned int>(std::clamp(place, 0., static_cast<double>(n_voxels[d] - 1)));
      middle[d] = sharp_surface.low[d] + (0.5 + along) * voxel_size[d];
      number = number * n_voxels[d] + along;
    }
    return number;
  }

  template <int dim>
  double RigidMesh<dim>::gap_or_less(const Tensor<1, dim> &point) const
  {
    const double square = distance_square_to_box(sharp_surface.low, sharp_surface.high, point);
    if (!(square <= reach * reach)) // nor is what is not a number near the box
      return std::sqrt(square);
    Tensor<1, dim> middle;
    const double of_middle = voxels[voxel_at(point, middle)].gap;
    const double at_least = of_middle - (point - middle).norm();
    return at_least > reach ? at_least : nearest(point).gap;
  }

  template class RigidMesh<2>;
  template class RigidMesh<3>;
} // namespace tombolo
