// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/formulation.h>

#include <vector>

namespace tombolo
{
  /** Lists what is kept of a limit. */
  void list(Records &records, StepLimit &limit);

  /** The smallest of these over all ranks, the same on all; of equal ones that of the lowest rank.
   * Collective. */
  StepLimit smallest_limit(const std::vector<StepLimit> &limits, MPI_Comm communicator);
} // namespace tombolo
