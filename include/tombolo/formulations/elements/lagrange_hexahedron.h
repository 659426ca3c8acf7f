// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/utilities.h>

#include <tombolo/formulations/elements/element.h>
#include <tombolo/formulations/elements/element_modes.h>

#include <array>
#include <vector>

namespace tombolo
{
  /** Gauss-Lobatto points on [-1, 1], their weights, and the derivatives of the Lagrange
   * polynomials through them: derivative[i][m] is that of polynomial m at point i. */
  template <unsigned int degree>
  struct GaussLobattoLine
  {
    std::array<double, degree + 1> points{};
    std::array<double, degree + 1> weights{};
    std::array<std::array<double, degree + 1>, degree + 1> derivative{};

    constexpr GaussLobattoLine()
    {
      static_assert(degree == 2 || degree == 3, "points are known for these degrees");
      constexpr double inner = degree == 2 ? 0. : 0.44721359549995793928; // 1/√5
      points[0] = -1.;
      weights[0] = degree == 2 ? 1. / 3. : 1. / 6.;
      for (unsigned int i = 1; i < degree; ++i)
      {
        points[i] = i == 1 ? -inner : inner;
        weights[i] = degree == 2 ? 4. / 3. : 5. / 6.;
      }
      points[degree] = 1.;
      weights[degree] = weights[0];
      for (unsigned int i = 0; i <= degree; ++i)
        for (unsigned int m = 0; m <= degree; ++m)
          for (unsigned int without = 0; without <= degree; ++without)
            if (without != m)
            {
              double product = 1. / (points[m] - points[without]);
              for (unsigned int j = 0; j <= degree; ++j)
                if (j != m && j != without)
                  product *= (points[i] - points[j]) / (points[m] - points[j]);
              derivative[i][m] += product;
            }
    }
  };

  /**
   * Lagrange element of degree 2 or 3 whose nodes are also its integration points (spectral
   * element): the Gauss-Lobatto rule makes the mass diagonal and, on parallelepipeds, costs no
   * order of accuracy. It integrates the gradients of multilinear cells exactly (its degree of
   * exactness, 2 p - 1, is not less than p + 1), so that distorted cells pass the patch test; for p
   * = 1 it would not. Derivatives are taken along lines of nodes.
   */
  template <int dim, unsigned int p>
  class LagrangeHexahedron : public ElementDefaults
  {
  public:
    static constexpr unsigned int degree = p;
    static constexpr unsigned int n_nodes =
        static_cast<unsigned int>(dealii::Utilities::pow(p + 1, dim));
    static constexpr unsigned int n_points = n_nodes;
    static constexpr MassLumping lumping = MassLumping::gauss_lobatto;
    static constexpr double cost_per_point = 28.; // sums along three lines of nodes

    struct Work
    {
      Lanes inverse_jacobian[n_points][dim][dim]; // ∂ξ_a/∂x_j
    };

    LagrangeHexahedron() = default;
    explicit LagrangeHexahedron(const Section & /*section*/) {}

    static std::vector<dealii::Point<dim>> reference_points()
    {
      std::vector<dealii::Point<dim>> points(n_points);
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int a = 0; a < dim; ++a)
          points[q][a] = line.points[position(q, a)];
      return points;
    }

    void evaluate(const Lanes (&x)[n_nodes][dim], const Lanes (&v)[n_nodes][dim], Work &work,
                  Lanes (&volume)[n_points], Matrix3<Lanes> (&gradient)[n_points]) const
    {
      for (unsigned int q = 0; q < n_points; ++q)
      {
        Lanes jacobian[dim][dim], velocity[dim][dim];
        double weight = 1.;
        for (unsigned int a = 0; a < dim; ++a)
        {
          const unsigned int at = position(q, a);
          const unsigned int first = q - at * stride(a);
          const auto &coefficients = line.derivative[at];
          weight *= line.weights[at];
          for (unsigned int i = 0; i < dim; ++i)
          {
            Lanes x_derivative = coefficients[0] * x[first][i];
            Lanes v_derivative = coefficients[0] * v[first][i];
            for (unsigned int m = 1; m <= p; ++m)
            {
              x_derivative += coefficients[m] * x[first + m * stride(a)][i];
              v_derivative += coefficients[m] * v[first + m * stride(a)][i];
            }
            jacobian[i][a] = x_derivative;
            velocity[i][a] = v_derivative;
          }
        }
        Lanes inverse[dim][dim];
        volume[q] = weight * invert(jacobian, inverse);
        gradient[q] = zero_matrix<Lanes>();
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
          {
            Lanes sum = velocity[i][0] * inverse[0][j];
            for (unsigned int a = 1; a < dim; ++a)
              sum += velocity[i][a] * inverse[a][j];
            gradient[q](i, j) = sum;
          }
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int j = 0; j < dim; ++j)
            work.inverse_jacobian[q][a][j] = inverse[a][j];
      }
    }

    void integrate(const Work &work, const Lanes (&stress)[n_points][6],
                   Lanes (&force)[n_nodes][dim]) const
    {
      constexpr unsigned int component[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
      Lanes pulled_back[n_points][dim][dim]; // along ξ_a, component i
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int i = 0; i < dim; ++i)
          {
            Lanes sum = work.inverse_jacobian[q][a][0] * stress[q][component[i][0]];
            for (unsigned int j = 1; j < dim; ++j)
              sum += work.inverse_jacobian[q][a][j] * stress[q][component[i][j]];
            pulled_back[q][a][i] = sum;
          }
      for (unsigned int k = 0; k < n_nodes; ++k)
        for (unsigned int i = 0; i < dim; ++i)
        {
          Lanes sum = 0.;
          for (unsigned int a = 0; a < dim; ++a)
          {
            const unsigned int at = position(k, a);
            const unsigned int first = k - at * stride(a);
            for (unsigned int m = 0; m <= p; ++m)
              sum += line.derivative[m][at] * pulled_back[first + m * stride(a)][a][i];
          }
          force[k][i] = sum;
        }
    }

  private:
    static constexpr GaussLobattoLine<p> line{};

    static constexpr unsigned int stride(const unsigned int a)
    {
      return a == 0 ? 1 : a == 1 ? p + 1 : (p + 1) * (p + 1);
    }

    /** Of a node or point on the line along ξ_a through it. */
    static constexpr unsigned int position(const unsigned int point, const unsigned int a)
    {
      return point / stride(a) % (p + 1);
    }
  };
} // namespace tombolo
