// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/formulations/failure/partner_lists.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace tombolo
{
  /** What cells that became particles did to a particle since the last search. */
  enum class ParticleGrowth : std::uint8_t
  {
    none,
    gains, ///< mass from cells that came
    is_new
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
    bool are_current() const;
    void forget();

    const BondPartner &partner(unsigned int place) const;
    bool is_damaged(unsigned int place) const;
    ParticleGrowth growth(unsigned int place) const;

  private:
    std::vector<BondPartner> partners;
    std::vector<bool> damaged;
    std::vector<ParticleGrowth> growths;
    bool is_found = false;
  };
} // namespace tombolo
