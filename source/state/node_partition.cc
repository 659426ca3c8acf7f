// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/node_partition.h>

#include <tombolo/mesh/nodes.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    /** The set of the node_stride entries of each node of a set of nodes. */
    IndexSet slots_of(const IndexSet &nodes)
    {
      IndexSet slots(nodes.size() * node_stride);
      for (auto interval = nodes.begin_intervals(); interval != nodes.end_intervals(); ++interval)
        slots.add_range(*interval->begin() * node_stride, (interval->last() + 1) * node_stride);
      slots.compress();
      return slots;
    }
  } // namespace

  NodePartition::NodePartition(const IndexSet &owned, const IndexSet &ghosts, MPI_Comm communicator,
                               const std::shared_ptr<const Images> &images,
                               const std::vector<ImageNode> &nodes)
      : all_images(images), image_nodes(nodes)
  {
    IndexSet only_ghosts = ghosts;
    only_ghosts.subtract_set(owned);
    only_ghosts.compress();
    scalar_partitioner =
        std::make_shared<const Utilities::MPI::Partitioner>(owned, only_ghosts, communicator);
    vector_partitioner = std::make_shared<const Utilities::MPI::Partitioner>(
        slots_of(owned), slots_of(only_ghosts), communicator);
    for (const auto &[begin, end] : scalar_partitioner->import_indices())
      for (unsigned int node = begin; node < end; ++node)
        receivers.push_back(node);
    std::sort(image_nodes.begin(), image_nodes.end());
    image_nodes.erase(std::unique(image_nodes.begin(), image_nodes.end()), image_nodes.end());
    for (const ImageNode &image : image_nodes)
    {
      reflected_images.push_back({local_index(image.source), images->map(image.mirrors)});
      if (reflected_images.back().source < n_owned())
        receivers.push_back(reflected_images.back().source);
    }
    for (unsigned int m = 0; m < images->all.size(); ++m)
      for (const types::global_dof_index node : images->all[m].own_images)
        reflected_onto_themselves.push_back({local_index(node), images->map(1u << m)});
  }

  void NodePartition::set_dependent_nodes(const std::vector<DependentNode> &rows)
  {
    dependent = {};
    dependent.start.assign(1, 0);
    for (const DependentNode &row : rows)
    {
      dependent.node.push_back(local_index(row.node));
      for (const auto &[node, weight] : row.weights)
        dependent.weights.emplace_back(local_index(node), weight);
      dependent.start.push_back(dependent.weights.size());
    }
    some_rank_has_dependent_nodes =
        Utilities::MPI::max(dependent.node.empty() ? 0u : 1u, communicator()) > 0;
  }

  unsigned int NodePartition::local_index(const ImageNode &image) const
  {
    const auto found = std::lower_bound(image_nodes.begin(), image_nodes.end(), image);
    Assert(found != image_nodes.end() && *found == image, ExcInternalError());
    return n_owned() + n_ghosts() + static_cast<unsigned int>(found - image_nodes.begin());
  }

  template <int dim>
  std::shared_ptr<NodePartition> partition_of(const Nodes<dim> &nodes, IndexSet required,
                                              const std::vector<ImageNode> &images)
  {
    std::vector<DependentNode> rows;
    for (const DependentNode &row : nodes.dependent_nodes())
      if (nodes.owned().is_element(row.node))
      {
        rows.push_back(row);
        for (const auto &weight : row.weights)
          required.add_index(weight.first);
      }
    required.compress();
    const auto result = std::make_shared<NodePartition>(
        nodes.owned(), required, nodes.communicator(), nodes.images(), images);
    if (nodes.has_dependent_nodes())
      result->set_dependent_nodes(rows);
    return result;
  }

  template std::shared_ptr<NodePartition> partition_of(const Nodes<2> &, IndexSet,
                                                       const std::vector<ImageNode> &);
  template std::shared_ptr<NodePartition> partition_of(const Nodes<3> &, IndexSet,
                                                       const std::vector<ImageNode> &);
} // namespace tombolo
