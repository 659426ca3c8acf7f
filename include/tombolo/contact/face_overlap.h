// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <array>
#include <vector>

namespace tombolo
{
  /** Corners of a face of a cell of degree 1, in lexicographic order. */
  template <int dim>
  using FaceCorners = std::array<dealii::Tensor<1, dim>, (1u << (dim - 1))>;

  /** The area of a face with its direction, ∫ n dA [L^(dim-1)]: that of the product of the
   * tangents, as FaceShapes::normal() has it. */
  template <int dim>
  dealii::Tensor<1, dim> area_vector(const FaceCorners<dim> &face)
  {
    if constexpr (dim == 2)
      return dealii::cross_product_2d(face[1] - face[0]);
    else
      return 0.5 * dealii::cross_product_3d(face[3] - face[0], face[2] - face[1]);
  }

  /** A point of the common part of two faces. */
  template <int dim>
  struct OverlapPoint
  {
    double weight;                                  ///< of the quadrature [L^(dim-1)]
    std::array<double, (1u << (dim - 1))> of_slave; ///< N of the slave face
    std::array<double, (1u << (dim - 1))> of_master;
  };

  /**
   * The common part of a slave face and a master face, both projected onto the plane through the
   * centre of the slave face with the direction of its area (in two dimensions onto a line). The
   * projected master face is clipped by the edges of the slave face (Sutherland and Hodgman), the
   * polygon divided into triangles from its corner farthest from the centre of its area, and each
   * gets 6 points of the rule of degree 4, so that the numbering of corners does not matter, and
   * weights are exact where both faces are parallelograms; in two dimensions an interval
   * gets 2 Gauss points. Both faces have their shape functions at the same
   * points, so that Σ_J w^s_IJ = Σ_L w^m_IL for the weights of a mortar. Weights are areas on the
   * plane.
   *
   * The slave face must be convex on the plane. Replaces @p points; none where the projections do
   * not overlap.
   */
  void find_overlap(const FaceCorners<2> &slave, const FaceCorners<2> &master,
                    std::vector<OverlapPoint<2>> &points);
  void find_overlap(const FaceCorners<3> &slave, const FaceCorners<3> &master,
                    std::vector<OverlapPoint<3>> &points);
} // namespace tombolo
