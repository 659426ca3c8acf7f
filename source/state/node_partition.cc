#include <tombolo/state/node_partition.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The set of the n_slots entries of each node of a set of nodes. */
    IndexSet slots_of(const IndexSet &nodes)
    {
      IndexSet slots(nodes.size() * n_slots);
      for (auto interval = nodes.begin_intervals(); interval != nodes.end_intervals(); ++interval)
        slots.add_range(*interval->begin() * n_slots, (interval->last() + 1) * n_slots);
      slots.compress();
      return slots;
    }
  } // namespace

  NodePartition::NodePartition(const IndexSet &owned, const IndexSet &ghosts, MPI_Comm communicator)
  {
    IndexSet only_ghosts = ghosts;
    only_ghosts.subtract_set(owned);
    only_ghosts.compress();
    scalar_partitioner =
        std::make_shared<const Utilities::MPI::Partitioner>(owned, only_ghosts, communicator);
    vector_partitioner = std::make_shared<const Utilities::MPI::Partitioner>(
        slots_of(owned), slots_of(only_ghosts), communicator);
  }

  unsigned int NodePartition::n_owned() const
  {
    return scalar_partitioner->locally_owned_size();
  }

  unsigned int NodePartition::n_ghosts() const
  {
    return scalar_partitioner->n_ghost_indices();
  }

  unsigned int NodePartition::n_local() const
  {
    return n_owned() + n_ghosts();
  }

  types::global_dof_index NodePartition::n_global() const
  {
    return scalar_partitioner->size();
  }

  unsigned int NodePartition::local_index(const types::global_dof_index node) const
  {
    return scalar_partitioner->global_to_local(node);
  }

  types::global_dof_index NodePartition::global_index(const unsigned int local) const
  {
    return scalar_partitioner->local_to_global(local);
  }

  bool NodePartition::has(const types::global_dof_index node) const
  {
    return scalar_partitioner->in_local_range(node) || scalar_partitioner->is_ghost_entry(node);
  }

  const IndexSet &NodePartition::owned() const
  {
    return scalar_partitioner->locally_owned_range();
  }

  const IndexSet &NodePartition::ghosts() const
  {
    return scalar_partitioner->ghost_indices();
  }

  MPI_Comm NodePartition::communicator() const
  {
    return scalar_partitioner->get_mpi_communicator();
  }

  const std::shared_ptr<const Utilities::MPI::Partitioner> &NodePartition::scalars() const
  {
    return scalar_partitioner;
  }

  const std::shared_ptr<const Utilities::MPI::Partitioner> &NodePartition::vectors() const
  {
    return vector_partitioner;
  }
} // namespace tombolo
