// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/index_set.h>
#include <deal.II/base/tensor.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /** Positions that belong to no node, as ContactSurface::evaluate_gaps() takes them. */
  template <int dim>
  NodalVector places_as_nodes(const std::vector<dealii::Tensor<1, dim>> &places)
  {
    const auto n = static_cast<dealii::types::global_dof_index>(places.size());
    NodalVector result(std::make_shared<const NodePartition>(dealii::complete_index_set(n),
                                                             dealii::IndexSet(n), MPI_COMM_SELF));
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int d = 0; d < dim; ++d)
        result.node(i)[d] = places[i][d];
    return result;
  }
} // namespace tombolo
