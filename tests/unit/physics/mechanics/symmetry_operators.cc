// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <tombolo/physics/mechanics/spectral_estimator.h>

#include <smoothing_identities.h>
#include <symmetric_body.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  /** A symmetric field without any other order. */
  template <int dim>
  NodalVector symmetric_noise(const Model<dim> &model, const unsigned int seed)
  {
    return vector_field(
        model,
        [&](const double *const x, const unsigned int d)
        {
          const double value = std::sin(91.7 * std::abs(x[0]) + 57.3 * std::abs(x[1]) +
                                        31.1 * x[2] + 17. * d + seed);
          return d == 2 ? value : std::abs(x[d]) < 1e-9 ? 0. : std::copysign(1., x[d]) * value;
        });
  }

  template <int dim>
  void deform(Model<dim> &model)
  {
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      const double *const X = model.state.initial_position.node(i);
      double *const x = model.state.position.node(i);
      x[0] = X[0] * (1.3 + 0.1 * X[0] * X[0] + 0.2 * X[1] * X[1]);
      x[1] = X[1] * (0.8 - 0.2 * X[0] * X[0]);
      x[2] = 1.1 * X[2] + 0.1 * X[1] * X[1] - 0.2 * X[0] * X[0];
    }
    model.state.position.update_ghosts();
    for (Part<dim> &part : model.parts)
      if (part.particles != nullptr)
        part.particles->stencils().inverse_deformation_is_current = false;
  }

  class SymmetricOperators : public ::testing::TestWithParam<Method>
  {};

  INSTANTIATE_TEST_SUITE_P(Methods, SymmetricOperators,
                           ::testing::Values(Method{"paper"}, Method{"fe matched"},
                                             Method{"affine"}, Method{"affine", "paper"},
                                             Method{"affine", "", "0", false, "never"},
                                             Method{"affine", "paper", "0", false, "never"},
                                             Method{"fe matched", "trace"}));
} // namespace

TEST_P(SymmetricOperators, are_those_of_the_whole_body)
{
  Body<3> quarter(quarter_3d, GetParam()), whole(whole_3d, GetParam());
  std::array<Body<3>::Records, 2> smoothed, interpolated, short_waves, nodal_mass, mass;
  unsigned int b = 0;
  for (Body<3> *body : {&quarter, &whole})
  {
    Model<3> &model = *body->model;
    deform(model);
    const NodalVector field = symmetric_noise(model, 1);
    NodalVector result(model.state.partition());
    model.bridge->apply_smoothing(field, result);
    smoothed[b] = body->values_at_nodes({&result});
    model.bridge->apply_adjoint(field, result);
    interpolated[b] = body->values_at_nodes({&result});
    model.bridge->apply_short_wave_part(field, result);
    short_waves[b] = body->values_at_nodes({&result});
    nodal_mass[b] = body->values_at_nodes({&model.bridge->nodal_mass()});
    mass[b] = body->values_at_nodes({&model.bridge->mass()});
    ++b;
  }
  EXPECT_LT(difference(smoothed[0], smoothed[1]), 1e-13);
  EXPECT_LT(difference(interpolated[0], interpolated[1]), 1e-13);
  EXPECT_LT(difference(short_waves[0], short_waves[1]), 1e-13);
  // A node on a plane has the half of its mass, one on two planes a quarter.
  for (auto *of : {&nodal_mass, &mass})
  {
    for (auto &[key, values] : (*of)[0])
      for (double &value : values)
        value *= (key[0] == 0 ? 2. : 1.) * (key[1] == 0 ? 2. : 1.);
    EXPECT_LT(difference((*of)[0], (*of)[1]), 1e-13);
  }
}

TEST_P(SymmetricOperators, smoothing_and_its_adjoint_are_adjoint_in_the_two_masses)
{
  Body<3> body(quarter_3d, GetParam());
  Model<3> &model = *body.model;
  deform(model);
  expect_adjoint_smoothing(model, symmetric_noise(model, 1), symmetric_noise(model, 5));
}

TEST_P(SymmetricOperators, smoothing_keeps_what_is_constant_along_the_planes_and_its_momentum)
{
  Body<3> body(quarter_3d, GetParam());
  Model<3> &model = *body.model;
  deform(model);
  const NodalVector one =
      vector_field(model, [](const double *, const unsigned int d) { return d == 2 ? 1. : 0.; });
  NodalVector result(model.state.partition());
  model.bridge->apply_smoothing(one, result);
  for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
  {
    EXPECT_NEAR(result.node(i)[2], 1., 1e-13);
    EXPECT_NEAR(result.node(i)[0], 0., 1e-13);
  }

  const bool is_affine = std::string(GetParam().smoothing) == "affine";
  if (is_affine)
  {
    // S X = X, which is symmetric in the planes through the origin.
    const NodalVector linear =
        vector_field(model, [](const double *const x, const unsigned int d) { return x[d]; });
    model.bridge->apply_smoothing(linear, result);
    EXPECT_LE(largest_difference(result, linear), 1e-13);
  }
  const NodalVector v_hat = symmetric_noise(model, 3);
  model.bridge->apply_smoothing(v_hat, result);
  const double before = weighted_product(model.bridge->mass(), one, v_hat);
  const double after = weighted_product(model.bridge->nodal_mass(), one, result);
  EXPECT_NEAR(before, after, 1e-13 * weighted_product(model.bridge->mass(), one, one));
  EXPECT_GT(std::abs(before), 1e-3);
}

TEST(SymmetricModels, what_images_and_ghosts_give_back_is_the_transpose_of_what_they_get)
{
  Body<3> body(quarter_3d, Method{"affine"});
  const Model<3> &model = *body.model;
  const auto &partition = *model.state.partition();
  const NodalVector known = symmetric_noise(model, 1);
  NodalVector given(model.state.partition());
  double at_all = 0, at_owners = 0, size = 0;
  for (unsigned int i = 0; i < partition.n_local(); ++i)
    for (unsigned int d = 0; d < 3; ++d)
    {
      given.node(i)[d] = std::sin(7.3 * i + 3.1 * d);
      at_all += given.node(i)[d] * known.node(i)[d];
      size += std::abs(given.node(i)[d] * known.node(i)[d]);
    }
  given.add_to_owners();
  for (unsigned int i = 0; i < partition.n_owned(); ++i)
    for (unsigned int d = 0; d < 3; ++d)
    {
      at_owners += given.node(i)[d] * known.node(i)[d];
      const bool is_on_plane = d < 2 && model.state.initial_position.node(i)[d] == 0.;
      if (is_on_plane)
      {
        EXPECT_EQ(given.node(i)[d], 0.);
      }
    }
  EXPECT_GT(dealii::Utilities::MPI::sum(partition.n_images(), MPI_COMM_WORLD), 0u);
  const auto over_ranks = [](const double value)
  { return dealii::Utilities::MPI::sum(value, MPI_COMM_WORLD); };
  EXPECT_NEAR(over_ranks(at_all), over_ranks(at_owners), 1e-13 * over_ranks(size));
}

TEST(SymmetricModels, energies_of_half_a_block_are_half_of_the_whole)
{
  const Method method{"affine", "paper", "4", true};
  Body<3> half(half_3d, method), whole(whole_3d, method);
  for (Body<3> *body : {&half, &whole})
  {
    body->set_velocity(0.12);
    body->balance();
    body->run(0.04);
  }
  const EnergyBalance a = half.balance(), b = whole.balance();
  const double scale = b.total;
  EXPECT_NEAR(2. * a.energies["kinetic energy"], b.energies["kinetic energy"], 1e-10 * scale);
  EXPECT_NEAR(2. * a.energies["elastic energy"], b.energies["elastic energy"], 1e-10 * scale);
  EXPECT_NEAR(2. * a.energies["filter dissipation"], b.energies["filter dissipation"],
              1e-10 * scale);
  EXPECT_NEAR(2. * a.energies["external work"], b.energies["external work"], 1e-10 * scale);
  EXPECT_GT(std::abs(b.energies["external work"]), 1e-3 * scale);
  EXPECT_NEAR(a.error, b.error, 1e-10);
  EXPECT_NEAR(2. * a.momentum[2], b.momentum[2], 1e-10 * b.momentum_scale);
  EXPECT_NEAR(2. * a.impulse[2], b.impulse[2], 1e-10 * b.momentum_scale);
  EXPECT_NEAR(a.momentum_drift, b.momentum_drift, 1e-10);
}

TEST(SymmetricModels, momentum_along_the_planes_is_kept)
{
  Body<3> body(quarter_3d, Method{"affine"});
  body.set_velocity(0.12);
  body.balance();
  body.run(0.04);
  const EnergyBalance balance = body.balance();
  EXPECT_LT(balance.momentum_drift, 1e-12);
  // What the planes push is no impulse that is booked, and no drift.
  EXPECT_GT(std::abs(balance.momentum[0]), 1e-3 * balance.momentum_scale);
}

TEST(SymmetricModels, nodes_stay_on_their_planes_and_no_other_reaches_them)
{
  Body<3> body(quarter_3d, Method{"paper"});
  body.set_velocity(0.12);
  body.run(0.04);
  const NodalState &state = body.model->state;
  for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
    for (unsigned int d = 0; d < 2; ++d)
      if (state.initial_position.node(i)[d] == 0.)
      {
        EXPECT_EQ(state.position.node(i)[d], 0.);
        EXPECT_EQ(state.velocity.node(i)[d], 0.);
        EXPECT_EQ(state.unsmoothed_velocity.node(i)[d], 0.);
      }
      else
        EXPECT_GT(state.position.node(i)[d], 0.01);
}

TEST(SymmetricModels, the_spectral_step_is_that_of_symmetric_modes)
{
  for (const Method &method : {Method{"paper"}, Method{"affine", "paper"}})
  {
    std::array<double, 2> limit;
    unsigned int b = 0;
    for (const SymmetricBlock *block : {&quarter_3d, &whole_3d})
    {
      Body<3> body(*block, method);
      SpectralEstimator<3> estimator(body.parameters.section("Time step").subsection("spectral"));
      limit[b++] = estimator.estimate(*body.model).time_step;
    }
    // A mode at one corner of the block is nearly the sum of a symmetric one and others.
    EXPECT_GT(limit[0], 0.99 * limit[1]);
    EXPECT_LT(limit[0], 1.05 * limit[1]);
  }
}
