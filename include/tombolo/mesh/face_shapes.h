// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/polynomial.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/base/tensor.h>

#include <vector>

namespace tombolo
{
  /** Lagrange shape functions of the nodes of a face, in the order of Nodes::face_node_indices(),
   * with their derivatives along the face, at the points of a Gauss quadrature of the reference
   * face. */
  template <int dim>
  struct FaceShapes
  {
    FaceShapes() = default;
    FaceShapes(const unsigned int degree, const unsigned int n_points_per_direction)
    {
      const unsigned int n = degree + 1;
      n_nodes = dim == 2 ? n : n * n;
      const auto polynomials = dealii::Polynomials::generate_complete_Lagrange_basis(
          dealii::QGaussLobatto<1>(n).get_points());
      const dealii::QGauss<dim - 1> quadrature(n_points_per_direction);
      std::vector<double> value_and_derivative(2);
      for (unsigned int q = 0; q < quadrature.size(); ++q)
      {
        weights.push_back(quadrature.weight(q));
        std::vector<double> along[2], slopes[2];
        for (unsigned int d = 0; d < dim - 1; ++d)
          for (unsigned int i = 0; i < n; ++i)
          {
            polynomials[i].value(quadrature.point(q)[d], value_and_derivative);
            along[d].push_back(value_and_derivative[0]);
            slopes[d].push_back(value_and_derivative[1]);
          }
        for (unsigned int k = 0; k < n_nodes; ++k)
          values.push_back(dim == 2 ? along[0][k] : along[0][k % n] * along[1][k / n]);
        for (unsigned int d = 0; d < dim - 1; ++d)
          for (unsigned int k = 0; k < n_nodes; ++k)
            derivatives.push_back(dim == 2 ? slopes[0][k]
                                  : d == 0 ? slopes[0][k % n] * along[1][k / n]
                                           : along[0][k % n] * slopes[1][k / n]);
      }
    }

    double value(const unsigned int q, const unsigned int node) const
    {
      return values[q * n_nodes + node];
    }

    double derivative(const unsigned int q, const unsigned int direction,
                      const unsigned int node) const
    {
      return derivatives[(q * (dim - 1) + direction) * n_nodes + node];
    }

    /** The product of the tangents at point @p q of a face whose node k is at @p position_of(k): a
     * normal that is as long as an area of the face over that of the reference face. */
    template <typename PositionOf>
    dealii::Tensor<1, dim> normal(const unsigned int q, const PositionOf &position_of) const
    {
      dealii::Tensor<1, dim> tangents[dim - 1];
      for (unsigned int d = 0; d < dim - 1; ++d)
        for (unsigned int k = 0; k < n_nodes; ++k)
        {
          const auto &position = position_of(k);
          for (unsigned int c = 0; c < dim; ++c)
            tangents[d][c] += derivative(q, d, k) * position[c];
        }
      if constexpr (dim == 2)
        return dealii::cross_product_2d(tangents[0]);
      else
        return dealii::cross_product_3d(tangents[0], tangents[1]);
    }

    unsigned int n_nodes = 0;
    std::vector<double> weights; ///< of the quadrature points

  private:
    std::vector<double> values, derivatives;
  };

  extern template struct FaceShapes<2>;
  extern template struct FaceShapes<3>;
} // namespace tombolo
