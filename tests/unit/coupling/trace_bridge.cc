// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
// The effect of the trace bridge on velocities and forces, without the rest of a step.
#include "frozen_body.h"
#include "nodal_fields.h"

#include <tombolo/approximation/nodal_smoothing.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      Block traced_block()
      {
        Block block;
        block.formulation = "coupled";
        block.bridge = "trace";
        block.cells = {5, 4, 4};
        block.mesh_options = "set Disorder = 0.2";
        return block;
      }

      TEST(TraceBridge, elements_see_the_field_of_the_particles_at_shared_nodes)
      {
        FrozenBody<3> body(traced_block());
        Model<3> &model = *body.model;
        const NodalVector velocity = disordered_field(model);
        const NodalVector &seen = model.bridge->element_velocity(velocity);
        std::vector<bool> is_shared(model.state.partition()->n_owned(), false);
        const Stencils &stencils = model.parts[1].particles->stencils();
        unsigned int n_shared = 0;
        for (unsigned int row = 0; row < stencils.n_particles(); ++row)
        {
          const unsigned int node = stencils.particle_node[row];
          if (!(*model.element_mass.node(node) > 0.))
            continue;
          ++n_shared;
          is_shared[node] = true;
          const NodeLanes field = NodalSmoothing::gather_row(stencils.row(row), velocity.data());
          for (unsigned int d = 0; d < 3; ++d)
            EXPECT_NEAR(seen.node(node)[d], field[d], 1e-14);
        }
        EXPECT_EQ(dealii::Utilities::MPI::sum(n_shared, MPI_COMM_WORLD), 25u);
        for (unsigned int i = 0; i < is_shared.size(); ++i)
          for (unsigned int d = 0; d < 3 && !is_shared[i]; ++d)
            EXPECT_EQ(seen.node(i)[d], velocity.node(i)[d]);
      }

      TEST(TraceBridge, elements_see_on_each_rank_what_the_owner_of_a_node_has)
      {
        FrozenBody<3> body(traced_block());
        Model<3> &model = *body.model;
        const NodalVector velocity = disordered_field(model);
        const NodalVector &seen = model.bridge->element_velocity(velocity);
        NodalVector current = seen.copy();
        current.update_ghosts();
        for (unsigned int i = 0; i < velocity.partition()->n_local(); ++i)
          for (unsigned int d = 0; d < 3; ++d)
            EXPECT_EQ(seen.node(i)[d], current.node(i)[d]);
      }

      TEST(TraceBridge, forces_of_elements_keep_their_sum_and_their_power)
      {
        FrozenBody<3> body(traced_block());
        Model<3> &model = *body.model;
        const auto &partition = *model.state.partition();
        const NodalVector velocity = disordered_field(model);
        NodalVector element_force(model.state.partition()), force(model.state.partition());
        std::vector<double> given(4, 0.), taken(4, 0.); // sum, power
        const NodalVector &seen = model.bridge->element_velocity(velocity);
        for (unsigned int i = 0; i < partition.n_local(); ++i) // also at nodes of other ranks
        {
          const double *const x = model.state.initial_position.node(i);
          for (unsigned int d = 0; d < 3; ++d)
          {
            const double value = 1. + d + std::cos(37.1 * x[0] - 23.3 * x[1] + 11.9 * x[2] + d);
            element_force.node(i)[d] = value;
            given[d] += value;
            given[3] += value * seen.node(i)[d];
          }
        }
        model.bridge->collect_element_force(element_force, force);
        for (unsigned int i = 0; i < partition.n_owned(); ++i)
          for (unsigned int d = 0; d < 3; ++d)
          {
            taken[d] += force.node(i)[d];
            taken[3] += force.node(i)[d] * velocity.node(i)[d];
          }
        for (unsigned int k = 0; k < 4; ++k)
        {
          given[k] = sum_over_ranks(given[k]);
          EXPECT_NEAR(sum_over_ranks(taken[k]), given[k], 1e-12 * std::abs(given[0]));
        }
        EXPECT_GT(std::abs(given[3]), 1e-3 * given[0]);
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
