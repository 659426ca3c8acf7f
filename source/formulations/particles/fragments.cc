// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/fragments.h>

#include <tombolo/base/on_ranks.h>

#include <deal.II/base/mpi.h>

#include <boost/pending/disjoint_sets.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    using Sets = boost::disjoint_sets_with_storage<>;
    /** A particle in its body or in an image of that: its identifier, and the mirrors as bits. */
    using Copy = std::array<std::uint64_t, 2>;
    using Link = std::array<std::uint64_t, 4>; ///< two of these
    constexpr auto is_empty = static_cast<std::uint64_t>(-1);

    Copy first_of(const Link &link)
    {
      return {{link[0], link[1]}};
    }
    Copy second_of(const Link &link)
    {
      return {{link[2], link[3]}};
    }

    /** The sets of nodes of this rank that bonds connect, in the body and in all its images. */
    class ConnectedNodes
    {
    public:
      ConnectedNodes(const Stencils &shape, const NodePartition &partition, const Images &images)
          : n_copies(1u << images.all.size()), n_nodes(partition.n_owned() + partition.n_ghosts()),
            sets(std::size_t(n_nodes) * n_copies)
      {
        for (unsigned int i = 0; i < shape.n_particles(); ++i)
        {
          const Stencils::Row row = shape.row(i);
          for (unsigned int k = 0; k < row.size; ++k)
            if (row.is_within_support(k))
              connect(shape.particle_node[i], row.neighbour[k], partition, images);
        }
        for (const NodePartition::Reflected &on_plane : partition.nodes_on_planes())
          connect(on_plane.source, on_plane.source, mirrors_of(on_plane.reflection, images));
      }

      std::size_t set_of(const unsigned int node, const unsigned int mirrors)
      {
        return sets.find_set(std::size_t(node) * n_copies + mirrors);
      }

      const unsigned int n_copies, n_nodes;

    private:
      void connect(const unsigned int node, const unsigned int other, const unsigned int through)
      {
        for (unsigned int mirrors = 0; mirrors < n_copies; ++mirrors)
          sets.union_set(std::size_t(node) * n_copies + mirrors,
                         std::size_t(other) * n_copies + (mirrors ^ through));
      }

      void connect(const unsigned int node, const unsigned int neighbour,
                   const NodePartition &partition, const Images &images)
      {
        if (neighbour < n_nodes)
          connect(node, neighbour, 0u);
        else
        {
          const NodePartition::Reflected &image = partition.images()[neighbour - n_nodes];
          connect(node, image.source, mirrors_of(image.reflection, images));
        }
      }

      Sets sets;
    };

    /** The smallest particle of this rank in each of the sets, by its root. */
    std::vector<Copy> smallest_particles(ConnectedNodes &connected, const Stencils &shape,
                                         const std::vector<std::uint64_t> &ids)
    {
      std::vector<Copy> smallest(std::size_t(connected.n_nodes) * connected.n_copies,
                                 {{is_empty, is_empty}});
      for (unsigned int i = 0; i < ids.size(); ++i)
        for (unsigned int mirrors = 0; mirrors < connected.n_copies; ++mirrors)
        {
          Copy &smallest_of_set = smallest[connected.set_of(shape.particle_node[i], mirrors)];
          smallest_of_set = std::min(smallest_of_set, {{ids[i], mirrors}});
        }
      return smallest;
    }

    /** Which sets of different ranks are one: pairs of their smallest particles, of all ranks. */
    std::vector<Link> find_links(ConnectedNodes &connected, const std::vector<Copy> &smallest,
                                 const NodePartition &partition)
    {
      const MPI_Comm communicator = partition.communicator();
      std::map<unsigned int, std::vector<Link>> to_owners;
      unsigned int ghost = partition.n_owned();
      for (const auto &[rank, n] : partition.scalars()->ghost_targets())
        for (unsigned int k = 0; k < n; ++k, ++ghost)
          for (unsigned int mirrors = 0; mirrors < connected.n_copies; ++mirrors)
            if (const Copy &smallest_of_set = smallest[connected.set_of(ghost, mirrors)];
                smallest_of_set[0] != is_empty)
              to_owners[rank].push_back({{partition.global_index(ghost), mirrors,
                                          smallest_of_set[0], smallest_of_set[1]}});
      std::vector<Link> links;
      for (const auto &[rank, received] : exchange_by_rank(std::move(to_owners), communicator))
        for (const auto &[node, mirrors, id, id_mirrors] : received)
        {
          const Copy &own = smallest[connected.set_of(
              partition.local_index(static_cast<types::global_dof_index>(node)),
              static_cast<unsigned int>(mirrors))];
          if (own != Copy{{id, id_mirrors}})
            links.push_back({{own[0], own[1], id, id_mirrors}});
        }
      std::sort(links.begin(), links.end());
      links.erase(std::unique(links.begin(), links.end()), links.end());
      return from_all_ranks(links, communicator);
    }

    /** Replaces smallest particles on a rank by those of all ranks. Collective. */
    class AcrossRanks
    {
    public:
      explicit AcrossRanks(const std::vector<Link> &links) : sets(2 * links.size())
      {
        for (const Link &link : links)
        {
          linked.push_back(first_of(link));
          linked.push_back(second_of(link));
        }
        std::sort(linked.begin(), linked.end());
        linked.erase(std::unique(linked.begin(), linked.end()), linked.end());
        for (const Link &link : links)
          sets.union_set(index_of(first_of(link)), index_of(second_of(link)));
        smallest.assign(linked.size(), {{is_empty, is_empty}});
        for (std::size_t k = 0; k < linked.size(); ++k)
        {
          Copy &smallest_of_set = smallest[sets.find_set(k)];
          smallest_of_set = std::min(smallest_of_set, linked[k]);
        }
      }

      Copy operator()(const Copy &rank_smallest)
      {
        return std::binary_search(linked.begin(), linked.end(), rank_smallest)
                   ? smallest[sets.find_set(index_of(rank_smallest))]
                   : rank_smallest;
      }

    private:
      std::size_t index_of(const Copy &copy) const
      {
        return static_cast<std::size_t>(std::lower_bound(linked.begin(), linked.end(), copy) -
                                        linked.begin());
      }

      std::vector<Copy> linked, smallest;
      Sets sets;
    };
  } // namespace

  unsigned int mirrors_of(const Images::Map &reflection, const Images &images)
  {
    unsigned int result = 0;
    for (unsigned int m = 0; m < images.all.size(); ++m)
    {
      const unsigned int axis = images.all[m].axis;
      if (reflection.sign[axis] < 0. && reflection.offset[axis] == images.map(1u << m).offset[axis])
        result |= 1u << m;
    }
    return result;
  }

  unsigned long n_labels_here(const std::vector<FragmentOfParticle> &fragments,
                              const std::vector<std::uint64_t> &ids)
  {
    return std::inner_product(fragments.begin(), fragments.end(), ids.begin(), 0ul, std::plus<>(),
                              [](const FragmentOfParticle &fragment, const std::uint64_t id)
                              { return fragment.label == id; });
  }

  std::vector<FragmentOfParticle> find_fragments(const Stencils &shape,
                                                 const std::vector<std::uint64_t> &ids,
                                                 const NodePartition &partition,
                                                 const Images &images)
  {
    ConnectedNodes connected(shape, partition, images);
    const std::vector<Copy> smallest = smallest_particles(connected, shape, ids);
    AcrossRanks across_ranks(Utilities::MPI::n_mpi_processes(partition.communicator()) > 1
                                 ? find_links(connected, smallest, partition)
                                 : std::vector<Link>());
    std::vector<FragmentOfParticle> result;
    for (const unsigned int node : shape.particle_node)
    {
      FragmentOfParticle fragment;
      for (unsigned int mirrors = 0; mirrors < connected.n_copies; ++mirrors)
      {
        const Copy label = across_ranks(smallest[connected.set_of(node, mirrors)]);
        fragment.label = label[0];
        // A particle reached from an image of the label: and its image from the label itself.
        if (label[1] == 0)
          fragment.copies |= std::uint64_t(1) << mirrors;
      }
      result.push_back(fragment);
    }
    return result;
  }
} // namespace tombolo
