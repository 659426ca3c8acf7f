// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include "frozen_body.h"
#include "static_solution.h"
#include "text_testing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace
{
  using namespace tombolo;
  using namespace tombolo::testing;

  constexpr double poisson = 0.3;

  /** Cells of size 1, smaller by the entries of @p refinement, that conduct heat, too. */
  std::string conducting_block(const std::vector<unsigned int> &cells,
                               const std::string &refinement, const std::string &options)
  {
    Block block;
    block.formulation = "smoothed cells";
    block.cells = cells;
    block.poisson = poisson;
    block.options = options;
    return changed(
        changed(parameters_of(block), "set Type = box\n", "set Type = box\n" + refinement + "\n"),
        "set Model = elastic\n",
        "set Model = elastic\nsubsection Heat\nset Specific heat capacity = 1\nset Conductivity = "
        "1\nset Initial temperature = 0\nend\n");
  }

  template <int dim>
  StaticProblem<dim> elastic_problem(const Model<dim> &model)
  {
    StaticProblem<dim> problem;
    problem.apply = [&model](const NodalVector &v, NodalVector &force)
    {
      for (const Part<dim> &part : model.parts)
        part.formulation->apply_elastic_stiffness(model.state.position, v, 1e30, force);
    };
    return problem;
  }

  /** The product of the sines of all coordinates over a cube of side n, and its derivatives. */
  template <int dim>
  struct Sines
  {
    double n;

    double second_derivative(const dealii::Point<dim> &x, const unsigned int i,
                             const unsigned int j) const
    {
      const double a = dealii::numbers::PI / n;
      double result = i == j ? -a * a : a * a;
      for (unsigned int d = 0; d < dim; ++d)
        result *= i != j && (d == i || d == j) ? std::cos(a * x[d]) : std::sin(a * x[d]);
      return result;
    }

    double value(const dealii::Point<dim> &x) const
    {
      const double a = dealii::numbers::PI / n;
      return -second_derivative(x, 0, 0) / (a * a);
    }

    bool is_at_boundary(const dealii::Point<dim> &x) const
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (x[d] < 1e-9 || x[d] > n - 1e-9)
          return true;
      return false;
    }
  };

  template <int dim>
  double elastic_error(const unsigned int n, const std::string &refinement,
                       const std::string &options)
  {
    const FrozenBody<dim> body(
        conducting_block(std::vector<unsigned int>(dim, n), refinement, options));
    StaticProblem<dim> problem = elastic_problem(*body.model);
    const Sines<dim> sines{static_cast<double>(n)};
    const Material &material = body.model->parts[0].formulation->material();
    const double shear = material.shear_modulus();
    const double lambda = material.bulk_modulus() - 2. / 3. * shear;
    const double c[3] = {1., 0.5, -0.7};
    problem.exact = [=](const dealii::Point<dim> &x)
    {
      dealii::Tensor<1, dim> u;
      for (unsigned int i = 0; i < dim; ++i)
        u[i] = c[i] * sines.value(x);
      return u;
    };
    problem.load = [=](const dealii::Point<dim> &x)
    {
      dealii::Tensor<1, dim> f;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          f[i] -= shear * c[i] * sines.second_derivative(x, j, j) +
                  (lambda + shear) * c[j] * sines.second_derivative(x, i, j);
      return f;
    };
    problem.is_prescribed = [=](const dealii::Point<dim> &x, unsigned int)
    { return sines.is_at_boundary(x); };
    return relative_error(*body.model, problem);
  }

  template <int dim>
  StaticProblem<dim> conduction_problem(const Model<dim> &model)
  {
    StaticProblem<dim> problem;
    problem.n_components = 1;
    problem.apply = [&model](const NodalVector &temperature, NodalVector &rate)
    {
      NodalVector minus(model.state.partition(), Quantity::scalars);
      for (const Part<dim> &part : model.parts)
        part.formulation->add_conduction(model.state.position, temperature, temperature, minus);
      for (unsigned int i = 0; i < model.state.partition()->n_local(); ++i)
        *rate.node(i) -= *minus.node(i);
    };
    return problem;
  }

  template <int dim>
  double heat_error(const unsigned int n, const std::string &refinement, const std::string &options)
  {
    const FrozenBody<dim> body(
        conducting_block(std::vector<unsigned int>(dim, n), refinement, options));
    StaticProblem<dim> problem = conduction_problem(*body.model);
    const Sines<dim> sines{static_cast<double>(n)};
    problem.exact = [=](const dealii::Point<dim> &x)
    {
      dealii::Tensor<1, dim> u;
      u[0] = sines.value(x);
      return u;
    };
    problem.load = [=](const dealii::Point<dim> &x)
    {
      dealii::Tensor<1, dim> f;
      f[0] = -dim * sines.second_derivative(x, 0, 0);
      return f;
    };
    problem.is_prescribed = [=](const dealii::Point<dim> &x, unsigned int)
    { return sines.is_at_boundary(x); };
    return relative_error(*body.model, problem);
  }

  std::string refined_corner(const unsigned int n)
  {
    return "set Refine where = x < " + std::to_string(n / 2) + " && y < " +
           std::to_string(n * 3 / 4);
  }

  template <typename Error>
  void expect_order(const std::string &what, const unsigned int n, const double least,
                    const Error &error)
  {
    const double coarse = error(n), fine = error(2 * n);
    const double order = std::log2(coarse / fine);
    std::cout << what << ": " << coarse << " " << fine << ", order " << order << "\n";
    EXPECT_GE(order, least) << what;
  }

  TEST(GradedOrders, of_displacements_are_at_least_1_9)
  {
    for (const std::string options : {"set Dilation = 1.1", "set Dilation = 1.5"})
    {
      expect_order("plane, " + options, 8, 1.9,
                   [&](const unsigned int n)
                   { return elastic_error<2>(n, refined_corner(n), options); });
      expect_order("plane, " + options, 16, 1.9,
                   [&](const unsigned int n)
                   { return elastic_error<2>(n, refined_corner(n), options); });
    }
    expect_order("solid", 4, 1.9,
                 [&](const unsigned int n) { return elastic_error<3>(n, refined_corner(n), ""); });
  }

  TEST(GradedOrders, of_temperatures_are_at_least_1_9)
  {
    expect_order("plane", 8, 1.9,
                 [&](const unsigned int n) { return heat_error<2>(n, refined_corner(n), ""); });
    expect_order("plane", 16, 1.9,
                 [&](const unsigned int n) { return heat_error<2>(n, refined_corner(n), ""); });
    expect_order("solid", 4, 1.9,
                 [&](const unsigned int n) { return heat_error<3>(n, refined_corner(n), ""); });
  }

  template <int dim>
  void expect_exact_linear_field(const std::vector<unsigned int> &cells,
                                 const std::string &refinement)
  {
    const FrozenBody<dim> body(conducting_block(cells, refinement, ""));
    StaticProblem<dim> problem = conduction_problem(*body.model);
    problem.exact = [](const dealii::Point<dim> &x)
    {
      dealii::Tensor<1, dim> u;
      u[0] = 1. + 2. * x[0] - 3. * x[1] + 0.5 * x[dim - 1];
      return u;
    };
    problem.load = [](const dealii::Point<dim> &) { return dealii::Tensor<1, dim>(); };
    problem.is_prescribed = [&](const dealii::Point<dim> &x, unsigned int)
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (x[d] < 1e-9 || x[d] > cells[d] - 1e-9)
          return true;
      return false;
    };
    EXPECT_LE(relative_error(*body.model, problem), 1e-9); // that of the iteration
  }

  TEST(GradedOrders, have_linear_temperatures_exactly)
  {
    expect_exact_linear_field<2>({6, 5}, "set Refine where = x < 3; y > 3\nset Refinement levels "
                                         "= 1; 2");
    expect_exact_linear_field<3>({5, 4, 4}, "set Refine where = x < 2 && z > 1");
  }

  /** The opening of a crack from the left to the middle of the lower side of a plate of n x n/2
   * cells: the displacements of the leading term, prescribed on the other sides. */
  double crack_error(const unsigned int n, const std::string &refinement, double &n_cells)
  {
    const FrozenBody<2> body(conducting_block({n, n / 2}, refinement, ""));
    const Model<2> &model = *body.model;
    StaticProblem<2> problem = elastic_problem(model);
    const double middle = 0.5 * n, side = n;
    problem.exact = [=](const dealii::Point<2> &x)
    {
      const double r = std::hypot(x[0] - middle, x[1]) / side;
      const double half = 0.5 * std::atan2(x[1], x[0] - middle);
      constexpr double kappa = 3. - 4. * poisson;
      return dealii::Tensor<1, 2>(
          {std::sqrt(r) * std::cos(half) * (kappa - 1. + 2. * std::pow(std::sin(half), 2)),
           std::sqrt(r) * std::sin(half) * (kappa + 1. - 2. * std::pow(std::cos(half), 2))});
    };
    problem.load = [](const dealii::Point<2> &) { return dealii::Tensor<1, 2>(); };
    problem.is_prescribed = [=](const dealii::Point<2> &x, const unsigned int c)
    {
      const bool is_on_sides = x[0] < 1e-9 || x[0] > side - 1e-9 || x[1] > 0.5 * side - 1e-9;
      return is_on_sides || (c == 1 && x[1] < 1e-9 && x[0] > middle - 1e-9);
    };
    n_cells = sum_over_ranks(model.parts[0].formulation->n_cells());
    return relative_error(model, problem);
  }

  TEST(GradedOrders, a_crack_needs_small_cells_at_its_tip_only)
  {
    double n_uniform, n_graded;
    const double uniform = crack_error(64, "", n_uniform);
    const double graded = crack_error(16,
                                      "set Refine where = (x - 8)^2 + y^2 < 25; (x - 8)^2 + y^2 < "
                                      "5\nset Refinement levels = 1; 2",
                                      n_graded);
    std::cout << "crack: uniform " << uniform << " with " << n_uniform << " cells, graded "
              << graded << " with " << n_graded << "\n";
    EXPECT_LE(graded, 1.2 * uniform);
    EXPECT_LE(n_graded, 0.5 * n_uniform);
  }
} // namespace
