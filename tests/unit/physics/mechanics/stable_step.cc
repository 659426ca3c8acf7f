// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include "frozen_body.h"

#include <gtest/gtest.h>

#include <iostream>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  Block particles(const std::string &dilation, const std::string &smoothing, const double poisson)
  {
    Block block;
    block.options = "set Dilation = " + dilation + "\nset Smoothing = " + smoothing;
    block.poisson = poisson;
    return block;
  }

  Block elements(const std::string &name, const std::string &options, const double poisson,
                 const std::vector<unsigned int> &cells = {6, 5, 5})
  {
    Block block;
    block.formulation = name;
    block.options = options;
    block.poisson = poisson;
    block.cells = cells;
    return block;
  }

  Block coupled(const std::string &smoothing, const std::string &bridge, const double poisson,
                const std::string &element = "fully integrated hexahedron")
  {
    Block block = particles("1.8", smoothing, poisson);
    block.formulation = "coupled";
    block.bridge = bridge;
    block.element = element;
    return block;
  }

  const char *const clamped =
      "set Conditions = c\nsubsection Condition: c\nset Type = clamp\nset Where = x < 1e-9\nend\n";

  Block with(Block block, const std::string &conditions, const std::string &mesh_options,
             const std::vector<unsigned int> &cells)
  {
    block.conditions = conditions;
    block.mesh_options = mesh_options;
    block.cells = cells;
    return block;
  }

  template <int dim>
  void expect_within(const Block &block)
  {
    FrozenBody<dim> body(block);
    const double estimate = body.estimator->estimate(*body.model).time_step;
    const unsigned int n_first = body.estimator->n_applications();
    const double again = body.estimator->estimate(*body.model).time_step;
    const unsigned int n_again = body.estimator->n_applications();
    // The eigenvalues take long, and are those of one rank, where the estimate is compared with
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
    ::testing::Values(elements("hexahedron", "set Hourglass = stiffness", 0.3),
                      elements("hexahedron", "set Hourglass = viscous", 0.3, {4, 3, 3}),
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

class SteppedBlock : public ::testing::TestWithParam<Block>
{};

TEST_P(SteppedBlock, bisection_of_the_stepping_finds_the_limit_of_the_eigenvalues)
{
  FrozenBody<3> body(GetParam());
  const double limit = body.limit_by_eigenvalues();
  EXPECT_NEAR(body.limit_by_stepping(limit, 4e-3, 400) / limit, 1., 4e-3);
}

INSTANTIATE_TEST_SUITE_P(
    some, SteppedBlock,
    ::testing::Values(
        with(elements("hexahedron", "set Hourglass = stiffness", 0.3), "", "", {3, 3, 2}),
        with(elements("hexahedron", "set Hourglass = viscous", 0.3), "", "", {3, 3, 2}),
        with(particles("1.8", "paper", 0.3), "", "", {4, 4, 3}),
        with(particles("1.8", "paper", 0.49), clamped, "", {4, 4, 3}),
        with(particles("1.8", "affine", 0.49), clamped, "", {4, 4, 3}),
        with(particles("1.8", "fe matched", 0.49), clamped, "", {4, 4, 3}),
        with(particles("1.5", "fe matched", 0.3), "", "set Disorder = 0.2", {4, 4, 3}),
        with(coupled("affine", "trace", 0.3), "", "", {4, 4, 3})));

TEST(SpectralEstimator, follows_the_limit_from_one_end_of_the_body_to_the_other)
{
  // The place that limits the step jumps while the last mode is nowhere near it.
  FrozenBody<3> body(particles("1.8", "affine", 0.3));
  NodalVector &x = body.model->state.position;
  const NodalVector &initial = body.model->state.initial_position;
  dealii::Point<3> first_place;
  for (const bool squeezes_the_left : {true, false})
  {
    for (unsigned int i = 0; i < x.partition()->n_local(); ++i)
    {
      const double X = initial.node(i)[0];
      const double from_end = squeezes_the_left ? X : 6. - X;
      const double squeeze = from_end < 2. ? 0.015 * (2. - from_end) * (2. - from_end) : 0.;
      x.node(i)[0] = X + (squeezes_the_left ? squeeze : -squeeze);
    }
    body.keep_configuration();
    const StepLimit estimate = body.estimator->estimate(*body.model);
    const double limit = body.limit_by_eigenvalues();
    EXPECT_GE(estimate.time_step / limit, 0.98);
    EXPECT_LE(estimate.time_step / limit, 1.00);
    EXPECT_EQ(estimate.place[0] < 3., squeezes_the_left);
  }
}

TEST(SpectralEstimator, names_the_same_entity_and_place_on_any_number_of_ranks)
{
  // All eight corners of the cube are alike.
  for (const Block &block :
       {coupled("affine", "paper", 0.3), with(particles("1.8", "paper", 0.49), "", "", {5, 5, 5})})
  {
    FrozenBody<3> shared(block), alone(block, MPI_COMM_SELF);
    const StepLimit of_shared = shared.estimator->estimate(*shared.model);
    const StepLimit of_alone = alone.estimator->estimate(*alone.model);
    EXPECT_EQ(of_shared.entity, of_alone.entity);
    EXPECT_LT(of_shared.place.distance(of_alone.place), 1e-12);
    EXPECT_NEAR(of_shared.time_step, of_alone.time_step, 1e-9);
  }
}

TEST(CourantEstimator, is_unsafe_at_free_corners_of_nearly_incompressible_particles)
{
  FrozenBody<3> body(particles("1.8", "paper", 0.49));
  EXPECT_NEAR(courant_limit(*body.model).time_step, 1.8, 1e-12);
  EXPECT_LT(body.limit_by_eigenvalues(), 0.9 * 1.8);
}
