// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/step_limit.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <tuple>

namespace tombolo
{
  void list(Records &records, StepLimit &limit)
  {
    records.value("limit", limit.time_step);
    records.value("limited by", limit.entity);
    records.value("place of limit", limit.place);
  }

  StepLimit smallest_limit(const std::vector<StepLimit> &limits, const MPI_Comm communicator)
  {
    StepLimit smallest;
    for (const StepLimit &limit : limits)
      if (limit.time_step < smallest.time_step)
        smallest = limit;
    if (Utilities::MPI::n_mpi_processes(communicator) == 1)
      return smallest;
    // In the order of ranks, and only what is smaller replaces: the same on all.
    StepLimit result;
    for (const auto &[time_step, entity, place] : Utilities::MPI::all_gather(
             communicator, std::make_tuple(smallest.time_step, smallest.entity, smallest.place)))
      if (time_step < result.time_step)
      {
        result.time_step = time_step;
        result.entity = entity;
        result.place = place;
      }
    return result;
  }
} // namespace tombolo
