#include <tombolo/state/nodal_vector.h>

#include <tombolo/base/ordered_sum.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  void NodalVector::reinit(const std::shared_ptr<const NodePartition> &partition,
                           const unsigned int slots)
  {
    Assert(slots == 1 || slots == n_slots, ExcInternalError());
    node_partition = partition;
    this->slots = slots;
    storage.reinit(slots == 1 ? partition->scalars() : partition->vectors());
    values = storage.begin();
    set_zero();
  }

  void NodalVector::move_to(const std::shared_ptr<const NodePartition> &partition)
  {
    Assert(partition->owned() == node_partition->owned(), ExcInternalError());
    LinearAlgebra::distributed::Vector<double> old;
    old.swap(storage);
    storage.reinit(slots == 1 ? partition->scalars() : partition->vectors());
    node_partition = partition;
    values = storage.begin();
    std::copy(old.begin(), old.begin() + old.locally_owned_size(), values);
    update_ghosts();
  }

  unsigned int NodalVector::n_slots_per_node() const
  {
    return slots;
  }

  const std::shared_ptr<const NodePartition> &NodalVector::partition() const
  {
    return node_partition;
  }

  void NodalVector::set_zero()
  {
    storage.set_ghost_state(false);
    std::fill_n(values, static_cast<std::size_t>(node_partition->n_local()) * slots, 0.);
  }

  void NodalVector::copy_from(const NodalVector &other)
  {
    Assert(other.slots == slots && other.node_partition == node_partition, ExcInternalError());
    std::copy_n(other.values, static_cast<std::size_t>(node_partition->n_local()) * slots, values);
    storage.set_ghost_state(other.storage.has_ghost_elements());
  }

  void NodalVector::update_ghosts()
  {
    storage.update_ghost_values();
  }

  void NodalVector::add_to_owners()
  {
    storage.set_ghost_state(false);
    storage.compress(VectorOperation::add);
  }

  double NodalVector::dot(const NodalVector &other) const
  {
    double sum = 0;
    const std::size_t n = static_cast<std::size_t>(node_partition->n_owned()) * slots;
    for (std::size_t i = 0; i < n; ++i)
      sum += values[i] * other.values[i];
    return ordered_sum(sum, node_partition->communicator());
  }

  std::size_t NodalVector::memory_consumption() const
  {
    return storage.memory_consumption();
  }
} // namespace tombolo
