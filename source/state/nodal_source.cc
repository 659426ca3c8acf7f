// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/nodal_source.h>

#include <algorithm>

namespace tombolo
{
  void NodalSource::set_partition(const std::shared_ptr<const NodePartition> &partition)
  {
    if (values.partition() == nullptr)
      values.reinit(partition, quantity);
    else if (values.partition() != partition)
    {
      values.move_to(partition);
      is_anywhere = true; // ghosts have values, too
    }
  }

  void NodalSource::clear()
  {
    if (is_anywhere)
      values.set_zero();
    for (const unsigned int node : touched)
      std::fill_n(values.node(node), values.n_slots_per_node(), 0.);
    is_anywhere = false;
    touched.clear();
  }

  void NodalSource::gather()
  {
    if (!is_on_rank)
      values.add_to_owners();
    values.condense();
    const NodePartition &partition = *values.partition();
    constexpr std::size_t few = 4; // a sorted list costs more than some nodes that have nothing
    is_anywhere = is_anywhere || partition.has_dependent_nodes() ||
                  few * touched.size() > partition.n_owned();
    if (is_anywhere)
      return;
    if (!is_on_rank)
      touched.insert(touched.end(), partition.receiving_nodes().begin(),
                     partition.receiving_nodes().end());
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    touched.erase(std::lower_bound(touched.begin(), touched.end(), partition.n_owned()),
                  touched.end()); // cleared by their owners
  }
} // namespace tombolo
