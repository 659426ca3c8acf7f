// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include "frozen_blocks.h"

#include <gtest/gtest.h>

#include <iostream>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  template <int dim>
  void expect_within(const Block &block)
  {
    FrozenBody<dim> body(block);
    const double estimate = body.estimator->estimate(*body.model).time_step;
    const unsigned int n_first = body.estimator->n_applications();
    const double again = body.estimator->estimate(*body.model).time_step;
    const unsigned int n_again = body.estimator->n_applications();
    // The eigenvalues are costly, and are those of one rank, where the estimate is compared with
    // them.
    if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
    {
      FrozenBody<dim> alone(block, MPI_COMM_SELF);
      EXPECT_NEAR(estimate / alone.estimator->estimate(*alone.model).time_step, 1., 1e-9);
      EXPECT_NEAR(again / alone.estimator->estimate(*alone.model).time_step, 1., 1e-5);
      return;
    }
    const double limit = body.limit_by_eigenvalues();
    std::cout << "limit " << limit << ", estimate / limit " << estimate / limit << ", again "
              << again / limit << ", applications " << n_first << " and " << n_again << std::endl;
    EXPECT_GE(estimate / limit, 0.98);
    EXPECT_LE(estimate / limit, 1.00);
    EXPECT_GE(again / limit, 0.98);
    EXPECT_LE(again / limit, 1.00);
  }

  class ThreeDimensionalBlock : public ::testing::TestWithParam<Block>
  {};
  class PlaneBlock : public ::testing::TestWithParam<Block>
  {};
} // namespace

TEST_P(ThreeDimensionalBlock, spectral_step_is_within_two_percent_below_the_true_limit)
{
  expect_within<3>(GetParam());
}

TEST_P(PlaneBlock, spectral_step_is_within_two_percent_below_the_true_limit)
{
  expect_within<2>(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    elements, ThreeDimensionalBlock,
    ::testing::Values(elements("hexahedron", "", 0.3),
                      elements("fully integrated hexahedron", "", 0.),
                      elements("fully integrated hexahedron", "", 0.49),
                      elements("lagrange hexahedron", "set Degree = 2", 0.3, {3, 2, 2}),
                      elements("lagrange hexahedron", "set Degree = 3", 0.3, {2, 2, 1})));

INSTANTIATE_TEST_SUITE_P(
    particles, ThreeDimensionalBlock,
    ::testing::Values(particles("1.2", "paper", 0.3), particles("1.2", "none", 0.),
                      particles("1.5", "affine", 0.49), particles("1.8", "paper", 0.),
                      particles("1.8", "paper", 0.49), particles("1.8", "affine", 0.3),
                      particles("1.8", "fe matched", 0.49), particles("1.8", "none", 0.3),
                      particles("1.9", "phase", 0.), particles("2.2", "affine", 0.49),
                      particles("2.5", "paper", 0.3)));

INSTANTIATE_TEST_SUITE_P(coupled, ThreeDimensionalBlock,
                         ::testing::Values(coupled("paper", "paper", 0.),
                                           coupled("affine", "paper", 0.3),
                                           coupled("affine", "trace", 0.3),
                                           coupled("fe matched", "trace", 0.49),
                                           coupled("paper", "trace", 0.3)));

INSTANTIATE_TEST_SUITE_P(
    clamped_or_disordered, ThreeDimensionalBlock,
    ::testing::Values(with(particles("1.8", "paper", 0.49), clamped, "", {6, 5, 5}),
                      with(particles("1.8", "affine", 0.49), clamped, "", {4, 4, 3}),
                      with(particles("1.8", "fe matched", 0.49), clamped, "", {4, 4, 3}),
                      with(coupled("paper", "paper", 0.3), clamped, "", {6, 5, 5}),
                      with(elements("hexahedron", "", 0.3), clamped, "", {6, 5, 5}),
                      with(particles("1.8", "affine", 0.3), "", "set Disorder = 0.2", {6, 5, 5}),
                      with(coupled("affine", "trace", 0.3), "", "set Disorder = 0.2", {6, 5, 5})));

INSTANTIATE_TEST_SUITE_P(
    plane, PlaneBlock,
    ::testing::Values(elements("hexahedron", "", 0.3, {12, 9}),
                      elements("fully integrated hexahedron", "", 0.49, {12, 9}),
                      elements("lagrange hexahedron", "set Degree = 3", 0.3, {4, 3}),
                      with(particles("1.5", "paper", 0.3), "", "", {14, 11}),
                      with(particles("1.8", "affine", 0.49), "", "", {14, 11}),
                      with(particles("1.8", "paper", 0.), clamped, "", {14, 11}),
                      with(coupled("affine", "trace", 0.3), "", "", {14, 11})));

TEST(SpectralEstimator, follows_the_limit_from_one_end_of_the_body_to_the_other)
{
  // The position that limits the step jumps while the last mode is nowhere near it.
  const Block block = particles("1.8", "affine", 0.3);
  FrozenBody<3> body(block), alone(block, MPI_COMM_SELF);
  const auto squeeze = [](FrozenBody<3> &squeezed, const bool squeezes_the_left)
  {
    NodalVector &x = squeezed.model->state.position;
    const NodalVector &initial = squeezed.model->state.initial_position;
    for (unsigned int i = 0; i < x.partition()->n_local(); ++i)
    {
      const double X = initial.node(i)[0];
      const double from_end = squeezes_the_left ? X : 6. - X;
      const double way = from_end < 2. ? 0.015 * (2. - from_end) * (2. - from_end) : 0.;
      x.node(i)[0] = X + (squeezes_the_left ? way : -way);
    }
    squeezed.keep_configuration();
  };
  for (const bool squeezes_the_left : {true, false})
  {
    squeeze(body, squeezes_the_left);
    const StepLimit estimate = body.estimator->estimate(*body.model);
    EXPECT_EQ(estimate.position[0] < 3., squeezes_the_left);
    if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
    {
      squeeze(alone, squeezes_the_left);
      const StepLimit alone_limit = alone.estimator->estimate(*alone.model);
      EXPECT_NEAR(estimate.position[0], alone_limit.position[0],
                  1e-12); // corners at one end are alike
      EXPECT_NEAR(estimate.time_step / alone_limit.time_step, 1., 1e-5);
      continue;
    }
    const double limit = body.limit_by_eigenvalues();
    EXPECT_GE(estimate.time_step / limit, 0.98);
    EXPECT_LE(estimate.time_step / limit, 1.00);
  }
}

TEST(SpectralEstimator, names_the_same_entity_and_place_on_any_number_of_ranks)
{
  // All eight corners of the cube are alike.
  for (const Block &block :
       {coupled("affine", "paper", 0.3), with(particles("1.8", "paper", 0.49), "", "", {5, 5, 5})})
  {
    FrozenBody<3> shared(block), alone(block, MPI_COMM_SELF);
    const StepLimit shared_limit = shared.estimator->estimate(*shared.model);
    const StepLimit alone_limit = alone.estimator->estimate(*alone.model);
    EXPECT_EQ(shared_limit.entity, alone_limit.entity);
    EXPECT_LT(shared_limit.position.distance(alone_limit.position), 1e-12);
    EXPECT_NEAR(shared_limit.time_step, alone_limit.time_step, 1e-9);
  }
}
