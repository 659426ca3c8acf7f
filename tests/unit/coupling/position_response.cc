// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
#include "model_scene.h"

#include <tombolo/coupling/position_response.h>
#include <tombolo/physics/mechanics/mechanical_step.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

using namespace tombolo;

namespace
{
  /** A disordered block, elements to the left and particles to the right. */
  std::unique_ptr<Model<3>> block(const std::string &smoothing, const std::string &conditions = "")
  {
    return tombolo::testing::make_model<3>(
        "set Dimension = 3\nset Parts = a, b\nset Materials = m\n"
        "subsection Mesh\nset Type = box\nsubsection box\nset Upper corner = 1.4, 1.2, 1\n"
        "set Cells = 7, 6, 5\nset Disorder = 0.2\nend\nend\n"
        "subsection Part: a\nset Cells = x < 0.6\nset Formulation = fully integrated hexahedron\n"
        "set Material = m\nend\n"
        "subsection Part: b\nset Cells = otherwise\n"
        "set Formulation = momentum consistent particle\nset Material = m\n"
        "subsection momentum consistent particle\nset Smoothing = " +
        smoothing +
        "\nend\nend\n"
        "subsection Material: m\nset Model = elastic\nsubsection elastic\nset Density = 2\n"
        "set Young's modulus = 3\nset Poisson's ratio = 0.3\nend\nend\n" +
        conditions);
  }

  /** Nodes below a height. */
  std::vector<unsigned int> nodes_below(const Model<3> &model, const double height)
  {
    std::vector<unsigned int> result;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      if (model.state.initial_position.node(i)[2] < height)
        result.push_back(i);
    return result;
  }

  /** Loads at these nodes, zero at others. */
  NodalVector loads_at(const std::vector<unsigned int> &nodes, const Model<3> &model,
                       const double seed)
  {
    NodalVector result(model.state.partition());
    for (const unsigned int node : nodes)
    {
      const double *const x = model.state.initial_position.node(node);
      for (unsigned int d = 0; d < 3; ++d)
        result.node(node)[d] = std::sin(91.7 * x[0] + 57.3 * x[1] + 31.1 * x[2] + seed + d);
    }
    return result;
  }

  double product(const std::vector<unsigned int> &nodes, const NodalVector &a, const NodalVector &b)
  {
    double sum = 0;
    for (const unsigned int node : nodes)
      for (unsigned int d = 0; d < 3; ++d)
        sum += a.node(node)[d] * b.node(node)[d];
    return dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD);
  }

  class PositionResponseTest : public ::testing::TestWithParam<std::string>
  {
  protected:
    NodalVector respond(PositionResponse &position_response, const NodalVector &loads)
    {
      NodalVector result(model->state.partition());
      position_response.respond(loads, {}, result);
      return result;
    }

    std::unique_ptr<Model<3>> model = block(GetParam());
    std::vector<unsigned int> nodes = nodes_below(*model, 0.1);
    NodalVector f = loads_at(nodes, *model, 0.), g = loads_at(nodes, *model, 3.);
  };

  TEST_P(PositionResponseTest, is_symmetric_and_bounded_by_the_masses)
  {
    PositionResponse position_response(*model->bridge);
    position_response.begin_step(model->state.partition());
    position_response.set_nodes(nodes);
    const NodalVector response_f = respond(position_response, f),
                      response_g = respond(position_response, g);
    const double energy = product(nodes, f, response_f);
    EXPECT_GT(energy, 0.);
    EXPECT_NEAR(product(nodes, g, response_f), product(nodes, f, response_g), 1e-12 * energy);
    double bound = 0;
    const NodalVector &mass = position_response.mass();
    for (const unsigned int node : nodes)
      for (unsigned int d = 0; d < 3; ++d)
        bound += f.node(node)[d] * f.node(node)[d] /
                 mass.node(node)[mass.n_slots_per_node() == 1 ? 0 : d];
    // Affine fields are no means: up to 1.45 the sweeps of kinematic contact converge.
    const double largest = GetParam() == "affine" ? 1.45 : 1. + 1e-12;
    EXPECT_LE(energy, dealii::Utilities::MPI::sum(bound, MPI_COMM_WORLD) * largest);
  }

  TEST_P(PositionResponseTest, is_the_same_where_more_nodes_respond_and_where_these_are_kept)
  {
    PositionResponse position_response(*model->bridge);
    position_response.begin_step(model->state.partition());
    position_response.set_nodes(nodes);
    const NodalVector expected = respond(position_response, f);
    const double size = std::sqrt(product(nodes, expected, expected));
    position_response.set_nodes(nodes_below(*model, 0.3));
    for (unsigned int step = 0; step < 2; ++step)
    {
      const NodalVector response = respond(position_response, f);
      for (const unsigned int node : nodes)
        for (unsigned int d = 0; d < 3; ++d)
          EXPECT_NEAR(response.node(node)[d], expected.node(node)[d], 1e-13 * size);
      position_response.begin_step(model->state.partition());
      position_response.keep_nodes();
    }
  }

  TEST_P(PositionResponseTest, predicts_the_positions_of_the_step_where_components_are_prescribed)
  {
    const auto held =
        block(GetParam(), "set Conditions = drive\nsubsection Condition: drive\nset Type = "
                          "velocity\nset Where = x > 0.9 && z < 0.5\n"
                          "set Function = 0.1; free; 0.2\nend\n");
    NodalState &state = held->state;
    std::vector<unsigned int> all(state.partition()->n_owned());
    std::iota(all.begin(), all.end(), 0u);
    state.unsmoothed_velocity.copy_from(loads_at(all, *held, 1.));
    held->conditions->prescribe_initial_velocity(state, 0., 1e-3);
    held->bridge->smooth_velocity(state);
    Clock clock;
    clock.next_step = 0.1;
    state.acceleration.copy_from(loads_at(all, *held, 2.));
    held->conditions->prescribe_acceleration(state, 0., clock.velocity_step(), clock.next_step);
    state.acceleration.distribute();

    NodalVector predicted(state.partition());
    PositionResponse position_response(*held->bridge);
    position_response.begin_step(state.partition());
    position_response.predict(state, clock, all, predicted);
    CentralDifferences<3>().advance(*held, clock);
    for (const unsigned int node : all)
      for (unsigned int d = 0; d < 3; ++d)
        EXPECT_NEAR(predicted.node(node)[d], state.position.node(node)[d], 1e-13);
  }

  INSTANTIATE_TEST_SUITE_P(Smoothings, PositionResponseTest,
                           ::testing::Values("none", "paper", "fe matched", "affine"));
} // namespace
