// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/json.h>
#include <tombolo/state/node_partition.h>

namespace tombolo
{
  /**
   * How the ranks have shared @p steps steps, for the summary. The exchanges of nodal values are
   * those counted by @p partition, and @p seconds the wall time of the same steps on this rank.
   *
   * `work_max_over_mean` is the imbalance: the largest over the mean of the time outside exchanges;
   * `exchange_share` the mean share of the time in them, waiting for slower ranks included;
   * `exchanges_per_step` their number; `messages_per_step_max`, `bytes_per_step_mean` and
   * `bytes_per_step_max` what a rank sends; `ghost_nodes_mean` and `ghost_nodes_max` the nodes of
   * others that it sees. The same on all ranks. Collective.
   */
  Json describe_rank_balance(const NodePartition &partition, double seconds, double steps);
} // namespace tombolo
