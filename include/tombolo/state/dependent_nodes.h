// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/nodal_vector.h>

#include <deal.II/lac/affine_constraints.h>

#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  /** Some @p owned nodes of a @p partition and those to which NodalVector::condense() moves what
   * they have, without ghosts, ascending. Collective. */
  std::vector<unsigned int>
  with_nodes_depended_on(const std::shared_ptr<const NodePartition> &partition,
                         std::vector<unsigned int> owned);

  /** The rows of all dependent nodes of all ranks, for matrices: K of all nodes becomes TᵀKT of the
   * independent ones. All ranks have the same. */
  class DependentRows
  {
  public:
    using Nodes = std::vector<dealii::types::global_dof_index>;
    using Weights = std::vector<std::pair<dealii::types::global_dof_index, double>>;

    DependentRows() = default;

    /** Nodes of which @p is_zero (scalar) is positive, ghosts included, are left out of the means.
     * Collective. */
    explicit DependentRows(const NodalVector &is_zero);

    bool is_empty() const
    {
      return rows.n_constraints() == 0;
    }

    bool depends(const dealii::types::global_dof_index node) const
    {
      return rows.is_constrained(node);
    }

    /** A node as a sum of independent ones: itself where it does not depend on others. */
    Weights weights(dealii::types::global_dof_index node) const;

    /** @p nodes where none of them depends on others; else the independent ones, ascending. */
    Nodes independent(const Nodes &nodes) const;

    /** A matrix by rows, with @p n_components rows and columns for each of @p nodes, as that of
     * @p independent_nodes, which are independent() of them. */
    std::vector<double> condensed(const Nodes &nodes, const Nodes &independent_nodes,
                                  const std::vector<double> &entries,
                                  unsigned int n_components) const;

    /** Moves the columns of a row to where they act. */
    void condense_columns(Nodes &columns, std::vector<double> &values) const;

  private:
    dealii::AffineConstraints<double> rows;
  };
} // namespace tombolo
