// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/types.h>

#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/state/node_partition.h>

#include <cstdint>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace tombolo
{
  class StateArchive;

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
    bool has(std::size_t i, const BondPartner &partner) const;
    /** Returns whether it was not in the list yet. */
    bool add(std::size_t i, const BondPartner &partner);

    /** Adds each of @p messages to the list of its particle, on the rank of this particle. @p
     * particles are the global numbers of this rank's particles, ascending; all ends are nodes of
     * @p partition. Collective. */
    void add_at_owners(const NodePartition &partition,
                       const std::vector<dealii::types::global_dof_index> &particles,
                       const std::vector<PartnerMessage> &messages);

    /** Writes or reads them as rows of @p archive. Collective. */
    void serialize(StateArchive &archive, const std::string &name);

  private:
    std::vector<List> lists;
  };

  /** What cells that became particles did to a particle since the last search. */
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

  /** Which particles, of this rank and others, the neighbours in the rows are, by the places of
   * Neighbourhoods; whether they have broken bonds, and how they grew. */
  template <int dim>
  class NeighbourPartners
  {
  public:
    /** @p ids, @p broken and @p growth (empty: none grew) are those of this rank's particles. @p
     * partition has all nodes and images of @p neighbourhoods. Collective. */
    void find(const std::shared_ptr<const NodePartition> &partition,
              const Neighbourhoods<dim> &neighbourhoods, const std::vector<std::uint64_t> &ids,
              const PartnerLists &broken, const std::vector<ParticleGrowth> &growth);

    /** Whether find() holds for the present rows. */
    bool are_current() const
    {
      return is_found;
    }
    void forget()
    {
      is_found = false;
    }

    /** At a place. */
    const BondNeighbour &operator[](const unsigned int place) const
    {
      return neighbours[place];
    }

  private:
    std::vector<BondNeighbour> neighbours;
    bool is_found = false;
  };
} // namespace tombolo
