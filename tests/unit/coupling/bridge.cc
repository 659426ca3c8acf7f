// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
#include "model_scene.h"
#include "smoothing_identities.h"
#include <tombolo/physics/mechanics/loads.h>
#include <tombolo/physics/mechanics/rigid_contacts.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <ostream>
#include <string>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  struct Case
  {
    const char *smoothing;
    const char *bridge;
  };

  std::ostream &operator<<(std::ostream &out, const Case &parameter)
  {
    return out << parameter.smoothing << ", " << parameter.bridge << " bridge";
  }

  /** A block, half elements and half particles, disordered, deformed by hand afterwards. */
  std::string block(const std::string &smoothing, const std::string &bridge, const int dim,
                    const std::string &conditions = "")
  {
    const std::string corner = dim == 2 ? "1.4, 1.2" : "1.4, 1.2, 1";
    const std::string cells = dim == 2 ? "7, 6" : "7, 6, 5";
    return "set Dimension = " + std::to_string(dim) + "\nset Parts = a, b\nset Materials = m\n" +
           conditions +
           "subsection Mesh\nset Type = box\nsubsection box\nset Upper corner = " + corner +
           "\nset Cells = " + cells +
           "\nset Disorder = 0.2\nend\nend\n"
           "subsection Part: a\nset Cells = x < 0.6\nset Formulation = fully integrated "
           "hexahedron\n"
           "set Material = m\nend\n"
           "subsection Part: b\nset Cells = otherwise\nset Formulation = momentum consistent "
           "particle\n"
           "set Material = m\nsubsection momentum consistent particle\nset Smoothing = " +
           smoothing +
           "\nend\nend\n"
           "subsection Material: m\nset Model = elastic\nsubsection elastic\nset Density = 2\n"
           "set Young's modulus = 3\nset Poisson's ratio = 0.3\nend\nend\n"
           "subsection Coupling\nset Bridge = " +
           bridge + "\nend\n";
  }

  double noise(const double *x, const unsigned int seed)
  {
    return std::sin(91.7 * x[0] + 57.3 * x[1] + 31.1 * x[2] + 17. * seed) *
           std::cos(23.9 * x[0] * x[1] + 5. * seed);
  }

  template <int dim>
  NodalVector noise_field(const Model<dim> &model, const unsigned int seed)
  {
    return vector_field(model, [&](const double *const x, const unsigned int d)
                        { return noise(x, seed + d); });
  }
  /** A finite, not affine deformation. */
  template <int dim>
  void deform(Model<dim> &model)
  {
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      const double *const X = model.state.initial_position.node(i);
      double *const x = model.state.position.node(i);
      x[0] = 1.3 * X[0] + 0.2 * X[1] + 0.05 * X[0] * X[1];
      x[1] = 0.9 * X[1] - 0.3 * X[0] + 0.04 * X[0] * X[0];
      if (dim == 3)
        x[2] = 1.1 * X[2] + 0.1 * X[1] * X[0];
    }
    model.state.position.update_ghosts();
    for (Part<dim> &part : model.parts)
      if (part.particles != nullptr)
        part.particles->stencils().inverse_deformation_is_current = false;
  }

  class BridgeIdentities : public ::testing::TestWithParam<Case>
  {};
} // namespace

TEST_P(BridgeIdentities, smoothing_and_its_adjoint_are_adjoint_in_the_two_masses)
{
  const auto model = make_model<3>(block(GetParam().smoothing, GetParam().bridge, 3));
  deform(*model);
  expect_adjoint_smoothing(*model, noise_field(*model, 1), noise_field(*model, 7));
}

TEST_P(BridgeIdentities, momentum_is_the_same_before_and_after_smoothing)
{
  const auto model = make_model<2>(block(GetParam().smoothing, GetParam().bridge, 2));
  deform(*model);
  const NodalVector v_hat = noise_field(*model, 3);
  const NodalVector one =
      vector_field(*model, [](const double *, const unsigned int d) { return d == 0 ? 1. : 0.; });
  NodalVector smoothed(model->state.partition());
  model->bridge->apply_smoothing(v_hat, smoothed);
  const double before = weighted_product(model->bridge->mass(), one, v_hat);
  const double after = weighted_product(model->bridge->nodal_mass(), one, smoothed);
  EXPECT_NEAR(before, after, 1e-13);
}

TEST_P(BridgeIdentities, a_uniform_velocity_stays_as_it_is)
{
  const auto model = make_model<3>(block(GetParam().smoothing, GetParam().bridge, 3));
  deform(*model);
  const NodalVector one =
      vector_field(*model, [](const double *, const unsigned int d) { return 1. + d; });
  NodalVector result(model->state.partition());
  model->bridge->apply_smoothing(one, result);
  EXPECT_LT(largest_difference(result, one), 1e-12);
  model->bridge->apply_adjoint(one, result);
  EXPECT_LT(largest_difference(result, one), 1e-12);

  const double mass = 2. * 1.4 * 1.2;
  EXPECT_NEAR(model->bridge->kinetic_energy(one), 0.5 * mass * (1. + 4. + 9.), 1e-12 * mass);
  EXPECT_NEAR(model->bridge->short_wave_share(one), 0., 1e-13);
}

INSTANTIATE_TEST_SUITE_P(all_smoothings, BridgeIdentities,
                         ::testing::Values(Case{"paper", "paper"}, Case{"fe matched", "paper"},
                                           Case{"phase", "paper"}, Case{"0.7", "paper"},
                                           Case{"affine", "paper"}, Case{"none", "paper"},
                                           Case{"paper", "trace"}, Case{"affine", "trace"},
                                           Case{"fe matched", "trace"}));

TEST(Bridge, affine_smoothing_reproduces_functions_that_are_linear_in_the_reference)
{
  const auto model = make_model<3>(block("affine", "paper", 3));
  deform(*model);
  const NodalVector linear =
      vector_field(*model,
                   [](const double *const x, const unsigned int d)
                   {
                     return std::array<double, 3>{{0.3 - 2. * x[1] + 0.7 * x[2], 2. * x[0] + x[1],
                                                   1. - x[2] + 0.4 * x[0]}}[d];
                   });
  NodalVector result(model->state.partition());
  model->bridge->apply_smoothing(linear, result);
  EXPECT_LT(largest_difference(result, linear), 1e-12);
}

TEST(Bridge, affine_positions_are_the_smoothed_ones_of_what_moves_with_v_hat)
{
  for (const char *const bridge : {"paper", "trace"})
  {
    const auto model = make_model<3>(block("affine", bridge, 3));
    NodalState &state = model->state;
    for (unsigned int step = 0; step < 3; ++step)
    {
      state.unsmoothed_velocity.copy_from(noise_field(*model, 4 + step));
      state.unsmoothed_velocity.update_ghosts();
      model->bridge->move_with_smoothed_velocity(state, 0.3 + 0.1 * step);
    }
    state.unsmoothed_position.update_ghosts();
    NodalVector smoothed(state.partition());
    model->bridge->apply_smoothing(state.unsmoothed_position, smoothed);
    EXPECT_LT(largest_difference(smoothed, state.position), 1e-13);
    EXPECT_GT(largest_difference(state.unsmoothed_position, state.position), 1e-2);
  }
}

TEST(Bridge, short_wave_part_is_self_adjoint_and_between_zero_and_one)
{
  const auto model = make_model<3>(block("paper", "paper", 3));
  const NodalVector a = noise_field(*model, 2), b = noise_field(*model, 5);
  NodalVector short_wave_a(model->state.partition()), short_wave_b(model->state.partition());
  model->bridge->apply_short_wave_part(a, short_wave_a);
  model->bridge->apply_short_wave_part(b, short_wave_b);
  const NodalVector &mass = model->bridge->mass();
  const double scale = weighted_product(mass, a, a);
  EXPECT_NEAR(weighted_product(mass, short_wave_a, b) / scale,
              weighted_product(mass, a, short_wave_b) / scale, 1e-13);
  EXPECT_GT(weighted_product(mass, short_wave_a, a), 0.);
  EXPECT_LT(weighted_product(mass, short_wave_a, a), scale);
}

TEST(Bridge, prescribed_components_keep_their_own_row)
{
  const auto model = make_model<3>(block(
      "affine", "paper", 3,
      "set Conditions = c\nsubsection Condition: c\nset Type = velocity\nset Where = x > 1.39\n"
      "set Function = 0.5; free; free\nend\n"));
  NodalVector field = noise_field(*model, 4), result(model->state.partition());
  model->bridge->apply_interpolation(field, result);
  unsigned int count = 0;
  for (unsigned int i = 0; i < model->state.partition()->n_owned(); ++i)
    if (model->state.initial_position.node(i)[0] > 1.39)
    {
      ++count;
      EXPECT_DOUBLE_EQ(result.node(i)[0], field.node(i)[0]);
      EXPECT_NE(result.node(i)[1], field.node(i)[1]);
    }
  EXPECT_GT(dealii::Utilities::MPI::sum(count, MPI_COMM_WORLD), 0u);

  NodalVector &v_hat = model->state.unsmoothed_velocity;
  v_hat.copy_from(noise_field(*model, 9));
  const NodalVector before = noise_field(*model, 9), change = noise_field(*model, 4);
  const double given = model->bridge->remove_from_velocity(field, model->state);
  double impulse = 0, work = 0;
  for (unsigned int i = 0; i < model->state.partition()->n_owned(); ++i)
    for (unsigned int d = 0; d < 3; ++d)
    {
      const bool is_kept = d == 0 && model->state.initial_position.node(i)[0] > 1.39;
      EXPECT_DOUBLE_EQ(v_hat.node(i)[d], before.node(i)[d] - (is_kept ? 0. : change.node(i)[d]));
      if (is_kept)
      {
        impulse += *model->bridge->mass().node(i) * change.node(i)[d];
        work += *model->bridge->mass().node(i) * change.node(i)[d] * before.node(i)[d];
      }
    }
  const ConstraintReaction reaction = model->bridge->extract_constraint_reaction();
  EXPECT_NEAR(given, work, 1e-13);
  EXPECT_NEAR(reaction.work, work, 1e-13);
  EXPECT_NEAR(reaction.impulse[0], impulse, 1e-13);
  EXPECT_NE(dealii::Utilities::MPI::sum(work, MPI_COMM_WORLD), 0.);
}

TEST(Bridge, loads_at_positions_keep_their_sum_in_nodal_forces)
{
  const auto model = make_model<3>(block(
      "affine", "paper", 3,
      "set Conditions = c\nsubsection Condition: c\nset Type = traction\nset Where = y < 1e-9\n"
      "set Function = 1; 2 + x; 3\nend\n"));
  auto &loads = *model->find_process<Loads<3>>();
  loads.act(*model, Clock(), model->state.force);
  double given[3] = {0, 0, 0}, taken[3] = {0, 0, 0};
  for (unsigned int i = 0; i < model->state.partition()->n_owned(); ++i)
    for (unsigned int d = 0; d < 3; ++d)
    {
      given[d] += loads.action().given().node(i)[d];
      taken[d] += loads.action().nodal_force(i)[d];
    }
  for (unsigned int d = 0; d < 3; ++d)
  {
    given[d] = dealii::Utilities::MPI::sum(given[d], MPI_COMM_WORLD);
    taken[d] = dealii::Utilities::MPI::sum(taken[d], MPI_COMM_WORLD);
    EXPECT_NEAR(given[d], taken[d], 1e-13);
  }
  EXPECT_NEAR(given[0], 1.4, 1e-12); // area of the face y = 0: 1.4 x 1
  EXPECT_NEAR(given[2], 4.2, 1e-12);
}

TEST(Bridge, contact_forces_keep_their_sum_in_nodal_forces)
{
  for (const char *const smoothing : {"paper", "affine"})
  {
    SCOPED_TRACE(smoothing);
    const auto model = make_model<3>(
        block(smoothing, "paper", 3,
              "set Contacts = wall\nsubsection Contact: wall\nset Surface = plane\n"
              "subsection plane\nset Point = 0, 0, 0\nset Normal = 0, 1, 0\nend\nend\n"));
    for (unsigned int i = 0; i < model->state.partition()->n_local(); ++i)
    {
      const double x = model->state.initial_position.node(i)[0];
      model->state.position.node(i)[1] -= 0.01 * (2. + std::sin(3. * x));
    }
    auto &contacts = *model->find_process<RigidContacts<3>>();
    Clock clock;
    clock.step = 1;
    clock.previous_step = clock.stable_step = 0.1;
    contacts.act(*model, clock, model->state.force);
    double taken = 0;
    for (unsigned int i = 0; i < model->state.partition()->n_owned(); ++i)
      taken += contacts.nodal_force(i)[1];
    const double given = contacts.balance().force[1];
    EXPECT_NEAR(dealii::Utilities::MPI::sum(taken, MPI_COMM_WORLD), given, 1e-13 * given);
    EXPECT_GT(given, 0.1);
  }
}
