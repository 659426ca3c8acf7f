// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/state/nodal_vector.h>

#include <cmath>
#include <memory>
#include <vector>

namespace tombolo
{
  /** @p arm × @p force, in two dimensions about z. */
  template <int dim>
  dealii::Tensor<1, 3> torque(const dealii::Tensor<1, dim> &arm,
                              const dealii::Tensor<1, dim> &force)
  {
    if constexpr (dim == 2)
      return dealii::Tensor<1, 3>({0., 0., arm[0] * force[1] - arm[1] * force[0]});
    else
      return cross_product_3d(arm, force);
  }

  /** @p tangent, across the unit vector @p before, in the shortest rotation to @p now. */
  template <int dim>
  dealii::Tensor<1, dim> rotated_tangent(const dealii::Tensor<1, dim> &tangent,
                                         const dealii::Tensor<1, dim> &before,
                                         const dealii::Tensor<1, dim> &now)
  {
    const double cosine = before * now;
    if (!(cosine > -0.5)) // no small rotation
      return tangent - (tangent * now) * now;
    return tangent - (now * tangent) / (1. + cosine) * (before + now);
  }

  /** A unit vector across a direction of length one: of the axis furthest from it. */
  template <int dim>
  dealii::Tensor<1, dim> direction_across(const dealii::Tensor<1, dim> &direction)
  {
    unsigned int axis = 0;
    for (unsigned int d = 1; d < dim; ++d)
      if (std::abs(direction[d]) < std::abs(direction[axis]))
        axis = d;
    dealii::Tensor<1, dim> result = -direction[axis] * direction;
    result[axis] += 1.;
    return result / result.norm();
  }

  /** Positions that belong to no node, as ContactSurface::evaluate_gaps() needs them. */
  template <int dim>
  NodalVector positions_as_nodes(const std::vector<dealii::Tensor<1, dim>> &positions)
  {
    const auto n = static_cast<dealii::types::global_dof_index>(positions.size());
    NodalVector result(std::make_shared<const NodePartition>(dealii::complete_index_set(n),
                                                             dealii::IndexSet(n), MPI_COMM_SELF));
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int d = 0; d < dim; ++d)
        result.node(i)[d] = positions[i][d];
    return result;
  }
} // namespace tombolo
