// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/rank_balance.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <limits>

namespace tombolo
{
  using namespace dealii;

  Json describe_rank_balance(const NodePartition &partition, const double seconds,
                             const double steps)
  {
    const ExchangeCost &cost = partition.exchange_cost();
    const auto over_ranks = [&](const double value)
    { return Utilities::MPI::min_max_avg(value, partition.communicator()); };
    const auto work = over_ranks(seconds - cost.seconds);
    const auto messages = over_ranks(static_cast<double>(cost.n_messages) / steps);
    const auto bytes = over_ranks(static_cast<double>(cost.n_doubles * sizeof(double)) / steps);
    const auto ghosts = over_ranks(partition.n_ghosts());

    Json result = Json::object();
    result["work_max_over_mean"] =
        work.avg > 0. ? work.max / work.avg : std::numeric_limits<double>::quiet_NaN();
    result["exchange_share"] = over_ranks(seconds > 0. ? cost.seconds / seconds : 0.).avg;
    result["exchanges_per_step"] = over_ranks(static_cast<double>(cost.n_exchanges) / steps).max;
    result["messages_per_step_max"] = messages.max;
    result["bytes_per_step_mean"] = bytes.avg;
    result["bytes_per_step_max"] = bytes.max;
    result["ghost_nodes_mean"] = ghosts.avg;
    result["ghost_nodes_max"] = ghosts.max;
    return result;
  }
} // namespace tombolo
