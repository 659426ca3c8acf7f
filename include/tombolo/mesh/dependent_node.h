// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/types.h>

#include <utility>
#include <vector>

namespace tombolo
{
  /** A node that is no unknown: in any field it has the mean of others, with these weights, which
   * sum to one. */
  struct DependentNode
  {
    dealii::types::global_dof_index node;
    std::vector<std::pair<dealii::types::global_dof_index, double>> weights;
  };
} // namespace tombolo
