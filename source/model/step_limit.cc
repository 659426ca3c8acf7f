// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/step_limit.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

namespace tombolo
{
  void list(Records &records, StepLimit &limit)
  {
    records.value("limit", limit.time_step);
    records.value("limited by", limit.entity);
    records.value("place of limit", limit.position);
  }

  StepLimit smallest_limit(const std::vector<StepLimit> &limits, const MPI_Comm communicator)
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
