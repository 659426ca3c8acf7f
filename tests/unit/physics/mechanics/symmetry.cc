// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <symmetric_body.h>

#include <gtest/gtest.h>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  template <int dim>
  void expect_same_motion(const SymmetricBlock &piece, const SymmetricBlock &whole,
                          const Method &method)
  {
    Body<dim> piece_body(piece, method), whole_body(whole, method);
    for (Body<dim> *body : {&piece_body, &whole_body})
    {
      body->set_velocity(0.12);
      body->run(0.04);
    }
    const NodalState &a = piece_body.model->state, &b = whole_body.model->state;
    const auto moved = whole_body.values_at_nodes({&b.position});
    const auto start = whole_body.values_at_nodes({&b.initial_position});
    // The test is of a large deformation, with renewed kernels where there are some.
    EXPECT_GT(difference(moved, start), 0.0145);
    if (method.rebuild != std::string("never"))
    {
      EXPECT_GT(whole_body.n_rebuilds, method.n_steps / 20);
    }
    EXPECT_EQ(whole_body.model->state.partition()->n_images() == 0u, whole.planes.empty());
    EXPECT_GT(dealii::Utilities::MPI::sum(a.partition()->n_images(), MPI_COMM_WORLD), 0u);
    EXPECT_EQ(piece_body.images_have_ghosts_as_sources(),
              dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1);
    EXPECT_LT(difference(piece_body.values_at_nodes({&a.position}), moved), 1e-10);
    EXPECT_LT(difference(piece_body.values_at_nodes({&a.velocity, &a.unsmoothed_velocity}),
                         whole_body.values_at_nodes({&b.velocity, &b.unsmoothed_velocity})),
              1e-10);
    EXPECT_LT(difference(piece_body.stresses(), whole_body.stresses()), 1e-10);
    // Nodes on planes stay there without round-off: a resumed run reads the same values.
    for (const NodePartition::Reflected &on_plane : a.partition()->nodes_on_planes())
      for (unsigned int d = 0; d < dim; ++d)
        if (on_plane.reflection.sign[d] < 0.)
        {
          EXPECT_EQ(a.unsmoothed_velocity.node(on_plane.source)[d], 0.);
          EXPECT_EQ(a.position.node(on_plane.source)[d], 0.5 * on_plane.reflection.offset[d]);
        }
  }

  class SymmetricMotion : public ::testing::TestWithParam<Method>
  {};
} // namespace

TEST_P(SymmetricMotion, half_a_block_moves_as_the_whole)
{
  expect_same_motion<3>(half_3d, whole_3d, GetParam());
}

TEST_P(SymmetricMotion, a_quarter_of_a_block_moves_as_the_whole)
{
  expect_same_motion<3>(quarter_3d, whole_3d, GetParam());
}

TEST_P(SymmetricMotion, half_a_plate_in_plane_strain_moves_as_the_whole)
{
  expect_same_motion<2>(half_2d, whole_2d, GetParam());
}

// Fewer steps where the block is pulled: kernels that are renewed under tension make round-off
// grow.
INSTANTIATE_TEST_SUITE_P(Methods, SymmetricMotion,
                         ::testing::Values(Method{"paper"}, Method{"fe matched"}, Method{"affine"},
                                           Method{"none"}, Method{"paper", "paper", "4"},
                                           Method{"affine", "trace", "4"},
                                           Method{"affine", "paper", "0", true, "17", 240},
                                           Method{"affine", "", "0", false, "never"},
                                           Method{"affine", "paper", "4", true, "never"},
                                           Method{"fe matched", "trace", "0", true, "17", 240}));

TEST(Symmetry, the_half_below_a_plane_moves_as_the_whole)
{
  expect_same_motion<3>(other_half_3d, whole_3d, Method{"affine"});
}

TEST(Symmetry, a_slab_between_two_planes_moves_as_one_of_twice_its_thickness)
{
  expect_same_motion<3>({"0, -0.5, 0", "1, 0.5, 1", "4, 4, 4", "x < 1e-9, z < 1e-9, z > 1 - 1e-9"},
                        {"-1, -0.5, 0", "1, 0.5, 2", "8, 4, 8", "z < 1e-9, z > 2 - 1e-9"},
                        Method{"affine"});
}
