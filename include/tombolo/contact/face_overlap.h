// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/contact/contact_faces.h>

#include <deal.II/base/tensor.h>

#include <array>

namespace tombolo
{
  /**
   * Quadrature points of the common part of a slave face and master faces, all projected onto the
   * plane through the centre of the slave face with the direction of its area (in two dimensions
   * onto its line). The projected master face is clipped by the edges of the slave face (Sutherland
   * and Hodgman), the polygon divided into triangles from its corner farthest from the centre of
   * its area, and each has 6 points of the rule of degree 4, so that the numbering of corners does
   * not matter, and weights are exact where both faces are parallelograms; in two dimensions an
   * interval has 2 Gauss points. Both faces have their shape functions at the same points, so that
   * Σ_J w^s_IJ = Σ_L w^m_IL for the weights of a mortar. Weights are areas on the plane.
   */
  template <int dim>
  class FaceOverlap
  {
  public:
    static constexpr unsigned int n_corners = 1u << (dim - 1);

    /** The slave face must be convex on the plane. */
    explicit FaceOverlap(const FaceCorners<dim> &slave);

    /** Finds the points in common with @p master; none where the projections do not overlap. */
    void find(const FaceCorners<dim> &master);

    unsigned int n_points() const
    {
      return n;
    }

    /** By point, up to whole Lanes, with the weight zero behind n_points(): weights of the
     * quadrature [L^(dim-1)], and N of both faces by corner. */
    const double *weights() const
    {
      return weight;
    }
    const double *of_slave(const unsigned int corner) const
    {
      return slave_shape[corner];
    }
    const double *of_master(const unsigned int corner) const
    {
      return master_shape[corner];
    }

  private:
    using PlanePoint = std::array<double, dim - 1>;
    using PlaneFace = std::array<PlanePoint, n_corners>;

    PlaneFace on_plane(const FaceCorners<dim> &face) const
    {
      PlaneFace result;
      for (unsigned int k = 0; k < n_corners; ++k)
        for (unsigned int a = 0; a < dim - 1; ++a)
          result[k][a] = (face[k] - origin) * axes[a];
      return result;
    }
    void find_points(const PlaneFace &master);

    /** Two quadrilaterals of which one is convex have 12 corners in common at most. */
    static constexpr unsigned int max_corners = 16;
    static constexpr unsigned int max_points =
        padded_to_lanes(dim == 2 ? 2 : 6 * (max_corners - 2));

    dealii::Tensor<1, dim> origin;
    std::array<dealii::Tensor<1, dim>, dim - 1> axes;
    PlaneFace slave;
    unsigned int n = 0;
    double weight[max_points];
    double slave_shape[n_corners][max_points], master_shape[n_corners][max_points];
  };
} // namespace tombolo
