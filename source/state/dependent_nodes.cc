// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/dependent_nodes.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  std::vector<unsigned int>
  with_nodes_depended_on(const std::shared_ptr<const NodePartition> &partition,
                         std::vector<unsigned int> owned)
  {
    if (partition->dependent_nodes().depth > 0)
    {
      NodalVector marks;
      marks.reinit(partition, Quantity::scalar);
      for (const unsigned int node : owned)
        *marks.node(node) = 1.;
      marks.condense();
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        if (*marks.node(i) > 0.)
          owned.push_back(i);
    }
    std::sort(owned.begin(), owned.end());
    owned.erase(std::unique(owned.begin(), owned.end()), owned.end());
    return owned;
  }

  AffineConstraints<double> constraints_of_dependent_nodes(const NodalVector &is_zero)
  {
    const NodePartition &partition = *is_zero.partition();
    const NodePartition::DependentNodes &dependent = partition.dependent_nodes();
    AffineConstraints<double> result;
    if (dependent.depth > 0)
    {
      std::vector<DependentNode> rows;
      for (std::size_t row = 0; row < dependent.node.size(); ++row)
      {
        rows.push_back({partition.global_index(dependent.node[row]), {}});
        for (std::size_t k = dependent.start[row]; k < dependent.start[row + 1]; ++k)
          if (const auto &[other, weight] = dependent.weights[k]; !(*is_zero.node(other) > 0.))
            rows.back().weights.emplace_back(partition.global_index(other), weight);
      }
      for (const auto &of_rank : Utilities::MPI::all_gather(partition.communicator(), rows))
        for (const DependentNode &row : of_rank)
        {
          result.add_line(row.node);
          result.add_entries(row.node, row.weights);
        }
    }
    result.close();
    return result;
  }
} // namespace tombolo
