// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <heated_body.h>

#include <tombolo/physics/heat/conduction_matrix.h>

#include <deal.II/lac/la_parallel_vector.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  using Vector = dealii::LinearAlgebra::distributed::Vector<double>;

  const std::string held = "subsection Condition: held\nset Type = temperature\nset Where = x < "
                           "1e-3\nset Function = 5\nend\n";

  /** Cells of three sizes: nodes hang inside, and on the boundary that is held. */
  constexpr const char *graded =
      "set Refine where = x < 0.6; y < 0.3 && x < 0.4\nset Refinement levels = 1; 2\n";

  /** The largest difference between the matrix times a vector, and D + τ of the operator, over the
   * largest entry of the latter. */
  template <int dim>
  double difference(const HeatedMethod &method, const std::string &conditions,
                    const double averaging = 0.)
  {
    HeatedBody<dim> body(method, conditions);
    body.set_temperature([](const double *x) { return 6. + 2. * x[0] + x[1]; });
    body.step->start(*body.model, 0.);
    ThermalModel<dim> &heat = body.heat();
    const auto &partition = *body.model->state.partition();
    constexpr double factor = 0.7;
    NodalVector direction = body.vector(), image = body.vector(),
                diagonal = body.vector(Quantity::scalar);
    Vector source(partition.owned(), MPI_COMM_WORLD), result(source);
    for (unsigned int i = 0; i < partition.n_owned(); ++i)
    {
      const double *const x = body.model->state.initial_position.node(i);
      source.local_element(i) = std::sin(91.7 * x[0] + 57.3 * x[1] + 31.1 * x[2]);
      *diagonal.node(i) = heat.nodal_enthalpy.capacity(i, 5.);
    }
    for (const unsigned int node : heat.conditions.constrained_nodes())
      source.local_element(node) = 0.;
    for (const unsigned int node : partition.dependent_nodes().node)
      source.local_element(node) = 0.;
    for (unsigned int i = 0; i < partition.n_owned(); ++i)
      *direction.node(i) = source.local_element(i);
    direction.update_ghosts();

    dealii::TrilinosWrappers::SparseMatrix matrix;
    assemble_conduction_matrix(*body.model, heat.state.temperature, factor, averaging, diagonal,
                               matrix);
    matrix.vmult(result, source);
    heat.apply_conduction(body.model->state.position, heat.state.temperature, 0., direction, image);
    double scale = 0, error = 0;
    for (unsigned int i = 0; i < partition.n_owned(); ++i)
    {
      const double expected = *diagonal.node(i) * source.local_element(i) + factor * *image.node(i);
      scale = std::max(scale, std::abs(expected));
      error = std::max(error, std::abs(result.local_element(i) - expected));
    }
    return dealii::Utilities::MPI::max(error, MPI_COMM_WORLD) /
           dealii::Utilities::MPI::max(scale, MPI_COMM_WORLD);
  }

  class ConductionMatrix : public ::testing::TestWithParam<HeatedMethod>
  {};

  INSTANTIATE_TEST_SUITE_P(
      Methods, ConductionMatrix,
      ::testing::Values(HeatedMethod{"elements"},
                        HeatedMethod{"elements", "", "paper", "hexahedron"},
                        HeatedMethod{"particles", "none"}, HeatedMethod{"coupled", "none"},
                        HeatedMethod{"coupled", "none", "paper", "hexahedron", true}));
} // namespace

TEST_P(ConductionMatrix, is_the_operator_without_smoothing)
{
  EXPECT_LT(difference<2>(GetParam(), ""), 1e-12);
  EXPECT_LT(difference<3>(GetParam(), ""), 1e-12);
  EXPECT_LT(difference<2>(GetParam(), held), 1e-12);
  EXPECT_LT(difference<3>(GetParam(), held), 1e-12);
}

TEST(ConductionMatrixWithHangingNodes, is_the_operator)
{
  for (HeatedMethod method :
       {HeatedMethod{"elements"}, HeatedMethod{"elements", "", "paper", "hexahedron", true},
        HeatedMethod{"coupled", "none"}})
    for (const std::string &conditions : {std::string(), held})
    {
      method.mesh_options = graded;
      EXPECT_LT(difference<2>(method, conditions), 1e-12) << method;
      EXPECT_LT(difference<3>(method, conditions), 1e-12) << method;
    }
}

TEST(ConductionMatrixOfSmoothedParticles, is_not_the_operator)
{
  EXPECT_GT(difference<2>({"particles", "affine"}, ""), 1e-3);
}

TEST(ConductionMatrixOfSmoothedParticles, has_averaging_only_where_there_are_particles)
{
  EXPECT_LT(difference<2>({"elements"}, "", 3.), 1e-12);
  EXPECT_GT(difference<2>({"particles", "none"}, "", 3.), 1e-3);
}

TEST(Sublattices, are_equally_many_nodes_and_none_in_the_same_cell)
{
  HeatedBody<3> body({"particles"});
  const auto indicators = sublattices(*body.model);
  ASSERT_EQ(indicators.size(), 8u);
  NodalVector number = body.vector(Quantity::scalar);
  for (unsigned int i = 0; i < body.model->state.partition()->n_owned(); ++i)
  {
    unsigned int count = 0;
    for (unsigned int k = 0; k < 8; ++k)
      if (indicators[k][i])
      {
        ++count;
        *number.node(i) = 1. + k;
      }
    EXPECT_EQ(count, 1u);
  }
  std::vector<dealii::types::global_dof_index> nodes;
  for (const auto &cell : body.model->nodes->dof_handler().active_cell_iterators())
  {
    if (!cell->is_locally_owned())
      continue;
    body.model->nodes->cell_nodes(cell, nodes);
    // Numbers of other ranks have another origin.
    std::vector<unsigned int> seen(9, 0);
    for (const auto node : nodes)
      if (body.model->nodes->owned().is_element(node))
        ++seen[static_cast<unsigned int>(
            *number.node(body.model->state.partition()->local_index(node)))];
    for (const unsigned int count : seen)
      EXPECT_LE(count, 1u);
  }
}
