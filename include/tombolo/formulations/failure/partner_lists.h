// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/formulations/elements/split_number.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/node_partition.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/types.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace tombolo
{
  /** The other end of a bond: a particle, or its image through some planes of symmetry. */
  struct BondPartner
  {
    std::uint64_t id;     ///< persistent identifier
    std::uint64_t planes; ///< of the image; 0: the particle itself

    bool operator<(const BondPartner &other) const
    {
      return std::tie(id, planes) < std::tie(other.id, other.planes);
    }
    bool operator==(const BondPartner &other) const
    {
      return id == other.id && planes == other.planes;
    }
  };

  /** A partner for the list of a particle that can be of another rank. */
  struct PartnerMessage
  {
    dealii::types::global_dof_index end; ///< the particle whose list it is for
    BondPartner other;
  };

  /** Value i becomes the one that was number old_index[i], or a new one where there was none. */
  template <typename Value>
  void rearrange(const std::vector<unsigned int> &old_index, std::vector<Value> &values)
  {
    std::vector<Value> old = std::exchange(values, {});
    values.resize(old_index.size());
    for (std::size_t i = 0; i < old_index.size(); ++i)
      if (old_index[i] < old.size())
        values[i] = std::move(old[old_index[i]]);
  }

  /** For each particle of this rank a set of partners, kept as an ascending list. */
  class PartnerLists
  {
  public:
    using List = std::vector<BondPartner>;

    /** @p n empty lists. */
    void reset(const std::size_t n)
    {
      lists.assign(n, {});
    }
    /** @p n lists: those that are there stay, further ones are empty. */
    void resize(const std::size_t n)
    {
      lists.resize(n);
    }
    /** List i becomes the one that was number old_index[i], or is empty where there was none. */
    void rearrange(const std::vector<unsigned int> &old_index)
    {
      tombolo::rearrange(old_index, lists);
    }

    std::size_t size() const
    {
      return lists.size();
    }
    const List &operator[](const std::size_t i) const
    {
      return lists[i];
    }
    bool has(const std::size_t i, const BondPartner &partner) const
    {
      return !lists[i].empty() && std::binary_search(lists[i].begin(), lists[i].end(), partner);
    }
    /** Returns whether it was not in the list yet. */
    bool add(const std::size_t i, const BondPartner &partner)
    {
      List &list = lists[i];
      const auto position = std::lower_bound(list.begin(), list.end(), partner);
      if (position != list.end() && *position == partner)
        return false;
      list.insert(position, partner);
      return true;
    }

    /** Adds @p messages to the lists of their particles, on the ranks of these. @p particles are
     * those of this rank by global numbers, ascending; all ends are in @p partition. Collective. */
    void add_at_owners(const NodePartition &partition,
                       const std::vector<dealii::types::global_dof_index> &particles,
                       const std::vector<PartnerMessage> &messages)
    {
      const auto take = [&](const dealii::types::global_dof_index end, const BondPartner &other)
      {
        const auto found = std::lower_bound(particles.begin(), particles.end(), end);
        AssertThrow(found != particles.end() && *found == end, dealii::ExcInternalError());
        add(static_cast<std::size_t>(found - particles.begin()), other);
      };
      std::vector<unsigned int> rank_of_ghost;
      for (const auto &[rank, n] : partition.scalars()->ghost_targets())
        rank_of_ghost.insert(rank_of_ghost.end(), n, rank);
      std::map<unsigned int, std::vector<std::array<std::uint64_t, 3>>> to_ranks;
      for (const PartnerMessage &message : messages)
        if (partition.owned().is_element(message.end))
          take(message.end, message.other);
        else
          to_ranks[rank_of_ghost[partition.local_index(message.end) - partition.n_owned()]]
              .push_back({{message.end, message.other.id, message.other.planes}});
      for (const auto &[rank, received] :
           exchange_by_rank(std::move(to_ranks), partition.communicator()))
        for (const auto &[end, id, planes] : received)
          take(static_cast<dealii::types::global_dof_index>(end), {id, planes});
    }

    /** Writes or reads them as rows of @p archive. Collective. */
    void serialize(StateArchive &archive, const std::string &name)
    {
      // Rows of the file are of one length, that of the longest list.
      unsigned int longest = 0;
      for (const List &list : lists)
        longest = std::max(longest, static_cast<unsigned int>(list.size()));
      longest = dealii::Utilities::MPI::max(longest, archive.communicator());
      archive("most " + name, longest);
      if (archive.is_reading())
        lists.assign(lists.size(), {});
      if (longest == 0)
        return;
      constexpr unsigned int n_numbers = 3;
      constexpr double none = -1.;
      std::vector<double> values;
      for (const List &list : lists)
      {
        for (const BondPartner &partner : list)
          values.insert(values.end(), {upper_half(partner.id), lower_half(partner.id),
                                       static_cast<double>(partner.planes)});
        values.resize(values.size() + std::size_t(n_numbers) * (longest - list.size()), none);
      }
      archive.rows(name, n_numbers * longest, values);
      if (!archive.is_reading())
        return;
      std::size_t next = 0;
      for (List &list : lists)
        for (unsigned int k = 0; k < longest; ++k, next += n_numbers)
          if (values[next] != none)
            list.push_back({joined(values[next], values[next + 1]),
                            static_cast<std::uint64_t>(values[next + 2])});
    }

  private:
    std::vector<List> lists;
  };

  /** How cells that became particles changed a particle since the last search. */
  enum class ParticleGrowth : std::uint8_t
  {
    none,
    gains, ///< mass from cells that came
    is_new
  };

  /** The particle that a neighbour in a row is, whether it has broken bonds, and how it grew. */
  struct BondNeighbour
  {
    BondPartner partner;
    bool is_damaged;
    ParticleGrowth growth;
  };

  /** Which particles, of this rank and others, the neighbours in the rows are, by the indices of
   * Neighbourhoods; whether they have broken bonds, and how they grew. */
  template <int dim>
  class NeighbourPartners
  {
  public:
    /** @p ids, @p broken and @p growth (empty: none grew) are those of this rank's particles. @p
     * partition has all nodes and images of @p neighbourhoods. Collective. */
    void find(const std::shared_ptr<const NodePartition> &partition,
              const Neighbourhoods<dim> &neighbourhoods, const std::vector<std::uint64_t> &ids,
              const PartnerLists &broken, const std::vector<ParticleGrowth> &growth)
    {
      const auto &nodes = neighbourhoods.global_nodes();
      std::vector<unsigned int> own;
      for (std::size_t i = 0; i < ids.size(); ++i)
        own.push_back(partition->local_index(nodes[i]));
      const NodalVector tags =
          nodal_field(partition, Quantity::scalars, own,
                      [&](const std::size_t i, double *const tag)
                      {
                        tag[0] = upper_half(ids[i]);
                        tag[1] = lower_half(ids[i]);
                        tag[2] = broken[i].empty() ? 0. : 1.;
                        tag[3] = growth.empty() ? 0. : static_cast<double>(growth[i]);
                      });
      neighbours.clear();
      const auto add = [&](const dealii::types::global_dof_index node, const unsigned int mirrors)
      {
        const double *const tag = tags.node(partition->local_index(node));
        neighbours.push_back(
            {{joined(tag[0], tag[1]), mirrors}, tag[2] > 0., static_cast<ParticleGrowth>(tag[3])});
      };
      for (const dealii::types::global_dof_index node : nodes)
        add(node, 0);
      for (const ImageNode &image : neighbourhoods.images())
        add(image.source, image.mirrors);
      is_found = true;
    }

    /** Whether find() holds for the present rows. */
    bool are_current() const
    {
      return is_found;
    }
    void forget()
    {
      is_found = false;
    }

    /** By the index of Neighbourhoods. */
    const BondNeighbour &operator[](const unsigned int index) const
    {
      return neighbours[index];
    }

  private:
    std::vector<BondNeighbour> neighbours;
    bool is_found = false;
  };
} // namespace tombolo
