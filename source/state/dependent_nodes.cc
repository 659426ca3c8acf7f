// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/dependent_nodes.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <map>
#include <set>

namespace tombolo
{
  using namespace dealii;

  std::vector<unsigned int>
  with_nodes_depended_on(const std::shared_ptr<const NodePartition> &partition,
                         std::vector<unsigned int> owned)
  {
    if (partition->has_dependent_nodes())
    {
      NodalVector marks(partition, Quantity::scalar);
      for (const unsigned int node : owned)
        *marks.node(node) = 1.;
      marks.condense();
      const std::vector<unsigned int> further = positive_nodes(marks, partition->n_owned());
      owned.insert(owned.end(), further.begin(), further.end());
    }
    std::sort(owned.begin(), owned.end());
    owned.erase(std::unique(owned.begin(), owned.end()), owned.end());
    return owned;
  }

  DependentRows::DependentRows(const NodalVector &is_zero)
  {
    const NodePartition &partition = *is_zero.partition();
    const NodePartition::DependentNodes &dependent = partition.dependent_nodes();
    if (partition.has_dependent_nodes())
    {
      std::vector<std::pair<types::global_dof_index, Weights>> owned;
      for (std::size_t row = 0; row < dependent.node.size(); ++row)
      {
        owned.push_back({partition.global_index(dependent.node[row]), {}});
        for (std::size_t k = dependent.start[row]; k < dependent.start[row + 1]; ++k)
          if (const auto &[other, weight] = dependent.weights[k]; !(*is_zero.node(other) > 0.))
            owned.back().second.emplace_back(partition.global_index(other), weight);
      }
      for (const auto &rank_rows : Utilities::MPI::all_gather(partition.communicator(), owned))
        for (const auto &[node, weights] : rank_rows)
        {
          rows.add_line(node);
          rows.add_entries(node, weights);
        }
    }
    rows.close();
  }

  DependentRows::Weights DependentRows::weights(const types::global_dof_index node) const
  {
    return depends(node) ? *rows.get_constraint_entries(node) : Weights(1, {node, 1.});
  }

  DependentRows::Nodes DependentRows::independent(const Nodes &nodes) const
  {
    if (std::none_of(nodes.begin(), nodes.end(), [this](const auto node) { return depends(node); }))
      return nodes;
    std::set<types::global_dof_index> result;
    for (const types::global_dof_index node : nodes)
      for (const auto &weight : weights(node))
        result.insert(weight.first);
    return Nodes(result.begin(), result.end());
  }

  std::vector<double> DependentRows::condensed(const Nodes &nodes, const Nodes &independent_nodes,
                                               const std::vector<double> &entries,
                                               const unsigned int n_components) const
  {
    const std::size_t n = nodes.size() * n_components,
                      n_independent = independent_nodes.size() * n_components;
    std::vector<std::vector<std::pair<std::size_t, double>>> terms(nodes.size());
    for (std::size_t k = 0; k < nodes.size(); ++k)
      for (const auto &[node, weight] : weights(nodes[k]))
      {
        const auto found =
            std::lower_bound(independent_nodes.begin(), independent_nodes.end(), node);
        terms[k].emplace_back(static_cast<std::size_t>(found - independent_nodes.begin()), weight);
      }
    std::vector<double> result(n_independent * n_independent, 0.);
    for (std::size_t row = 0; row < n; ++row)
      for (const auto &[at_row, row_weight] : terms[row / n_components])
        for (std::size_t column = 0; column < n; ++column)
          for (const auto &[at_column, column_weight] : terms[column / n_components])
            result[(at_row * n_components + row % n_components) * n_independent +
                   at_column * n_components + column % n_components] +=
                row_weight * column_weight * entries[row * n + column];
    return result;
  }

  void DependentRows::condense_columns(Nodes &columns, std::vector<double> &values) const
  {
    if (is_empty())
      return;
    std::map<types::global_dof_index, double> sums;
    for (std::size_t k = 0; k < columns.size(); ++k)
      for (const auto &[column, weight] : weights(columns[k]))
        sums[column] += weight * values[k];
    columns.clear();
    values.clear();
    for (const auto &[column, value] : sums)
    {
      columns.push_back(column);
      values.push_back(value);
    }
  }
} // namespace tombolo
