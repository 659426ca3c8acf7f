// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/formulation.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <vector>

namespace tombolo
{
  /** Lists what is kept of a limit. */
  inline void list(Records &records, StepLimit &limit)
  {
    records.value("limit", limit.time_step);
    records.value("limited by", limit.entity);
    records.value("place of limit", limit.position);
  }

  /** The smallest of these over all ranks, the same on all; of equal ones that of the lowest rank.
   * Collective. */
  inline StepLimit smallest_limit(const std::vector<StepLimit> &limits, const MPI_Comm communicator)
  {
    StepLimit smallest;
    for (const StepLimit &limit : limits)
      if (limit.time_step < smallest.time_step)
        smallest = limit;
    const auto least = Utilities::MPI::min_max_avg(smallest.time_step, communicator);
    smallest.time_step = least.min;
    smallest.entity = Utilities::MPI::broadcast(communicator, smallest.entity, least.min_index);
    Utilities::MPI::broadcast(smallest.position.begin_raw(), 3, least.min_index, communicator);
    return smallest;
  }
} // namespace tombolo
