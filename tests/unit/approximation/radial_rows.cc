// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/approximation/radial_rows.h>
#include <tombolo/approximation/row_deformation.h>

#include <deal.II/base/numbers.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace
{
  using namespace tombolo;
  using dealii::Tensor;

  /** Particles of volume one on a lattice of spacing one, n on each axis, each moved by up to
   * @p disorder on each axis, and their rows. */
  template <int dim>
  struct LatticeRows
  {
    using Uncorrected = typename RadialRows<dim>::Uncorrected;

    LatticeRows(const std::string &kernel, const double smoothing_length, const bool corrects,
                const double disorder = 0., const unsigned int n = 9)
        : n_on_axis(n), radial(make_kernel(kernel), smoothing_length),
          rows(radial, corrects, 0.5, Uncorrected::raw)
    {
      std::mt19937 generator(1);
      std::uniform_real_distribution<double> random(-disorder, disorder);
      for (unsigned int i = 0; i < std::pow(n, dim); ++i)
      {
        numbers.push_back(i);
        const unsigned int coordinate[3] = {i % n, i / n % n, dim == 3 ? i / (n * n) : 0};
        for (unsigned int c = 0; c < node_stride; ++c)
        {
          position.push_back(c < dim ? coordinate[c] + random(generator) : 0.);
          support.push_back(c < dim ? radial.support() : c == node_stride - 1 ? 1. : 0.);
        }
      }
    }

    void search_and_compute(const std::vector<double> &volume = {})
    {
      neighbours.search(numbers, position, support, MPI_COMM_SELF, shape);
      rows.compute(neighbours.nodes(), position.data(), support.data(), volume, shape, shape);
    }

    /** Σ f(x_J) ⊗ ∇φ_J of row @p i for f = A x + b with @p matrix. */
    Tensor<2, dim> gradient_of(const Tensor<2, dim> &matrix, const unsigned int i) const
    {
      Tensor<2, dim> result;
      const Stencils::Row row = shape.row(i);
      for (unsigned int k = 0; k < row.size; ++k)
        for (unsigned int a = 0; a < dim; ++a)
        {
          double value = 3.;
          for (unsigned int c = 0; c < dim; ++c)
            value += matrix[a][c] * position[row.neighbour[k] * node_stride + c];
          for (unsigned int b = 0; b < dim; ++b)
            result[a][b] += value * row.gradient[k * Stencils::n_gradient + b];
        }
      return result;
    }

    Tensor<2, dim> moment(const unsigned int i) const
    {
      Tensor<2, dim> unit;
      for (unsigned int a = 0; a < dim; ++a)
        unit[a][a] = 1.;
      return gradient_of(unit, i);
    }

    /** Σ_J V_J W_IJ. */
    double kernel_sum(const unsigned int i) const
    {
      std::vector<double> distance;
      const Stencils::Row row = shape.row(i);
      for (unsigned int k = 0; k < row.size; ++k)
      {
        double squared = 0;
        for (unsigned int a = 0; a < dim; ++a)
          squared += std::pow(
              position[row.neighbour[k] * node_stride + a] - position[i * node_stride + a], 2);
        distance.push_back(std::sqrt(squared));
      }
      distance.resize((distance.size() + n_lanes - 1) / n_lanes * n_lanes, 1e3);
      std::vector<double> value(distance.size()), slope(distance.size());
      radial.evaluate(distance.size(), distance.data(), value.data(), slope.data());
      double sum = 0;
      for (const double w : value)
        sum += w;
      return sum;
    }

    unsigned int centre() const
    {
      return static_cast<unsigned int>(numbers.size()) / 2;
    }
    /** In the middle of the lowest layer on the first axis. */
    unsigned int surface() const
    {
      return centre() - n_on_axis / 2;
    }

    unsigned int n_on_axis;
    RadialKernel<dim> radial;
    RadialRows<dim> rows;
    std::vector<dealii::types::global_dof_index> numbers;
    std::vector<double> position, support;
    Neighbourhoods<dim> neighbours;
    Stencils shape;
  };

  template <int dim>
  LatticeRows<dim> computed_rows(const std::string &kernel, const double length,
                                 const bool corrects, const double disorder = 0.)
  {
    LatticeRows<dim> result(kernel, length, corrects, disorder);
    result.search_and_compute();
    return result;
  }

  TEST(RadialRows, of_the_kernel_alone_have_the_factors_of_a_lattice_inside)
  {
    const auto factor = [](const auto &lattice) { return lattice.moment(lattice.centre())[0][0]; };
    EXPECT_NEAR(factor(computed_rows<3>("hyperbolic spline", 1.2, false)), 0.9624, 1e-4);
    EXPECT_NEAR(factor(computed_rows<3>("hyperbolic spline", 1.5, false)), 0.9995, 1e-4);
    EXPECT_NEAR(factor(computed_rows<3>("cubic spline", 1.2, false)), 0.9817, 1e-4);
    EXPECT_NEAR(factor(computed_rows<3>("cubic spline", 1.5, false)), 1.0101, 1e-4);
    EXPECT_NEAR(factor(computed_rows<2>("hyperbolic spline", 1.2, false)), 0.9452, 1e-4);
    EXPECT_NEAR(factor(computed_rows<2>("hyperbolic spline", 1.5, false)), 0.9833, 1e-4);
    const auto narrow = computed_rows<3>("hyperbolic spline", 1.2, false);
    EXPECT_NEAR(narrow.kernel_sum(narrow.centre()), 1.0601, 1e-4);
    const auto wide = computed_rows<3>("hyperbolic spline", 1.5, false);
    EXPECT_NEAR(wide.kernel_sum(wide.centre()), 1.0254, 1e-4);
  }

  TEST(RadialRows, of_the_kernel_alone_lose_half_of_the_gradient_at_a_surface)
  {
    const auto lattice = computed_rows<3>("hyperbolic spline", 1.2, false);
    const Tensor<2, 3> moment = lattice.moment(lattice.surface());
    EXPECT_NEAR(moment[0][0], 0.481, 5e-4);
    EXPECT_NEAR(moment[1][1], 0.767, 5e-4);
    EXPECT_NEAR(moment[2][2], 0.767, 5e-4);
    EXPECT_TRUE(lattice.shape.is_uncorrected);
    EXPECT_TRUE(lattice.shape.is_undeformed(3));
  }

  TEST(RadialRows, of_the_kernel_alone_go_with_the_volume_of_the_particle)
  {
    LatticeRows<2> lattice("hyperbolic spline", 1.2, false);
    std::vector<double> volume(lattice.numbers.size(), 1.);
    volume[lattice.centre()] = 1.25;
    lattice.search_and_compute(volume);
    EXPECT_NEAR(lattice.moment(lattice.centre())[0][0], 1.25 * 0.9452, 2e-4);
  }

  template <int dim>
  void expect_exact_gradients(const std::string &kernel, const double length)
  {
    const auto lattice = computed_rows<dim>(kernel, length, true, 0.2);
    EXPECT_TRUE(lattice.shape.uncorrected_rows.empty());
    EXPECT_TRUE(lattice.shape.rank_deficient_rows.empty());
    Tensor<2, dim> matrix;
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        matrix[a][b] = 1. + a - 0.7 * b;
    for (unsigned int i = 0; i < lattice.numbers.size(); ++i)
    {
      EXPECT_LT((lattice.gradient_of(matrix, i) - matrix).norm(), 1e-11);
      const Stencils::Row row = lattice.shape.row(i);
      for (unsigned int k = 0; k < row.size; ++k)
        EXPECT_EQ(row.value[k], row.neighbour[k] == i ? 1. : 0.);
    }
  }

  TEST(RadialRows, that_are_corrected_have_exact_gradients_of_linear_fields_in_disorder)
  {
    expect_exact_gradients<2>("hyperbolic spline", 1.2);
    expect_exact_gradients<2>("quintic spline", 1.5);
    expect_exact_gradients<3>("hyperbolic spline", 1.5);
    expect_exact_gradients<3>("cubic spline", 1.2);
  }

  TEST(RadialRows, of_a_lattice_hold_waves_back_as_their_symbol_says)
  {
    // With u = sin kx the strain at x = 0 is Σ sin(k d) ∂φ instead of k, and so is the force.
    const auto phase_speed = [](const auto &lattice, const double wave_length)
    {
      const double k = 2. * dealii::numbers::PI / wave_length;
      const unsigned int i = lattice.centre();
      const Stencils::Row row = lattice.shape.row(i);
      double sum = 0;
      for (unsigned int n = 0; n < row.size; ++n)
        sum += row.gradient[n * Stencils::n_gradient] *
               std::sin(k * (lattice.position[row.neighbour[n] * node_stride] -
                             lattice.position[i * node_stride]));
      return sum / k;
    };
    const auto raw = computed_rows<3>("hyperbolic spline", 1.2, false);
    EXPECT_NEAR(phase_speed(raw, 20.), 0.943, 0.005);
    EXPECT_NEAR(phase_speed(raw, 10.), 0.886, 0.005);
    const auto corrected = computed_rows<3>("hyperbolic spline", 1.2, true);
    EXPECT_NEAR(phase_speed(corrected, 20.), 0.980, 0.005);
    EXPECT_NEAR(phase_speed(corrected, 10.), 0.921, 0.005);
    const auto cubic = computed_rows<3>("cubic spline", 1.5, false);
    EXPECT_NEAR(phase_speed(cubic, 20.), 0.977, 0.005);
    EXPECT_NEAR(phase_speed(cubic, 10.), 0.883, 0.005);
  }

  TEST(RadialRows, are_not_corrected_where_neighbours_lie_to_few_sides)
  {
    // A row of particles far from the others: det F is zero.
    LatticeRows<2> lattice("hyperbolic spline", 1.2, true, 0., 5);
    for (unsigned int i = 0; i < 5; ++i)
      lattice.position[i * node_stride + 1] -= 100.;
    lattice.search_and_compute();
    EXPECT_EQ(lattice.shape.uncorrected_rows, (std::vector<unsigned int>{0, 1, 2, 3, 4}));
    EXPECT_NEAR(lattice.moment(2)[1][1], 0., 1e-14);
    EXPECT_GT(lattice.moment(2)[0][0], 0.1);
    EXPECT_LT(lattice.moment(2)[0][0], 0.9);

    // The same of a kernel whose reference stays: no gradient at all.
    RadialRows<2> lagrangian(lattice.radial, true, 0.5, RadialRows<2>::Uncorrected::empty);
    const auto &defects =
        lagrangian.compute(lattice.neighbours.nodes(), lattice.position.data(),
                           lattice.support.data(), {}, lattice.shape, lattice.shape);
    ASSERT_EQ(defects.size(), 5u);
    EXPECT_EQ(defects[2].n_neighbours, 4u);
    EXPECT_EQ(lattice.shape.rank_deficient_rows, (std::vector<unsigned int>{0, 1, 2, 3, 4}));
    EXPECT_TRUE(lattice.shape.uncorrected_rows.empty());
    EXPECT_EQ(lattice.moment(2).norm(), 0.);
  }
} // namespace
