// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
#include <symmetric_body.h>

#include <gtest/gtest.h>

#include <string>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  /** Smoothed particles with these entries, in a block whose lower half is elements where there is
   * a bridge. */
  Method smoothed(const char *entries, const unsigned int n_steps = 100, const char *bridge = "")
  {
    Method method{"none", bridge};
    method.n_steps = n_steps;
    method.smoothed_entries = entries;
    return method;
  }

  const char *const all_terms = "set Artificial viscosity = true\nset Artificial stress = true\n"
                                "set XSPH = true";
  const char *const lagrangian =
      "set Configuration = total Lagrangian\nset Artificial viscosity = true";
  const char *const paper_entries = "set Gradient = paper\nset Smoothing length = 1.2";

  /** Compares a piece with the whole body after some steps; @p scale is of the velocity. */
  template <int dim>
  void expect_same(const SymmetricBlock &piece, const SymmetricBlock &whole, const Method &method,
                   const double tolerance)
  {
    Body<dim> piece_body(piece, method), whole_body(whole, method);
    for (Body<dim> *body : {&piece_body, &whole_body})
    {
      body->set_velocity(0.12);
      body->run(0.04);
    }
    const NodalState &a = piece_body.model->state, &b = whole_body.model->state;
    EXPECT_GT(dealii::Utilities::MPI::sum(a.partition()->n_images(), MPI_COMM_WORLD), 0u);
    EXPECT_EQ(whole_body.model->state.partition()->n_images() == 0u, whole.planes.empty());
    EXPECT_LT(difference(piece_body.values_at_nodes({&a.position}),
                         whole_body.values_at_nodes({&b.position})),
              tolerance);
    EXPECT_LT(difference(piece_body.values_at_nodes({&a.velocity, &a.unsmoothed_velocity}),
                         whole_body.values_at_nodes({&b.velocity, &b.unsmoothed_velocity})),
              tolerance);
    EXPECT_LT(difference(piece_body.values_at_nodes({&a.acceleration}),
                         whole_body.values_at_nodes({&b.acceleration})),
              tolerance);
    EXPECT_LT(difference(piece_body.stresses(), whole_body.stresses()), tolerance);
  }

  class SmoothedSymmetry : public ::testing::TestWithParam<Method>
  {};

  INSTANTIATE_TEST_SUITE_P(Methods, SmoothedSymmetry,
                           ::testing::Values(smoothed(""), smoothed(all_terms),
                                             smoothed(lagrangian), smoothed(paper_entries),
                                             smoothed(all_terms, 100, "paper")));
} // namespace

TEST_P(SmoothedSymmetry, first_stresses_and_forces_of_a_quarter_are_those_of_the_whole)
{
  Method method = GetParam();
  method.n_steps = 1;
  expect_same<3>(quarter_3d, whole_3d, method, 1e-13);
}

TEST_P(SmoothedSymmetry, half_a_block_of_metal_moves_as_the_whole)
{
  expect_same<3>(half_3d, whole_3d, GetParam(), 1e-11);
}

TEST_P(SmoothedSymmetry, a_quarter_of_a_block_of_metal_moves_as_the_whole)
{
  expect_same<3>(quarter_3d, whole_3d, GetParam(), 1e-11);
}

TEST_P(SmoothedSymmetry, half_a_plate_in_plane_strain_moves_as_the_whole)
{
  expect_same<2>(half_2d, whole_2d, GetParam(), 1e-11);
}

TEST(SmoothedPieces, a_slab_between_two_planes_moves_as_one_of_twice_its_thickness)
{
  expect_same<3>({"0, -0.5, 0", "1, 0.5, 1", "4, 4, 4", "x < 1e-9, z < 1e-9, z > 1 - 1e-9"},
                 {"-1, -0.5, 0", "1, 0.5, 2", "8, 4, 8", "z < 1e-9, z > 2 - 1e-9"},
                 smoothed(all_terms), 1e-11);
}

TEST(SmoothedPieces, metal_flows_and_energies_of_a_quarter_are_a_quarter_of_the_whole)
{
  const Method method = smoothed(all_terms);
  Body<3> quarter(quarter_3d, method), whole(whole_3d, method);
  for (Body<3> *body : {&quarter, &whole})
  {
    body->set_velocity(0.12);
    body->balance();
    body->run(0.04);
  }
  const EnergyBalance a = quarter.balance(), b = whole.balance();
  for (const std::string name : {"kinetic energy", "elastic energy", "plastic dissipation",
                                 "pair viscosity", "artificial stress"})
  {
    EXPECT_NEAR(4. * a.energies[name], b.energies[name], 1e-11 * b.total) << name;
    EXPECT_GT(std::abs(b.energies[name]), 1e-5 * b.total) << name;
  }
  EXPECT_NEAR(a.error, b.error, 1e-11);
}
