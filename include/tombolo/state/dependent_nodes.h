// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/nodal_vector.h>

#include <deal.II/lac/affine_constraints.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /** Some @p owned nodes of a @p partition and those to which NodalVector::condense() moves what
   * they have, without ghosts, ascending. Collective. */
  std::vector<unsigned int>
  with_nodes_depended_on(const std::shared_ptr<const NodePartition> &partition,
                         std::vector<unsigned int> owned);

  /** The rows of all dependent nodes of all ranks, closed: none refers to a dependent node. Nodes
   * of which @p is_zero (scalar) is positive, ghosts included, are left out of the means. All ranks
   * have the same. Collective. */
  dealii::AffineConstraints<double> constraints_of_dependent_nodes(const NodalVector &is_zero);
} // namespace tombolo
