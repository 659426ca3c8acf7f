// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/contact/surfaces/facet_tree.h>

#include <cstddef>
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
    RigidMesh(const ClosedSurface<dim> &surface, double edge_radius);

    /** From now on points outside of the body up to this distance [L] get their distance to the
     * rounded surface, too. */
    void set_reach(double distance)
    {
      reach = distance;
    }

    /** Points outside of the sharp surface, beyond the reach, get their distance to that, which is
     * not more than the one to the rounded one. */
    Nearest nearest(const dealii::Tensor<1, dim> &point) const;

    /** The gap of nearest(), if it is below the reach (zero, if that is not set); else a larger
     * number that is at most the gap, and cheap where the point is not next to the surface. */
    double gap_or_less(const dealii::Tensor<1, dim> &point) const;

    /** The surface without rounding. */
    const ClosedSurface<dim> &surface() const
    {
      return sharp_surface;
    }

  private:
    using Feature = typename FacetTree<dim>::Feature;

    /** Points with normal * x <= offset, as a feature of the surface asks of centres. */
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
    bool turn(HalfSpace &space, const dealii::Tensor<1, dim> &center) const;

    /** The multipliers of chosen half spaces, taken as planes. Returns false where their normals
     * depend on each other. */
    static bool solve(const HalfSpaces &spaces, const unsigned int *chosen, unsigned int n,
                      const dealii::Tensor<1, dim> &point, double *multiplier);
    /** The point next to @p point in all half spaces; drops those that do not hold it. Returns
     * false where there is no such point. */
    static bool project(HalfSpaces &spaces, const dealii::Tensor<1, dim> &point, double tolerance,
                        dealii::Tensor<1, dim> &result);

    /** The centre of a ball next to @p point, which is nearer to the sharp surface than the radius,
     * or outside and nearer than the reach. @p sharp is its nearest place there. Returns whether
     * there is one. */
    bool find_center(const dealii::Tensor<1, dim> &point, const SurfaceGap<dim> &sharp,
                     dealii::Tensor<1, dim> &center) const;

    /** What is known of the middle of a part of the box around the body. */
    struct Voxel
    {
      double gap = 0; ///< to the sharp surface [L]
      unsigned int hint = 0;
    };
    void fill_voxels();
    /** The number of the voxel next to a point, and the middle of it. */
    std::size_t voxel_at(const dealii::Tensor<1, dim> &point, dealii::Tensor<1, dim> &middle) const;

    SearchedSurface<dim> sharp_surface;
    std::vector<Voxel> voxels; ///< in the order of x, then y, then z
    unsigned int n_voxels[dim] = {};
    dealii::Tensor<1, dim> voxel_size;
    double radius = 0, reach = 0;
  };
} // namespace tombolo
