// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include "frozen_body.h"
#include "material_testing.h"
#include "text_testing.h"

#include <tombolo/simulation/run_summary.h>

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <set>
#include <utility>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      /** A bar of copper, half of elements and half of particles. */
      std::string bar(const std::string &element, const std::string &model)
      {
        Block block;
        block.formulation = "coupled";
        block.element = element;
        block.cells = {24, 6, 6};
        std::string text = parameters_of(block);
        const std::size_t begin = text.find("set Model = elastic");
        const std::size_t end = text.find("end\n", begin);
        AssertThrow(begin != std::string::npos, dealii::ExcMessage("no material"));
        const std::string entries =
            model == "elastic"
                ? "set Density = 1\nset Young's modulus = 1\nset Poisson's ratio = 0.3\n"
                : copper();
        return text.replace(begin, end - begin,
                            "set Model = " + model + "\nsubsection " + model + "\n" + entries);
      }

      StepCost cost_of_part(const Model<3> &model, const unsigned int part,
                            const double box_ratio = 1.)
      {
        return model.parts[part].formulation->step_cost(*model.parts[part].material, box_ratio);
      }

      /** The sum over this rank's cells and nodes. */
      double cost_of_rank(const Model<3> &model)
      {
        double cost = 0;
        std::set<std::pair<unsigned int, dealii::types::global_dof_index>> nodes;
        for (const auto &cell : model.nodes->dof_handler().active_cell_iterators())
          if (!cell->is_artificial())
          {
            const unsigned int part = model.part_cells->part_of(cell);
            const StepCost part_cost = cost_of_part(model, part);
            if (cell->is_locally_owned())
              cost += part_cost.per_cell;
            for (const unsigned int v : cell->vertex_indices())
            {
              const auto node = cell->vertex_dof_index(v, 0);
              if (model.nodes->owned().is_element(node) && nodes.emplace(part, node).second)
                cost += part_cost.per_node;
            }
          }
        return cost;
      }

      double cost(const std::string &element, const std::string &material, const unsigned int part)
      {
        const StepCost part_cost = cost_of_part(*make_model<3>(bar(element, material)), part);
        return part_cost.per_cell + part_cost.per_node;
      }

      TEST(RankBalance, all_ranks_have_the_same_cost)
      {
        for (const std::string material : {"elastic", "j2 plasticity"})
        {
          const auto model = make_model<3>(bar("fully integrated hexahedron", material));
          const auto costs =
              dealii::Utilities::MPI::min_max_avg(cost_of_rank(*model), MPI_COMM_WORLD);
          EXPECT_LT(costs.max, 1.04 * costs.avg) << material;
        }
      }

      TEST(RankBalance, a_material_costs_the_same_at_each_point)
      {
        const std::string one_point = "hexahedron", eight_points = "fully integrated hexahedron";
        const double one_point_cost =
            cost(one_point, "j2 plasticity", 0) - cost(one_point, "elastic", 0);
        const double eight_point_cost =
            cost(eight_points, "j2 plasticity", 0) - cost(eight_points, "elastic", 0);
        const double particle_cost =
            cost(one_point, "j2 plasticity", 1) - cost(one_point, "elastic", 1);
        EXPECT_GT(one_point_cost, 0.);
        EXPECT_NEAR(eight_point_cost, 8. * one_point_cost, 1e-9 * eight_point_cost);
        EXPECT_NEAR(particle_cost, one_point_cost, 1e-9 * one_point_cost);
      }

      TEST(RankBalance, supports_around_a_turned_lattice_hold_more_particles)
      {
        const auto model = make_model<3>(bar("hexahedron", "elastic"));
        EXPECT_EQ(cost_of_part(*model, 0, 2.).per_cell, cost_of_part(*model, 0).per_cell);
        EXPECT_GT(cost_of_part(*model, 1, 2.).per_node, 1.5 * cost_of_part(*model, 1).per_node);
      }

      TEST(RankBalance, what_ranks_exchange_is_counted)
      {
        const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
        const auto model = make_model<3>(bar("hexahedron", "elastic"));
        const NodePartition &partition = *model->state.partition();
        partition.exchange_cost() = ExchangeCost();
        model->state.position.update_ghosts();
        model->state.force.add_to_owners();
        const ExchangeCost cost = partition.exchange_cost();
        const double n_ghosts =
            dealii::Utilities::MPI::sum(double(partition.n_ghosts()), MPI_COMM_WORLD);
        const double n_doubles =
            dealii::Utilities::MPI::sum(double(cost.n_doubles), MPI_COMM_WORLD);
        EXPECT_EQ(cost.n_exchanges, n_ranks == 1 ? 0u : 2u);
        EXPECT_EQ(n_doubles, 2. * node_stride * n_ghosts);
        EXPECT_EQ(cost.n_messages > 0, n_ranks > 1);
        EXPECT_EQ(cost.seconds > 0., n_ranks > 1);

        NodePartition next(partition.owned(), partition.ghosts(), MPI_COMM_WORLD);
        next.continue_counting(partition);
        EXPECT_EQ(next.exchange_cost().n_doubles, cost.n_doubles);

        const std::string text = json_text(describe_rank_balance(partition, 10., 1.));
        EXPECT_TRUE(contains(text, "\"exchanges_per_step\": " + std::to_string(cost.n_exchanges)));
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
