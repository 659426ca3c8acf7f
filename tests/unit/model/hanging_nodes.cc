// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include "frozen_body.h"
#include "mesh_testing.h"
#include "nodal_fields.h"

#include <tombolo/model/assembly.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace
{
  using namespace tombolo;
  using namespace tombolo::testing;

  /** Cells of size 1, smaller at two corners, twice at the one. No node hangs between hanging
   * nodes: beside an edge that is divided once no cell divides it again. */
  std::string graded_block(const std::string &formulation, const unsigned int dim,
                           const std::string &options = "")
  {
    Block block;
    block.formulation = formulation;
    block.cells = std::vector<unsigned int>(dim, dim == 2 ? 6 : 4);
    block.options = options;
    block.mesh_options = "set Disorder = 0.1";
    const std::string all = dim == 2 ? "x + y" : "x + y + z";
    return changed(parameters_of(block), "set Type = box\n",
                   "set Type = box\nset Refine where = " + all + " < 3; " + all +
                       " < 1.6; x > 3 && y > 2\nset Refinement levels = 1; 2; 1\n");
  }

  bool is_inside(const double *const x, const unsigned int dim)
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (x[d] < 1e-9 || x[d] > (dim == 2 ? 6. : 4.) - 1e-9)
        return false;
    return true;
  }

  /** Values between -1 and 1 that no two nodes share. */
  void set_random(const NodalVector &positions, const double seed, NodalVector &result)
  {
    result.fill(
        [&](const unsigned int i, double *const values)
        {
          const double *const x = positions.node(i);
          for (unsigned int c = 0; c < 3; ++c)
            values[c] = std::sin(37. * x[0] + 91. * x[1] + 53. * x[2] + seed + c);
        });
  }

  template <int dim>
  void check_identities(const std::string &formulation)
  {
    const FrozenBody<dim> body(graded_block(formulation, dim));
    const Model<dim> &model = *body.model;
    ASSERT_TRUE(model.nodes->has_dependent_nodes());
    const NodalVector &positions = model.state.initial_position;
    const auto &partition = model.state.partition();

    // No node hangs between hanging nodes: one pass over the rows is enough.
    const NodePartition::DependentNodes &rows = partition->dependent_nodes();
    NodalVector hangs(partition, Quantity::scalar);
    for (const unsigned int node : rows.node)
      *hangs.node(node) = 1.;
    hangs.update_ghosts();
    for (const auto &weight : rows.weights)
      EXPECT_EQ(*hangs.node(weight.first), 0.) << formulation;

    // Linear fields stay, so that positions do not move; the mean of others is taken elsewhere.
    NodalVector field, other;
    field = positions.copy();
    field.distribute();
    double hanging_mass = 0, n_hanging = 0;
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      n_hanging += *model.element_mass.node(i) == 0. ? 1. : 0.;
    EXPECT_LT(largest_difference(field, positions), 1e-14) << formulation;
    EXPECT_NEAR(sum_of_nodes(model.element_mass), std::pow(dim == 2 ? 6. : 4., dim), 1e-11)
        << formulation;
    EXPECT_GT(sum_over_ranks(n_hanging), 5.) << formulation;

    // f . C v = C^T f . v, sums stay.
    NodalVector force, velocity;
    for (NodalVector *const vector : {&force, &velocity, &other})
      vector->reinit(partition);
    set_random(positions, 0.3, velocity);
    set_random(positions, 1.7, force);
    other.copy_from(velocity);
    other.distribute();
    const double before = force.dot(other);
    const double sum = sum_of_nodes(force);
    for (unsigned int i = partition->n_owned(); i < partition->n_local(); ++i)
      std::fill_n(force.node(i), node_stride, 0.);
    force.condense();
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (*model.element_mass.node(i) == 0.)
        hanging_mass = std::max(hanging_mass, std::abs(force.node(i)[0]));
    EXPECT_NEAR(force.dot(velocity), before, 1e-11) << formulation;
    EXPECT_NEAR(sum_of_nodes(force), sum, 1e-11) << formulation;
    EXPECT_EQ(hanging_mass, 0.) << formulation;
  }

  TEST(HangingNodes, keep_linear_fields_mass_momentum_and_power)
  {
    check_identities<2>("hexahedron");
    check_identities<3>("fully integrated hexahedron");
  }

  /** A motion without acceleration: no force at any node inside, in warped cells of three sizes. */
  template <int dim>
  void check_patch(const std::string &formulation)
  {
    const FrozenBody<dim> body(graded_block(formulation, dim));
    Model<dim> &model = *body.model;
    const NodalVector &positions = model.state.initial_position;
    NodalVector velocity(model.state.partition()), force(model.state.partition());
    const double gradient[3][3] = {{0.3, 0.7, -0.2}, {-0.4, 0.1, 0.5}, {0.2, -0.6, 0.4}};
    for (unsigned int i = 0; i < model.state.partition()->n_local(); ++i)
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          velocity.node(i)[a] += gradient[a][b] * positions.node(i)[b];
    Assembly<dim>(model.parts)
        .assemble(*model.bridge, velocity, force,
                  [&](const Part<dim> &part, const NodalVector &seen, NodalVector &result) {
                    part.formulation->apply_elastic_stiffness(model.state.position, seen, 1e30,
                                                              result);
                  });
    double inside = 0, outside = 0;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
      {
        double &largest = is_inside(positions.node(i), dim) ? inside : outside;
        largest = std::max(largest, std::abs(force.node(i)[d]));
      }
    EXPECT_LT(dealii::Utilities::MPI::max(inside, MPI_COMM_WORLD),
              1e-12 * dealii::Utilities::MPI::max(outside, MPI_COMM_WORLD))
        << formulation;
  }

  TEST(HangingNodes, pass_the_patch_test_in_warped_cells_of_three_sizes)
  {
    check_patch<2>("hexahedron");
    check_patch<2>("fully integrated hexahedron");
    check_patch<3>("hexahedron");
    check_patch<3>("fully integrated hexahedron");
  }

  /** Elements beside particles of half their distance, or of twice it. */
  std::string coupled_block(const unsigned int dim, const bool has_small_particles,
                            const std::string &smoothing, const std::string &bridge,
                            const std::string &disorder = "0.15")
  {
    Block block;
    block.formulation = "coupled";
    block.cells = dim == 2 ? std::vector<unsigned int>{6, 5} : std::vector<unsigned int>{4, 3, 2};
    block.options = "set Smoothing = " + smoothing;
    block.bridge = bridge;
    block.mesh_options = "set Disorder = " + disorder;
    return changed(parameters_of(block), "set Type = box\n",
                   std::string("set Type = box\nset Refine where = x ") +
                       (has_small_particles ? ">" : "<") + (dim == 2 ? " 3\n" : " 2\n"));
  }

  template <int dim>
  void check_beside_particles(const bool has_small_particles, const std::string &smoothing,
                              const std::string &bridge)
  {
    const std::string name = smoothing + ", " + bridge + " bridge, small " +
                             (has_small_particles ? "particles" : "elements") + ", " +
                             std::to_string(dim) + " dimensions";
    const FrozenBody<dim> body(coupled_block(dim, has_small_particles, smoothing, bridge));
    const Model<dim> &model = *body.model;
    const auto &partition = model.state.partition();
    const NodalVector &positions = model.state.initial_position;
    ASSERT_TRUE(partition->has_dependent_nodes()) << name;

    // Nodes that follow others have no mass and are in no row, and no volume is lost.
    double n_without = 0;
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      n_without += *model.bridge->mass().node(i) == 0. ? 1. : 0.;
    EXPECT_NEAR(sum_of_nodes(model.bridge->lumped_mass()), dim == 2 ? 30. : 24., 1e-12) << name;
    EXPECT_EQ(sum_over_ranks(n_without),
              sum_over_ranks(static_cast<double>(partition->dependent_nodes().node.size())))
        << name;
    EXPECT_GT(sum_over_ranks(n_without), 4.) << name;

    NodalVector linear(partition), noise(partition), other(partition), result(partition);
    const double gradient[3][3] = {{0.3, 0.7, -0.2}, {-0.4, 0.1, 0.5}, {0.2, -0.6, 0.4}};
    for (unsigned int i = 0; i < partition->n_local(); ++i)
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          linear.node(i)[a] += gradient[a][b] * positions.node(i)[b];
    set_random(positions, 0.3, noise);
    set_random(positions, 1.7, other);
    noise.distribute();
    other.distribute();

    // Linear fields stay: those of the nodes, those of the particles and their gradients.
    const auto distance = [&](const NodalVector &field)
    {
      double largest = 0;
      for (unsigned int i = 0; i < partition->n_local(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          largest = std::max(largest, std::abs(field.node(i)[d] - linear.node(i)[d]));
      return dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD);
    };
    if (smoothing == "affine")
    {
      model.bridge->apply_smoothing(linear, result);
      EXPECT_LT(distance(result), 1e-12) << name;
    }
    model.bridge->apply_interpolation(linear, result);
    result.distribute();
    EXPECT_LT(distance(result), 1e-12) << name;
    EXPECT_LT(distance(model.bridge->element_velocity(linear)), 1e-12) << name;
    double worst = 0;
    for (const Part<dim> &part : model.parts)
      for (unsigned int row = 0;
           part.particles != nullptr && row < part.particles->stencils().n_particles(); ++row)
      {
        const Stencils::Row stencil = part.particles->stencils().row(row);
        double sums[dim][dim] = {};
        for (unsigned int k = 0; k < stencil.size; ++k)
          for (unsigned int a = 0; a < dim; ++a)
            for (unsigned int b = 0; b < dim; ++b)
              sums[a][b] += linear.node(stencil.neighbour[k])[a] *
                            stencil.gradient[k * Stencils::n_gradient + b];
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            worst = std::max(worst, std::abs(sums[a][b] - gradient[a][b]));
      }
    EXPECT_LT(worst, 1e-12) << name;

    // Smoothing keeps the momentum, and is the adjoint of what moves the particles.
    model.bridge->apply_smoothing(noise, result);
    const NodalVector &mass = model.bridge->nodal_mass(), &unsmoothed = model.bridge->mass();
    double lost = 0;
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (*unsmoothed.node(i) > 0.)
        lost += mass.node(i)[0] * result.node(i)[0] - *unsmoothed.node(i) * noise.node(i)[0];
    EXPECT_NEAR(sum_over_ranks(lost), 0., 1e-12) << name;
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (*unsmoothed.node(i) == 0.)
        for (NodalVector *const vector : {&other, &result})
          std::fill_n(vector->node(i), node_stride, 0.);
    other.update_ghosts();
    const double power = weighted_product(mass, other, result);
    model.bridge->apply_adjoint(other, result);
    EXPECT_NEAR(weighted_product(unsmoothed, noise, result), power, 1e-12) << name;
  }

  TEST(HangingNodes, beside_particles_keep_linear_fields_momentum_and_the_adjoint)
  {
    for (const bool has_small_particles : {true, false})
      for (const std::string bridge : {"paper", "trace"})
        for (const std::string smoothing : {"affine", "paper", "fe matched"})
        {
          check_beside_particles<2>(has_small_particles, smoothing, bridge);
          check_beside_particles<3>(has_small_particles, smoothing, bridge);
        }
  }

  /** Rigid motion makes no force, and no force does work on it. */
  TEST(HangingNodes, beside_particles_feel_no_rigid_motion)
  {
    for (const bool has_small_particles : {true, false})
    {
      const FrozenBody<3> body(coupled_block(3, has_small_particles, "affine", "paper"));
      Model<3> &model = *body.model;
      const NodalVector &positions = model.state.initial_position;
      NodalVector spin(model.state.partition()), stretch(model.state.partition()),
          force(model.state.partition());
      for (unsigned int i = 0; i < model.state.partition()->n_local(); ++i)
      {
        const double *const x = positions.node(i);
        spin.node(i)[0] = 0.3 * x[1] - 0.2 * x[2] + 1.;
        spin.node(i)[1] = -0.3 * x[0] + 0.4 * x[2];
        spin.node(i)[2] = 0.2 * x[0] - 0.4 * x[1];
      }
      set_random(positions, 0.7, stretch);
      stretch.distribute();
      const auto apply = [&](const NodalVector &velocity)
      {
        Assembly<3>(model.parts)
            .assemble(*model.bridge, velocity, force,
                      [&](const Part<3> &part, const NodalVector &seen, NodalVector &result) {
                        part.formulation->apply_elastic_stiffness(model.state.position, seen, 1e30,
                                                                  result);
                      });
      };
      apply(spin);
      EXPECT_LT(std::sqrt(force.dot(force)), 1e-12);
      apply(stretch);
      EXPECT_GT(std::sqrt(force.dot(force)), 1.);
      EXPECT_NEAR(force.dot(spin), 0., 1e-12);
    }
  }

  TEST(HangingNodes, beside_particles_have_a_stable_step_that_is_known)
  {
    for (const bool has_small_particles : {true, false})
    {
      FrozenBody<2> body(coupled_block(2, has_small_particles, "affine", "paper", "0.05"));
      const double estimate = body.estimator->estimate(*body.model).time_step;
      EXPECT_FALSE(body.grows(0.99 * estimate, 3000)) << has_small_particles;
      EXPECT_TRUE(body.grows(1.03 * estimate, 3000)) << has_small_particles;
    }
  }

  TEST(HangingNodes, that_follow_nodes_of_other_parts_are_refused)
  {
    // Of the four small cells beside a large element one is of another part.
    Block block;
    block.formulation = "coupled";
    block.cells = {4, 4, 2};
    std::string text = parameters_of(block);
    const auto replace = [&](const std::string &old_text, const std::string &new_text)
    { text = changed(text, old_text, new_text); };
    replace("set Cells = x < 2", "set Cells = x < 2 || y < 1.5");
    replace("set Type = box\n", "set Type = box\nset Refine where = x > 2 && y > 1\n");
    const auto refusal = [&] { return input_error([&] { const FrozenBody<3> body(text); }); };
    EXPECT_TRUE(
        contains(refusal(),
                 "lies in the middle of a face or edge of a large cell that ends beyond the part"));
    replace("set Formulation = momentum consistent particle", "set Formulation = rigid");
    replace("subsection momentum consistent particle\n", "subsection rigid\n");
    EXPECT_TRUE(contains(refusal(), "a node of the part lies in the middle of an edge"));
  }

  TEST(HangingNodes, are_known_to_the_estimate_of_the_stable_step)
  {
    for (const std::string formulation : {"hexahedron", "fully integrated hexahedron"})
    {
      FrozenBody<2> body(graded_block(formulation, 2));
      const double estimate = body.estimator->estimate(*body.model).time_step;
      EXPECT_FALSE(body.grows(0.99 * estimate, 3000)) << formulation;
      EXPECT_TRUE(body.grows(1.03 * estimate, 3000)) << formulation;
    }
  }
} // namespace
