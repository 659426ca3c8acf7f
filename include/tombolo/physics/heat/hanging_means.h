// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>

#include <deal.II/base/mpi.h>

#include <map>
#include <utility>
#include <vector>

namespace tombolo
{
  /** The nodes between which others hang, with weights; those with prescribed temperatures, which
   * do not change, are left out. All ranks know all of them. */
  class HangingMeans
  {
  public:
    using Weights = std::vector<std::pair<dealii::types::global_dof_index, double>>;

    /** Collective. */
    template <int dim>
    HangingMeans(const Model<dim> &model, const NodalVector &is_constrained)
    {
      if (!model.hanging_nodes)
        return;
      const NodePartition &partition = *is_constrained.partition();
      std::vector<dealii::types::global_dof_index> nodes; // one, how many others, these
      std::vector<double> weights;
      for (const HangingNodes::Row &row : model.hanging_nodes->owned_rows())
      {
        nodes.push_back(row.node);
        const std::size_t count = nodes.size();
        nodes.push_back(0);
        for (const auto &[other, weight] : row.weights)
          if (!(*is_constrained.node(partition.local_index(other)) > 0.))
          {
            nodes.push_back(other);
            weights.push_back(weight);
            ++nodes[count];
          }
      }
      const auto nodes_of_ranks =
          dealii::Utilities::MPI::all_gather(partition.communicator(), nodes);
      const auto weights_of_ranks =
          dealii::Utilities::MPI::all_gather(partition.communicator(), weights);
      for (std::size_t rank = 0; rank < nodes_of_ranks.size(); ++rank)
      {
        auto node = nodes_of_ranks[rank].begin();
        auto weight = weights_of_ranks[rank].begin();
        while (node != nodes_of_ranks[rank].end())
        {
          Weights &row = rows[*node++];
          for (auto n = *node++; n > 0; --n)
            row.emplace_back(*node++, *weight++);
        }
      }
      for (unsigned int pass = 1; pass < model.hanging_nodes->longest_chain(); ++pass)
        for (auto &row : rows)
          row.second = resolved(row.second);
    }

    /** Those of a node; itself where it does not hang. */
    Weights of(const dealii::types::global_dof_index node) const
    {
      const auto row = rows.find(node);
      return row == rows.end() ? Weights(1, {node, 1.}) : row->second;
    }

    bool hangs(const dealii::types::global_dof_index node) const
    {
      return rows.count(node) > 0;
    }

    /** Moves the columns of a row to where they act. */
    void fold(std::vector<dealii::types::global_dof_index> &columns,
              std::vector<double> &values) const
    {
      if (rows.empty())
        return;
      std::map<dealii::types::global_dof_index, double> folded;
      for (std::size_t k = 0; k < columns.size(); ++k)
        for (const auto &[column, weight] : of(columns[k]))
          folded[column] += weight * values[k];
      columns.clear();
      values.clear();
      for (const auto &[column, value] : folded)
      {
        columns.push_back(column);
        values.push_back(value);
      }
    }

  private:
    Weights resolved(const Weights &row) const
    {
      Weights result;
      for (const auto &[node, weight] : row)
        for (const auto &[other, of_node] : of(node))
          result.emplace_back(other, weight * of_node);
      return result;
    }

    std::map<dealii::types::global_dof_index, Weights> rows;
  };
} // namespace tombolo
