// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/fragments.h>

#include <deal.II/base/mpi.h>

#include <boost/pending/disjoint_sets.hpp>

#include <algorithm>
#include <array>
#include <map>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    using Sets = boost::disjoint_sets_with_storage<>;
    using Pair = std::array<std::uint64_t, 2>;
    constexpr auto is_empty = static_cast<std::uint64_t>(-1);

    /** The smallest identifier of the particles of this rank in each of the sets, by its root. */
    std::vector<std::uint64_t> smallest_ids(Sets &sets, const Stencils &shape,
                                            const std::vector<std::uint64_t> &ids,
                                            const unsigned int n_nodes)
    {
      std::vector<std::uint64_t> smallest(n_nodes, is_empty);
      for (unsigned int i = 0; i < ids.size(); ++i)
      {
        std::uint64_t &of_set = smallest[sets.find_set(shape.particle_node[i])];
        of_set = std::min(of_set, ids[i]);
      }
      return smallest;
    }

    /** Which sets of different ranks are one: pairs of their smallest identifiers, of all ranks. */
    std::vector<Pair> find_links(Sets &sets, const std::vector<std::uint64_t> &smallest,
                                 const NodePartition &partition)
    {
      const MPI_Comm communicator = partition.communicator();
      std::map<unsigned int, std::vector<Pair>> to_owners;
      unsigned int ghost = partition.n_owned();
      for (const auto &[rank, n] : partition.scalars()->ghost_targets())
        for (unsigned int k = 0; k < n; ++k, ++ghost)
          if (const std::uint64_t id = smallest[sets.find_set(ghost)]; id != is_empty)
            to_owners[rank].push_back({{partition.global_index(ghost), id}});
      std::vector<Pair> links;
      for (const auto &[rank, received] : Utilities::MPI::some_to_some(communicator, to_owners))
        for (const auto &[node, id] : received)
        {
          const std::uint64_t own = smallest[sets.find_set(
              partition.local_index(static_cast<types::global_dof_index>(node)))];
          if (own != id)
            links.push_back({{own, id}});
        }
      std::sort(links.begin(), links.end());
      links.erase(std::unique(links.begin(), links.end()), links.end());
      std::vector<Pair> of_all;
      for (const std::vector<Pair> &of_rank : Utilities::MPI::all_gather(communicator, links))
        of_all.insert(of_all.end(), of_rank.begin(), of_rank.end());
      return of_all;
    }
  } // namespace

  std::vector<std::uint64_t> find_fragments(const Stencils &shape,
                                            const std::vector<std::uint64_t> &ids,
                                            const NodePartition &partition)
  {
    const unsigned int n_nodes = partition.n_owned() + partition.n_ghosts();
    Sets sets(n_nodes);
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Stencils::Row row = shape.row(i);
      for (unsigned int k = 0; k < row.size; ++k)
        if (row.neighbour[k] < n_nodes && row.is_within_support(k))
          sets.union_set(shape.particle_node[i], row.neighbour[k]);
    }
    const std::vector<std::uint64_t> smallest = smallest_ids(sets, shape, ids, n_nodes);
    std::vector<std::uint64_t> labels;
    for (const unsigned int node : shape.particle_node)
      labels.push_back(smallest[sets.find_set(node)]);
    if (Utilities::MPI::n_mpi_processes(partition.communicator()) == 1)
      return labels;

    const std::vector<Pair> links = find_links(sets, smallest, partition);
    std::vector<std::uint64_t> linked;
    for (const Pair &link : links)
      linked.insert(linked.end(), link.begin(), link.end());
    std::sort(linked.begin(), linked.end());
    linked.erase(std::unique(linked.begin(), linked.end()), linked.end());
    const auto place = [&](const std::uint64_t id)
    {
      return static_cast<std::size_t>(std::lower_bound(linked.begin(), linked.end(), id) -
                                      linked.begin());
    };
    Sets across_ranks(linked.size());
    for (const Pair &link : links)
      across_ranks.union_set(place(link[0]), place(link[1]));
    std::vector<std::uint64_t> smallest_linked(linked.size(), is_empty);
    for (std::size_t k = 0; k < linked.size(); ++k)
    {
      std::uint64_t &of_set = smallest_linked[across_ranks.find_set(k)];
      of_set = std::min(of_set, linked[k]);
    }
    for (std::uint64_t &label : labels)
      if (std::binary_search(linked.begin(), linked.end(), label))
        label = smallest_linked[across_ranks.find_set(place(label))];
    return labels;
  }
} // namespace tombolo
