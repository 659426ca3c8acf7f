// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/face_shapes.h>

#include <deal.II/base/polynomial.h>
#include <deal.II/base/quadrature_lib.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  FaceShapes<dim>::FaceShapes(const unsigned int degree, const unsigned int n_points_per_direction)
  {
    const unsigned int n = degree + 1;
    n_nodes = dim == 2 ? n : n * n;
    const auto polynomials =
        Polynomials::generate_complete_Lagrange_basis(QGaussLobatto<1>(n).get_points());
    const QGauss<dim - 1> quadrature(n_points_per_direction);
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

  template struct FaceShapes<2>;
  template struct FaceShapes<3>;
} // namespace tombolo
