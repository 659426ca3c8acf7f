// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/element.h>
#include <tombolo/formulations/elements/element_modes.h>
#include <tombolo/formulations/mean_dilatation.h>

#include <vector>

namespace tombolo
{
  /**
   * Hexahedron (quadrilateral) of degree 1 with 2^dim Gauss points. With @p mean_dilatation the
   * volumetric part of the velocity gradient is its mean over the cell (MeanDilatation), so that
   * the element does not lock where the volume is kept.
   */
  template <int dim, bool mean_dilatation>
  class FullyIntegratedHexahedron : public ElementDefaults
  {
  public:
    static constexpr unsigned int degree = 1;
    static constexpr unsigned int n_nodes = 1 << dim;
    static constexpr unsigned int n_points = 1 << dim;
    static constexpr bool shares_volume = mean_dilatation;
    static constexpr double cost_per_point = 25.; // volume shared, logarithmic strain

    struct Work
    {
      Lanes inverse_jacobian[n_points][dim][dim]; // ∂ξ_a/∂x_j
      Lanes volume[n_points];
      Lanes shared[mean_dilatation ? n_points : 1]; // what the mean adds to the diagonal of ∇v
    };

    FullyIntegratedHexahedron() = default;
    explicit FullyIntegratedHexahedron(const Section & /*section*/) {}

    static std::vector<dealii::Point<dim>> reference_points()
    {
      std::vector<dealii::Point<dim>> points(n_points);
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int d = 0; d < dim; ++d)
          points[q][d] = ((q >> d) & 1u) != 0 ? gauss_point : -gauss_point;
      return points;
    }

    void evaluate(const Lanes (&x)[n_nodes][dim], const Lanes (&v)[n_nodes][dim], Work &work,
                  Lanes (&volume)[n_points], Matrix3<Lanes> (&gradient)[n_points]) const
    {
      Lanes position_derivatives[dim][dim][n_lines], velocity_derivatives[dim][dim][n_lines];
      differentiate(x, position_derivatives);
      differentiate(v, velocity_derivatives);
      for (unsigned int q = 0; q < n_points; ++q)
      {
        Lanes jacobian[dim][dim];
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int a = 0; a < dim; ++a)
            jacobian[i][a] = position_derivatives[i][a][line(q, a)];
        volume[q] = work.volume[q] = invert(jacobian, work.inverse_jacobian[q]);
        gradient[q] = zero_matrix<Lanes>();
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
          {
            Lanes sum = velocity_derivatives[i][0][line(q, 0)] * work.inverse_jacobian[q][0][j];
            for (unsigned int a = 1; a < dim; ++a)
              sum += velocity_derivatives[i][a][line(q, a)] * work.inverse_jacobian[q][a][j];
            gradient[q](i, j) = sum;
          }
      }
      if constexpr (mean_dilatation)
        MeanDilatation::share_gradient<dim>(volume, gradient, work.shared);
    }

    /** The middle of the step is found for the motion itself: with the mean in it, products of mean
     * and gradient, of second order and of one sign, would make the stresses of the points drift.
     */
    static void separate(const Work &work, Matrix3<Lanes> (&gradient)[n_points])
    {
      if constexpr (mean_dilatation)
        for (unsigned int q = 0; q < n_points; ++q)
          for (unsigned int i = 0; i < dim; ++i)
            gradient[q](i, i) -= work.shared[q];
    }

    static void share(const Work &work, const bool is_logarithmic,
                      MotionIncrement<Lanes> (&motion)[n_points])
    {
      if constexpr (mean_dilatation)
        MeanDilatation::share<dim>(is_logarithmic, work.volume, motion);
    }

    void integrate(const Work &work, const Lanes (&stress)[n_points][6],
                   Lanes (&force)[n_nodes][dim]) const
    {
      constexpr unsigned int component[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
      Lanes mean_pressure = 0.;
      if constexpr (mean_dilatation)
        mean_pressure = MeanDilatation::mean_pressure<dim>(work.volume, stress);

      Lanes line_forces[dim][dim][n_lines];
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int l = 0; l < n_lines; ++l)
            line_forces[i][a][l] = 0.;
      for (unsigned int q = 0; q < n_points; ++q)
      {
        Lanes difference = 0.;
        if constexpr (mean_dilatation)
        {
          difference = work.volume[q] * mean_pressure -
                       (1. / dim) * MeanDilatation::trace_in_plane<dim>(stress[q]);
        }
        for (unsigned int i = 0; i < dim; ++i)
        {
          Lanes row[dim];
          for (unsigned int j = 0; j < dim; ++j)
            row[j] = stress[q][component[i][j]];
          if constexpr (mean_dilatation)
            row[i] += difference;
          for (unsigned int a = 0; a < dim; ++a)
          {
            Lanes sum = row[0] * work.inverse_jacobian[q][a][0];
            for (unsigned int j = 1; j < dim; ++j)
              sum += row[j] * work.inverse_jacobian[q][a][j];
            line_forces[i][a][line(q, a)] += sum;
          }
        }
      }
      differentiate_transpose(line_forces, force);
    }

  private:
    static constexpr double gauss_point = 0.57735026918962576451; // 1/√3
    /** ∂/∂ξ_a does not depend on ξ_a: it has one value on each line of points along a. */
    static constexpr unsigned int n_lines = n_points / 2;

    static constexpr unsigned int line(const unsigned int point, const unsigned int a)
    {
      const unsigned int below = (1u << a) - 1;
      return (point & below) | ((point >> 1) & ~below);
    }

    /** The mode whose coordinates are ξ_a and those that are set in @p others, bits across a. */
    static constexpr unsigned int mode(const unsigned int others, const unsigned int a)
    {
      const unsigned int below = (1u << a) - 1;
      return (others & below) | (1u << a) | ((others & ~below) << 1);
    }

    /** 2^-dim g^(number of coordinates across a): the values of modes at Gauss points, and the mean
     * that makes modes of sums over nodes. */
    static constexpr double scale(const unsigned int others)
    {
      double value = 1. / n_nodes;
      for (unsigned int rest = others; rest != 0; rest &= rest - 1)
        value *= gauss_point;
      return value;
    }

    /** ∂values_i/∂ξ_a at the Gauss points. */
    static void differentiate(const Lanes (&values)[n_nodes][dim],
                              Lanes (&derivatives)[dim][dim][n_lines])
    {
      for (unsigned int i = 0; i < dim; ++i)
      {
        Lanes modes[n_nodes];
        for (unsigned int k = 0; k < n_nodes; ++k)
          modes[k] = values[k][i];
        sum_to_modes(modes);
        for (unsigned int a = 0; a < dim; ++a)
        {
          for (unsigned int l = 0; l < n_lines; ++l)
            derivatives[i][a][l] = scale(l) * modes[mode(l, a)];
          expand_to_nodes(derivatives[i][a]);
        }
      }
    }

    /** The transpose of differentiate(). Overwrites its argument. */
    static void differentiate_transpose(Lanes (&derivatives)[dim][dim][n_lines],
                                        Lanes (&values)[n_nodes][dim])
    {
      for (unsigned int i = 0; i < dim; ++i)
      {
        Lanes modes[n_nodes];
        for (unsigned int k = 0; k < n_nodes; ++k)
          modes[k] = 0.;
        for (unsigned int a = 0; a < dim; ++a)
        {
          sum_to_modes(derivatives[i][a]);
          for (unsigned int l = 0; l < n_lines; ++l)
            modes[mode(l, a)] += scale(l) * derivatives[i][a][l];
        }
        expand_to_nodes(modes);
        for (unsigned int k = 0; k < n_nodes; ++k)
          values[k][i] = modes[k];
      }
    }
  };
} // namespace tombolo
