// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
#include <tombolo/physics/heat/growing_rates.h>

#include <heated_body.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  const HeatedMethod coupled = {"coupled", "affine"};

  std::string film(const std::string &coefficient)
  {
    return "subsection Condition: air\nset Type = convection\nset Where = x < 1e-3\nset Film "
           "coefficient = " +
           coefficient + "\nset Ambient temperature = 1\nend\n";
  }

  double disorder(const double *x)
  {
    return std::sin(91.7 * x[0] + 57.3 * x[1]);
  }

  /** The largest stable step, of the spectrum. */
  double stable_step(HeatedBody<2> &body)
  {
    body.step->start(*body.model, 0.);
    body.step->allowed_step(*body.model);
    return body.step->limit().time_step / 0.994;
  }

  double largest_difference(const HeatedBody<2> &body, const double temperature)
  {
    double largest = 0;
    for (unsigned int i = 0; i < body.model->state.partition()->n_owned(); ++i)
      largest = std::max(
          largest, std::abs(*body.model->heat->state.unsmoothed_temperature.node(i) - temperature));
    return dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD);
  }
} // namespace

TEST(GrowingRates, have_an_eigenvalue_of_the_operator_when_they_have_doubled)
{
  HeatedBody<2> body(coupled, film("2"));
  const double largest = 2. / stable_step(body);
  NodalVector rate = body.vector(Quantity::scalar);
  const auto eigenvalue = [&](GrowingRates<2> &rates, const double factor)
  {
    NodalVector scaled = body.vector(Quantity::scalar);
    for (unsigned int i = 0; i < rate.partition()->n_owned(); ++i)
      *scaled.node(i) = factor * *rate.node(i);
    return rates.find_eigenvalue(*body.model, 0., scaled, 1.);
  };
  const auto set_rate = [&](const auto &function)
  {
    for (unsigned int i = 0; i < rate.partition()->n_owned(); ++i)
      *rate.node(i) = body.heat().nodal_enthalpy.capacity(i, 5.) *
                      function(body.model->state.initial_position.node(i));
  };

  GrowingRates<2> rates;
  set_rate(disorder);
  EXPECT_EQ(eigenvalue(rates, 1.), 0.);
  EXPECT_EQ(eigenvalue(rates, 1.9), 0.);
  const double first = eigenvalue(rates, 2.1);
  EXPECT_LT(first, 1.001 * largest);
  NodalVector direction = body.vector(), image = body.vector(), image_rate = body.vector();
  for (unsigned int i = 0; i < rate.partition()->n_owned(); ++i)
    *direction.node(i) = disorder(body.model->state.initial_position.node(i));
  direction.update_ghosts();
  body.heat().apply_conduction(body.model->state.position, body.heat().state.temperature, 0.,
                               direction, image);
  for (unsigned int i = 0; i < rate.partition()->n_owned(); ++i)
    *image_rate.node(i) = *image.node(i) / body.heat().nodal_enthalpy.capacity(i, 5.);
  const double quotient = body.product(image, image_rate) / body.product(direction, image);
  EXPECT_GT(quotient, 0.2 * largest);
  EXPECT_NEAR(first, quotient, 1e-12 * quotient);
  EXPECT_EQ(eigenvalue(rates, 3.), 0.);
  EXPECT_EQ(eigenvalue(rates, 2.), 0.);
  EXPECT_EQ(eigenvalue(rates, 4.05), 0.); // twice 2, but 2 has not lasted
  for (unsigned int n = 0; n < 30; ++n)
    EXPECT_EQ(eigenvalue(rates, 2.), 0.);
  EXPECT_NEAR(eigenvalue(rates, 4.1), first, 1e-12 * first);
  for (double factor = 4.2; factor < 8.1; factor += 0.1)
    EXPECT_EQ(eigenvalue(rates, factor), 0.);
  EXPECT_NEAR(eigenvalue(rates, 8.3), first, 1e-12 * first);

  // Round-off that grows is none of a mode.
  GrowingRates<2> round_off_rates;
  for (const double factor : {1e-16, 1e-14, 1e-12, 4e-12})
    EXPECT_EQ(eigenvalue(round_off_rates, factor), 0.) << factor;
  EXPECT_GT(eigenvalue(round_off_rates, 1e-10), 0.);

  // Rates that are the same everywhere, where nothing enters, are round-off, too.
  HeatedBody<2> isolated(coupled);
  isolated.step->start(*isolated.model, 0.);
  GrowingRates<2> isolated_rates;
  for (const double factor : {1., 3.})
  {
    NodalVector uniform = isolated.vector(Quantity::scalar);
    for (unsigned int i = 0; i < uniform.partition()->n_owned(); ++i)
      *uniform.node(i) = factor * isolated.heat().nodal_enthalpy.capacity(i, 5.);
    EXPECT_EQ(isolated_rates.find_eigenvalue(*isolated.model, 0., uniform, 1.), 0.);
  }
}

TEST(GrowingRates, shorten_steps_of_the_spectrum_before_a_film_that_comes_does_harm)
{
  for (const char *const parts : {"elements", "particles", "coupled"})
    for (const char *const coefficient : {"2 + 1e2*(t > 0.1)", "2 + 1e5*(t > 0.1)"})
    {
      HeatedBody<2> body({parts, "affine"}, film(coefficient));
      body.step->start(*body.model, 0.);
      double largest = 0;
      for (unsigned int n = 1; n <= 40; ++n)
      {
        const double time = n < 20 ? 0.005 * n : 0.1 + 5e-5 * (n - 20);
        body.step->advance_to(*body.model, time, time);
        largest = std::max(largest, largest_difference(body, 5.));
      }
      // At 0.9 of the limit the surface may go beyond the ambient, four below, by 0.8 of it.
      EXPECT_LT(largest, 7.3) << parts << ' ' << coefficient;
      EXPECT_GT(largest, 1.) << parts << ' ' << coefficient;
    }
}
