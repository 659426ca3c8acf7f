// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace tombolo
{
  /** Lagrange shape functions of the nodes of a face, in the order of Nodes::face_places(), with
   * their derivatives along the face, at the points of a Gauss quadrature of the reference face. */
  template <int dim>
  struct FaceShapes
  {
    FaceShapes() = default;
    FaceShapes(unsigned int degree, unsigned int n_points_per_direction);

    double value(const unsigned int q, const unsigned int node) const
    {
      return values[q * n_nodes + node];
    }

    double derivative(const unsigned int q, const unsigned int direction,
                      const unsigned int node) const
    {
      return derivatives[(q * (dim - 1) + direction) * n_nodes + node];
    }

    unsigned int n_nodes = 0;
    std::vector<double> weights; ///< of the quadrature points

  private:
    std::vector<double> values, derivatives;
  };
} // namespace tombolo
