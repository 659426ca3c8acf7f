// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
#include "model_scene.h"
#include "nodal_fields.h"

#include <tombolo/base/clock.h>
#include <tombolo/model/actions.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

namespace
{
  using namespace tombolo;
  using namespace dealii;

  /** Half of a plate, elements, of two sizes where it @p is_graded, and particles, above a plane of
   * symmetry. */
  std::unique_ptr<Model<2>> half_plate(const std::string &smoothing, const bool is_graded = true)
  {
    return tombolo::testing::make_model<2>(
        "set Dimension = 2\nset Parts = a, b\nset Materials = m\nset Conditions = plane\n"
        "subsection Mesh\nset Type = box\nset Refine where = " +
        std::string(is_graded ? "x < 1" : "") +
        "\nsubsection box\nset Upper corner = 4, 1\nset Cells = 16, 4\nend\nend\n"
        "subsection Condition: plane\nset Type = symmetry\nset Boundary = y min\nend\n"
        "subsection Part: a\nset Cells = x < 2\nset Formulation = hexahedron\nset Material = "
        "m\n"
        "end\nsubsection Part: b\nset Cells = otherwise\nset Formulation = momentum consistent "
        "particle\nset Material = m\nsubsection momentum consistent particle\nset Smoothing "
        "= " +
        smoothing +
        "\nend\nend\nsubsection Material: m\nset Model = elastic\nsubsection elastic\nset "
        "Density = 2\nset Young's modulus = 3\nset Poisson's ratio = 0.3\nend\nend\n");
  }

  double noise(const double *const x, const unsigned int seed)
  {
    return std::sin(91.7 * x[0] + 57.3 * x[1] + 17. * seed);
  }

  /** Noise at the nodes that move, with what follows from it at all others. */
  NodalVector moving_field(const Model<2> &model)
  {
    NodalVector field = tombolo::testing::vector_field(model, noise);
    field.distribute();
    return field;
  }

  double sum(const double value)
  {
    return Utilities::MPI::sum(value, MPI_COMM_WORLD);
  }

  double power(const NodalForces &forces, const NodalVector &velocity)
  {
    double result = 0;
    for (std::size_t k = 0; k < forces.nodes.size(); ++k)
      for (unsigned int d = 0; d < 3; ++d)
        result += forces.forces[k][d] * velocity.node(forces.nodes[k])[d];
    return sum(result);
  }

  TEST(Actions, forces_anywhere_have_the_power_of_the_nodal_forces)
  {
    for (const std::string smoothing : {"paper", "affine"})
      for (const ActsAt acts_at : {ActsAt::nodes, ActsAt::loads, ActsAt::positions})
      {
        SCOPED_TRACE(smoothing + ", " + std::to_string(static_cast<int>(acts_at)));
        const auto model = half_plate(smoothing);
        const NodePartition &partition = *model->state.partition();
        ASSERT_GT(sum(partition.n_images()), 0.);
        const NodalVector velocity = moving_field(*model);
        NodalVector acting_velocity(model->state.partition());
        if (acts_at == ActsAt::loads || (acts_at == ActsAt::positions && smoothing == "paper"))
          model->bridge->load_transfer().interpolate(velocity, acting_velocity);
        else
          acting_velocity.copy_from(velocity);
        acting_velocity.distribute();

        Actions actions;
        Action &action = actions.add("pushes", acts_at);
        actions.set_partition(model->state.partition());
        for (unsigned int step = 0; step < 2; ++step) // nothing is left of the first
        {
          actions.begin();
          double given = 0;
          for (unsigned int i = 0; i < partition.n_local(); ++i)
          {
            Tensor<1, 2> force;
            for (unsigned int d = 0; d < 2; ++d)
            {
              force[d] = noise(model->state.position.node(i), 5 + d + step);
              given += force[d] * acting_velocity.node(i)[d];
            }
            action.add_force(i, force);
          }
          NodalVector total(model->state.partition());
          actions.collect(*model->bridge, total);
          EXPECT_NEAR(power(action.nodal_forces(), velocity), sum(given), 1e-12);
          EXPECT_NEAR(total.dot(velocity), sum(given), 1e-12);
        }
      }
  }

  TEST(Actions, heat_anywhere_goes_to_the_nodes_that_keep_it)
  {
    const auto model = half_plate("affine");
    const auto &partition = model->state.partition();
    NodalVector field(partition, Quantity::scalar), pending(partition, Quantity::scalar);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      *field.node(i) = noise(model->state.initial_position.node(i), 3);
    field.distribute();

    Actions actions;
    HeatAction &heat = actions.add_heat("torch", "heat of the torch");
    actions.set_partition(partition);
    double product = 0, given = 0;
    const auto add_noise = [&](const unsigned int seed)
    {
      for (unsigned int i = 0; i < partition->n_local(); ++i)
      {
        const double node_heat = noise(model->state.position.node(i), seed);
        heat.add_heat(i, node_heat);
        product += node_heat * *field.node(i);
        given += node_heat;
      }
      actions.collect_heat(pending);
    };
    const auto booked = [&]
    {
      EnergyAccounts accounts;
      actions.account_heat(accounts);
      accounts.sum_over_ranks(MPI_COMM_WORLD);
      return accounts["heat of the torch"];
    };
    for (const unsigned int seed : {5u, 6u}) // nothing is added twice
      add_noise(seed);
    EXPECT_NEAR(pending.dot(field), sum(product), 1e-12);
    const double before = booked();
    EXPECT_NEAR(before, sum(given), 1e-12);
    actions.records.keep();
    add_noise(7);
    EXPECT_GT(std::abs(booked() - before), 1e-3);
    actions.records.restore();
    EXPECT_EQ(booked(), before);
  }

  TEST(Actions, a_few_nodes_have_the_forces_that_all_would_have)
  {
    for (const ActsAt acts_at : {ActsAt::nodes, ActsAt::positions})
    {
      const auto model = half_plate("paper", false);
      const NodePartition &partition = *model->state.partition();
      Actions actions;
      Action &few = actions.add("few", acts_at), &all = actions.add("all", acts_at);
      actions.set_partition(model->state.partition());
      for (unsigned int step = 0; step < 2; ++step) // nothing is left of the first
      {
        actions.begin();
        // One node of each kind: owned, a ghost, an image.
        for (const unsigned int first :
             {0u, partition.n_owned(), partition.n_owned() + partition.n_ghosts()})
          if (const unsigned int node = first + step; node < partition.n_local())
          {
            const Tensor<1, 2> force({1. + node, 2.});
            few.add_force(node, force);
            for (unsigned int d = 0; d < 2; ++d)
              all.at_all_nodes().node(node)[d] += force[d];
          }
        NodalVector total(model->state.partition());
        actions.collect(*model->bridge, total);
        EXPECT_EQ(few.nodal_forces().nodes, all.nodal_forces().nodes);
        EXPECT_LT(few.nodal_forces().nodes.size(), partition.n_owned());
        for (unsigned int i = 0; i < partition.n_owned(); ++i)
          EXPECT_EQ(few.nodal_force(i), all.nodal_force(i));
      }
    }
  }

  TEST(Actions, works_take_both_ends_of_a_step_and_each_with_the_rows_of_its_time)
  {
    const auto model = half_plate("paper");
    NodalVector velocity(model->state.partition());
    NodalForces forces;
    forces.nodes = {0};
    forces.forces = {Tensor<1, 3>()};
    Clock clock;
    const auto set = [&](const double force, const double speed, const double next)
    {
      forces.forces[0][1] = force;
      velocity.node(0)[1] = speed;
      clock.next_step = next;
    };
    for (const bool is_changed : {false, true})
    {
      StepWork steps;
      double work = 0;
      clock = {};
      set(2., 5., 0.2);
      steps.complete_step(forces, velocity, clock, work);
      EXPECT_EQ(work, 0.);
      clock.advance();
      velocity.node(0)[1] = 7.;
      if (is_changed)
        steps.begin_change(velocity, work);
      EXPECT_DOUBLE_EQ(work, is_changed ? 0.5 * 7. * 0.2 * 2. : 0.);
      set(3., is_changed ? 11. : 7., 0.4);
      steps.complete_step(forces, velocity, clock, work);
      const double first = 0.5 * 7. * 0.2 * 2., second = 0.5 * (is_changed ? 11. : 7.) * 0.3 * 3.;
      EXPECT_DOUBLE_EQ(work, first + second);
      clock.advance();
      velocity.node(0)[1] = 13.;
      steps.complete_step({}, velocity, clock, work); // the force has gone
      EXPECT_DOUBLE_EQ(work, first + second + 0.5 * 13. * 0.3 * 3.);
    }
  }
} // namespace
