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
    struct
    {
      double time_step;
      int rank;
    } own = {smallest.time_step, static_cast<int>(Utilities::MPI::this_mpi_process(communicator))},
      least;
    MPI_Allreduce(&own, &least, 1, MPI_DOUBLE_INT, MPI_MINLOC, communicator);
    smallest.time_step = least.time_step;
    auto length = static_cast<int>(smallest.entity.size());
    MPI_Bcast(&length, 1, MPI_INT, least.rank, communicator);
    smallest.entity.resize(static_cast<std::size_t>(length));
    MPI_Bcast(smallest.entity.data(), length, MPI_CHAR, least.rank, communicator);
    MPI_Bcast(smallest.position.begin_raw(), 3, MPI_DOUBLE, least.rank, communicator);
    return smallest;
  }
} // namespace tombolo
