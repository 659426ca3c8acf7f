// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/failure/bond_failure.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/records.h>

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /** When bonds are checked, and which of them the chosen BondFailure breaks. */
  template <int dim>
  class BondCheck
  {
  public:
    explicit BondCheck(const Entries &e);

    const std::string &criterion_name() const
    {
      return name;
    }
    bool needs_deformation() const
    {
      return criterion->needs_deformation();
    }

    /** Whether also particles without broken bonds are isolated where they are distorted. */
    bool isolates_all() const
    {
      return isolates_without_broken;
    }

    /** Begins to count steps. Throws InputError where @p points cannot be judged. */
    void start(const MaterialPoints &points);

    /** Counts a step; whether its bonds are checked. */
    bool is_due();

    /** Computes the measure of each particle; whether any on any rank reaches the threshold, so
     * that find_breaking() is due. @p deformation as in BondFailure. Collective. */
    bool measure(const MaterialPoints &points, const std::vector<dealii::Tensor<2, 3>> &deformation,
                 MPI_Comm communicator);

    /** Shows the measures to other ranks, and where the particles began. Collective. */
    void exchange(const std::shared_ptr<const NodePartition> &partition,
                  const std::vector<dealii::Point<dim>> &initial_positions, const Stencils &shape);

    /** Entries of row @p i (from its first one) whose bonds break at @p position, with current
     * ghosts on the partition of exchange(). */
    const std::vector<unsigned int> &find_breaking(unsigned int i, const NodalVector &position,
                                                   const Stencils &shape);

    void list(Records &records)
    {
      records.value("steps since bond check", steps_since_check);
    }

  private:
    std::string name;
    std::unique_ptr<BondFailure> criterion;
    unsigned int interval;
    bool isolates_without_broken;
    unsigned int steps_since_check = 0;
    std::vector<double> measures;
    NodalVector pair_data; // initial position, and the measure in the pad

    // Of the pairs of a row.
    std::vector<unsigned int> entries, breaking;
    std::vector<double> mean, stretch;
    std::vector<std::uint8_t> verdict;
  };
} // namespace tombolo
