// SPDX-License-Identifier: LGPL-2.1-or-later
// Eigenvalues and bisections of whole steps, on one rank: what ranks can change is in
// stable_step.cc.
#include "frozen_blocks.h"

#include <tombolo/physics/mechanics/spectral_estimator.h>

#include <gtest/gtest.h>

using namespace tombolo;
using namespace tombolo::testing;

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
    ::testing::Values(with(elements("hexahedron", "", 0.3), "", "", {3, 3, 2}),
                      with(particles("1.8", "paper", 0.3), "", "", {4, 4, 3}),
                      with(particles("1.8", "paper", 0.49), clamped, "", {4, 4, 3}),
                      with(particles("1.8", "affine", 0.49), clamped, "", {4, 4, 3}),
                      with(particles("1.8", "fe matched", 0.49), clamped, "", {4, 4, 3}),
                      with(particles("1.5", "fe matched", 0.3), "", "set Disorder = 0.2",
                           {4, 4, 3}),
                      with(coupled("affine", "trace", 0.3), "", "", {4, 4, 3})));

TEST(StepSize, is_estimated_again_where_cells_have_changed_by_the_threshold)
{
  const auto n_estimates = [](const std::string &threshold, const double factor)
  {
    Parameters parameters(MPI_COMM_WORLD);
    parameters.read_text(
        parameters_of(with(elements("hexahedron", "", 0.3), "", "", {2, 2, 2})) +
            "subsection Time step\nset Check interval = 1\nset Re-estimation threshold = " +
            threshold + "\nend\n",
        "test.prm");
    declare_model<3>(parameters);
    declare_section<StepSize<3>>(parameters, "Time step");
    parameters.assign();
    Model<3> model(parameters, MPI_COMM_WORLD);
    StepSize<3> step_size(parameters.section("Time step"));
    Clock clock;
    for (clock.step = 0; clock.step <= 20; ++clock.step)
    {
      step_size.next(model, clock, 1e6, false);
      for (unsigned int i = 0; i < model.state.partition()->n_local(); ++i)
        for (unsigned int d = 0; d < 3; ++d)
          model.state.position.node(i)[d] *= factor;
    }
    return step_size.n_estimates();
  };
  EXPECT_EQ(n_estimates("0.01", 0.995), 7u); // 0.995^3 is below 0.99
  EXPECT_EQ(n_estimates("0.05", 0.995), 2u); // 0.995^11 is below 0.95
  EXPECT_EQ(n_estimates("0.05", 1.005), 3u); // 1.005^10 is above 1.05
}

TEST(CourantLimit, is_unsafe_at_free_corners_of_nearly_incompressible_particles)
{
  FrozenBody<3> body(particles("1.8", "paper", 0.49));
  EXPECT_NEAR(courant_limit(*body.model).time_step, 1.8, 1e-12);
  EXPECT_LT(body.limit_by_eigenvalues(), 0.9 * 1.8);
}
