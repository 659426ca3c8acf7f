// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
#include <heated_body.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  const std::string flux = "subsection Condition: flux\nset Type = heat flux\nset Where = x > "
                           "1.999\nset Function = 3 + y\nend\n";
  const std::string film_section =
      "subsection Condition: air\nset Type = convection\nset Where = x < "
      "1e-3\nset Film coefficient = 2\nset Ambient temperature = 1\nend\n";
  const std::string sky =
      "subsection Condition: sky\nset Type = radiation\nset Where = y < 1e-3\nset Emissivity = "
      "0.5\nset Ambient temperature = 2\nset Stefan-Boltzmann constant = 1e-3\nend\n";
  const std::string source = "subsection Condition: source\nset Type = heat source\nset Function = "
                             "0.5 * (1 + t)\nend\n";
  const std::string held_ever_hotter =
      "subsection Condition: held_ever_hotter\nset Type = temperature\nset Where = x < "
      "1e-3\nset Function = 5 + 10 * t\nend\n";

  double disorder(const double *x, const double seed)
  {
    return std::sin(91.7 * x[0] + 57.3 * x[1] + 31.1 * x[2] + seed);
  }

  template <int dim>
  void fill(HeatedBody<dim> &body, NodalVector &field, const double seed,
            const bool is_held = false)
  {
    field.fill([&](const unsigned int i, double *const value)
               { *value = disorder(body.model->state.initial_position.node(i), seed); });
    if (is_held)
      for (const unsigned int node : body.heat().conditions.constrained_nodes())
        *field.node(node) = 0.;
    field.update_ghosts();
  }

  class HeatOperators : public ::testing::TestWithParam<HeatedMethod>
  {};

  INSTANTIATE_TEST_SUITE_P(
      Methods, HeatOperators,
      ::testing::Values(HeatedMethod{"elements", "", "paper"},
                        HeatedMethod{"elements", "", "paper", "hexahedron"},
                        HeatedMethod{"elements", "", "paper", "lagrange hexahedron"},
                        HeatedMethod{"particles", "none"}, HeatedMethod{"particles", "paper"},
                        HeatedMethod{"particles", "fe matched"},
                        HeatedMethod{"particles", "affine"}, HeatedMethod{"coupled", "paper"},
                        HeatedMethod{"coupled", "phase"}, HeatedMethod{"coupled", "affine"},
                        HeatedMethod{"coupled", "affine", "trace"},
                        HeatedMethod{"coupled", "paper", "paper", "fully integrated hexahedron",
                                     true}));

  template <int dim>
  void expect_symmetric_and_not_negative(const HeatedMethod &method)
  {
    HeatedBody<dim> body(method, film_section + sky + flux);
    body.set_temperature([](const double *x) { return 6. + 2. * x[0]; });
    body.step->start(*body.model, 0.);
    NodalVector a = body.vector(), b = body.vector(), conducted_a = body.vector(),
                conducted_b = body.vector();
    fill(body, a, 0.3);
    fill(body, b, 1.7);
    ThermalModel<dim> &heat = body.heat();
    const NodalVector &x = body.model->state.position;
    heat.apply_conduction(x, heat.state.temperature, 0., a, conducted_a);
    heat.apply_conduction(x, heat.state.temperature, 0., b, conducted_b);
    const double aa = body.product(a, conducted_a), ab = body.product(a, conducted_b),
                 ba = body.product(b, conducted_a);
    EXPECT_GT(aa, 0.);
    EXPECT_NEAR(ab, ba, 1e-12 * aa);
  }

  template <int dim>
  void expect_derivative_of_the_heat_rate(const HeatedMethod &method)
  {
    if (method.has_tables)
      return; // the linear operator leaves dk/dθ out
    HeatedBody<dim> body(method, film_section + sky + flux + source);
    ThermalModel<dim> &heat = body.heat();
    const NodalVector &x = body.model->state.position;
    NodalVector direction = body.vector(), expected = body.vector(), field = body.vector(),
                middle = body.vector(), theta = body.vector();
    NodalVector rates[2] = {body.vector(Quantity::scalar), body.vector(Quantity::scalar)};
    fill(body, direction, 2.1);
    constexpr double h = 1e-3;
    std::vector<double> condition_heat(4, 0.);
    for (const int k : {0, 1})
    {
      for (unsigned int i = 0; i < theta.partition()->n_owned(); ++i)
        *theta.node(i) = 7. + (k == 0 ? -h : h) * *direction.node(i);
      heat.find_field(theta, field);
      heat.heat_rate(x, field, 0., rates[k], condition_heat);
    }
    for (unsigned int i = 0; i < theta.partition()->n_owned(); ++i)
      *theta.node(i) = 7.;
    heat.find_field(theta, middle);
    heat.apply_conduction(x, middle, 0., direction, expected);
    double error = 0;
    for (unsigned int i = 0; i < theta.partition()->n_owned(); ++i)
      error = std::max(
          error, std::abs((*rates[1].node(i) - *rates[0].node(i)) / (2. * h) + *expected.node(i)));
    EXPECT_LT(dealii::Utilities::MPI::max(error, MPI_COMM_WORLD),
              1e-8 * largest_magnitude(expected));
  }

  template <int dim>
  void expect_what_enters_to_be_what_is_gained(const HeatedMethod &method)
  {
    HeatedBody<dim> body(method, film_section + sky + flux + source);
    ThermalModel<dim> &heat = body.heat();
    body.set_temperature([](const double *x) { return 5. + disorder(x, 0.); });
    body.step->start(*body.model, 0.);
    const NodalVector &x = body.model->state.position;
    NodalVector field = body.vector(), rate = body.vector(Quantity::scalar);
    std::vector<double> condition_heat(4, 0.);
    heat.find_field(heat.state.unsmoothed_temperature, field);
    heat.heat_rate(x, field, 1., rate, condition_heat);
    double entered = 0, scale = 0;
    for (const double &rank_heat : condition_heat)
    {
      const double total_heat = dealii::Utilities::MPI::sum(rank_heat, MPI_COMM_WORLD);
      entered += total_heat;
      scale += std::abs(total_heat);
    }
    EXPECT_NEAR(sum_of_nodes(rate), entered, 1e-12 * scale);
    // Of the flux: a face of 1 (x 1) with the mean of 3 + y; of the source: twice 0.5 on 2 (x 1).
    const unsigned int flux_index = 2, source_index = 3;
    EXPECT_NEAR(dealii::Utilities::MPI::sum(condition_heat[flux_index], MPI_COMM_WORLD), 3.5,
                1e-12);
    EXPECT_NEAR(dealii::Utilities::MPI::sum(condition_heat[source_index], MPI_COMM_WORLD), 2.,
                1e-12);
  }

  template <int dim>
  void expect_conduction_to_turn_with_the_body(const HeatedMethod &method)
  {
    HeatedBody<dim> body(method);
    ThermalModel<dim> &heat = body.heat();
    NodalVector theta = body.vector(), field = body.vector(), turned;
    turned = body.model->state.position.copy();
    const double c = std::cos(0.7), s = std::sin(0.7);
    for (unsigned int i = 0; i < turned.partition()->n_local(); ++i)
    {
      const double *const x = body.model->state.position.node(i);
      turned.node(i)[0] = c * x[0] - s * x[1];
      turned.node(i)[1] = s * x[0] + c * x[1];
    }
    fill(body, theta, 0.9);
    heat.find_field(theta, field);
    NodalVector rate = body.vector(Quantity::scalar), turned_rate = body.vector(Quantity::scalar);
    std::vector<double> none;
    heat.heat_rate(body.model->state.position, field, 0., rate, none);
    heat.heat_rate(turned, field, 0., turned_rate, none);
    const double largest = largest_magnitude(rate);
    EXPECT_GT(largest, 1e-3);
    EXPECT_LE(tombolo::testing::largest_difference(turned_rate, rate), 1e-12 * largest);
  }

  template <int dim>
  void expect_uniform_temperature_to_stay(const HeatedMethod &method)
  {
    HeatedBody<dim> body(method);
    ThermalModel<dim> &heat = body.heat();
    NodalVector theta = body.vector(), field = body.vector(), rate = body.vector(Quantity::scalar);
    for (unsigned int i = 0; i < theta.partition()->n_owned(); ++i)
      *theta.node(i) = 1000.;
    std::vector<double> none;
    heat.find_field(theta, field);
    heat.heat_rate(body.model->state.position, field, 0., rate, none);
    for (unsigned int i = 0; i < theta.partition()->n_owned(); ++i)
    {
      EXPECT_NEAR(*field.node(i), 1000., 1e-10);
      EXPECT_NEAR(*rate.node(i), 0., 1e-10);
    }
  }
} // namespace

TEST_P(HeatOperators, are_symmetric_and_not_negative)
{
  expect_symmetric_and_not_negative<2>(GetParam());
  expect_symmetric_and_not_negative<3>(GetParam());
}

TEST_P(HeatOperators, are_the_derivative_of_the_heat_rate)
{
  expect_derivative_of_the_heat_rate<2>(GetParam());
  expect_derivative_of_the_heat_rate<3>(GetParam());
}

TEST_P(HeatOperators, give_to_nodes_what_enters)
{
  expect_what_enters_to_be_what_is_gained<2>(GetParam());
  expect_what_enters_to_be_what_is_gained<3>(GetParam());
}

TEST_P(HeatOperators, leave_a_uniform_temperature_alone)
{
  expect_uniform_temperature_to_stay<2>(GetParam());
  expect_uniform_temperature_to_stay<3>(GetParam());
}

TEST_P(HeatOperators, turn_with_the_body)
{
  expect_conduction_to_turn_with_the_body<2>(GetParam());
  expect_conduction_to_turn_with_the_body<3>(GetParam());
}

TEST_P(HeatOperators, interpolate_prescribed_temperatures_of_all_ranks)
{
  HeatedBody<2> body(GetParam(), "subsection Condition: held\nset Type = temperature\nset Where = "
                                 "y < 0.5\nset Function = 5\nend\n");
  ThermalModel<2> &heat = body.heat();
  NodalVector theta = body.vector(), field = body.vector(), smoothed = body.vector(),
              expected = body.vector();
  fill(body, theta, 0.4);
  heat.bridge.apply_smoothing(theta, smoothed);
  for (const unsigned int node : heat.conditions.constrained_nodes())
    *smoothed.node(node) = *theta.node(node);
  smoothed.update_ghosts();
  heat.bridge.load_transfer().interpolate(smoothed, expected);
  heat.find_field(theta, field);
  for (unsigned int i = 0; i < field.partition()->n_local(); ++i)
    EXPECT_EQ(*field.node(i), *expected.node(i));
}

TEST_P(HeatOperators, have_a_diagonal_with_the_films_of_all_ranks)
{
  HeatedBody<2> body(GetParam(),
                     "subsection Condition: below\nset Type = convection\nset Where = y < "
                     "1e-3\nset Film coefficient = 2\nset Ambient temperature = 1\nend\n");
  NodalVector field = body.vector(), diagonal = body.vector(Quantity::scalar);
  body.heat().conditions.update_areas(body.model->state.position);
  body.heat().add_film_diagonal(0., field, diagonal);
  EXPECT_NEAR(sum_of_nodes(diagonal), 2. * 2., 1e-12); // of a face of 2 (x 1)
}

TEST_P(HeatOperators, keep_the_balance_and_prescribed_temperatures_over_steps)
{
  for (const char *const integration : {"explicit", "backward Euler", "Crank-Nicolson"})
  {
    HeatedMethod method = GetParam();
    // Implicit steps exchange much: a few methods are enough.
    if (std::string(integration) != "explicit" && std::string(method.smoothing) != "affine")
      continue;
    method.integration = integration;
    HeatedBody<2> body(method, held_ever_hotter + sky + flux + source);
    body.step->start(*body.model, 0.);
    body.step->balance(*body.model);
    body.step->advance_to(*body.model, 0.06, 0.1); // amid a step
    const HeatBalance amid = body.step->balance(*body.model);
    EXPECT_LT(std::abs(amid.error), 1e-13) << integration;
    body.step->advance_to(*body.model, 0.1, 0.1);
    const HeatBalance end = body.step->balance(*body.model);
    EXPECT_LT(std::abs(end.error), 1e-13) << integration;
    EXPECT_GT(std::abs(end.heat["heat through held_ever_hotter"]), 0.05) << integration;
    EXPECT_GT(end.heat["enthalpy"], 0.2) << integration;
    for (const unsigned int node : body.heat().conditions.constrained_nodes())
      EXPECT_NEAR(*body.heat().state.unsmoothed_temperature.node(node), 6., 1e-12);
  }
}

TEST(ExplicitHeat, is_stable_just_below_the_spectral_limit_and_not_above)
{
  for (const char *const smoothing : {"paper", "affine"})
  {
    HeatedBody<2> body({"coupled", smoothing}, film_section);
    ThermalModel<2> &heat = body.heat();
    body.step->start(*body.model, 0.);
    body.step->allowed_step(*body.model);
    const double limit = body.step->limit().time_step;
    for (const double factor : {0.995, 1.03})
    {
      NodalVector theta = body.vector(), rate = body.vector();
      fill(body, theta, 0.7);
      double first = 0, last = 0;
      for (unsigned int n = 0; n < 600; ++n)
      {
        heat.apply_conduction(body.model->state.position, heat.state.temperature, 0., theta, rate);
        last = 0;
        for (unsigned int i = 0; i < theta.partition()->n_owned(); ++i)
        {
          *theta.node(i) -= factor * limit * *rate.node(i) / heat.nodal_enthalpy.capacity(i, 5.);
          last = std::max(last, std::abs(*theta.node(i)));
        }
        theta.update_ghosts();
        if (n == 0)
          first = dealii::Utilities::MPI::max(last, MPI_COMM_WORLD);
      }
      last = dealii::Utilities::MPI::max(last, MPI_COMM_WORLD);
      if (factor < 1.)
        EXPECT_LT(last, 2. * first) << smoothing;
      else
        EXPECT_GT(last, 100. * first) << smoothing;
    }
  }
}

TEST(NodalEnthalpy, of_two_materials_has_an_inverse)
{
  HeatedBody<2> body({"coupled", "affine", "paper", "fully integrated hexahedron", true});
  const NodalEnthalpy &enthalpy = body.heat().nodal_enthalpy;
  for (unsigned int i = 0; i < body.model->state.partition()->n_owned(); ++i)
    for (const double temperature : {-4., 0., 4.99, 5., 5.01, 10., 19.7, 40.})
    {
      const double h = enthalpy.enthalpy(i, temperature);
      EXPECT_NEAR(enthalpy.temperature(i, h), temperature, 1e-12 * 40.);
      EXPECT_NEAR(
          (enthalpy.enthalpy(i, temperature + 1e-4) - enthalpy.enthalpy(i, temperature - 1e-4)) /
              2e-4,
          enthalpy.capacity(i, temperature), 1e-3 * enthalpy.capacity(i, temperature));
    }
}
