// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/hanging_nodes.h>

#include <deal.II/base/memory_consumption.h>
#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  HangingNodes::HangingNodes(const std::vector<Row> &rows, const types::global_dof_index n_nodes)
      : rows(rows), node_set(n_nodes)
  {
    for (const Row &row : rows)
      for (const auto &[node, weight] : row.weights)
        node_set.add_index(node);
    node_set.compress();
  }

  const std::vector<HangingNodes::Row> &HangingNodes::owned_rows() const
  {
    return rows;
  }

  unsigned int HangingNodes::longest_chain() const
  {
    return depth;
  }

  const IndexSet &HangingNodes::required_nodes() const
  {
    return node_set;
  }

  void HangingNodes::set_partition(const std::shared_ptr<const NodePartition> &partition)
  {
    hanging.clear();
    weights.clear();
    first_weight.assign(1, 0);
    for (const Row &row : rows)
    {
      hanging.push_back(partition->local_index(row.node));
      for (const auto &[node, weight] : row.weights)
        weights.emplace_back(partition->local_index(node), weight);
      first_weight.push_back(weights.size());
    }

    NodalVector depths;
    depths.reinit(partition, 1);
    unsigned int has_changed = 1;
    depth = 1;
    while (has_changed != 0)
    {
      has_changed = 0;
      for (std::size_t row = 0; row < hanging.size(); ++row)
      {
        double of_row = 1.;
        for (std::size_t k = first_weight[row]; k < first_weight[row + 1]; ++k)
          of_row = std::max(of_row, 1. + *depths.node(weights[k].first));
        has_changed = std::max(has_changed, *depths.node(hanging[row]) != of_row ? 1u : 0u);
        *depths.node(hanging[row]) = of_row;
        depth = std::max(depth, static_cast<unsigned int>(of_row));
      }
      depths.update_ghosts();
      has_changed = Utilities::MPI::max(has_changed, partition->communicator());
    }
    depth = Utilities::MPI::max(depth, partition->communicator());
  }

  void HangingNodes::interpolate(NodalVector &field) const
  {
    const unsigned int n_slots = field.n_slots_per_node();
    field.update_ghosts();
    for (unsigned int pass = 0; pass < depth; ++pass)
    {
      for (std::size_t row = 0; row < hanging.size(); ++row)
      {
        double mean[node_stride] = {};
        for (std::size_t k = first_weight[row]; k < first_weight[row + 1]; ++k)
          for (unsigned int c = 0; c < n_slots; ++c)
            mean[c] += weights[k].second * field.node(weights[k].first)[c];
        std::copy_n(mean, n_slots, field.node(hanging[row]));
      }
      field.update_ghosts();
    }
  }

  void HangingNodes::collect(NodalVector &values) const
  {
    const unsigned int n_slots = values.n_slots_per_node();
    for (unsigned int pass = 0; pass < depth; ++pass)
    {
      for (std::size_t row = 0; row < hanging.size(); ++row)
      {
        double *const given = values.node(hanging[row]);
        for (std::size_t k = first_weight[row]; k < first_weight[row + 1]; ++k)
          for (unsigned int c = 0; c < n_slots; ++c)
            values.node(weights[k].first)[c] += weights[k].second * given[c];
        std::fill_n(given, n_slots, 0.);
      }
      values.add_to_owners();
    }
  }

  void update_ghosts(const std::shared_ptr<const HangingNodes> &nodes, NodalVector &field)
  {
    if (nodes)
      nodes->interpolate(field);
    else
      field.update_ghosts();
  }

  void collect(const std::shared_ptr<const HangingNodes> &nodes, NodalVector &values)
  {
    if (nodes)
      nodes->collect(values);
  }

  std::vector<unsigned int> with_nodes_around(const std::shared_ptr<const HangingNodes> &nodes,
                                              const std::shared_ptr<const NodePartition> &partition,
                                              std::vector<unsigned int> owned)
  {
    if (nodes)
    {
      NodalVector marks;
      marks.reinit(partition, 1);
      for (const unsigned int node : owned)
        *marks.node(node) = 1.;
      nodes->collect(marks);
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        if (*marks.node(i) > 0.)
          owned.push_back(i);
    }
    std::sort(owned.begin(), owned.end());
    owned.erase(std::unique(owned.begin(), owned.end()), owned.end());
    return owned;
  }

  std::size_t HangingNodes::memory_consumption() const
  {
    std::size_t bytes = MemoryConsumption::memory_consumption(node_set) +
                        rows.capacity() * sizeof(Row) + hanging.capacity() * sizeof(unsigned int) +
                        first_weight.capacity() * sizeof(std::size_t) +
                        weights.capacity() * sizeof(weights[0]);
    for (const Row &row : rows)
      bytes += row.weights.capacity() * sizeof(row.weights[0]);
    return bytes;
  }
} // namespace tombolo
