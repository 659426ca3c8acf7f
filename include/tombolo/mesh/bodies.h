// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/nodes.h>

#include <deal.II/base/types.h>
#include <deal.II/lac/la_parallel_vector.h>

namespace tombolo
{
  /**
   * The bodies of a mesh: sets of cells that common nodes join, whatever their parts are. Known for
   * the relevant nodes of this rank.
   */
  template <int dim>
  class Bodies
  {
  public:
    /** Collective. */
    explicit Bodies(const Nodes<dim> &nodes);

    /** Over all ranks. */
    unsigned int n_bodies() const
    {
      return count;
    }

    /** A number of the body of a relevant node, by global number: the smallest number of its nodes.
     */
    dealii::types::global_dof_index body_of(const dealii::types::global_dof_index node) const
    {
      return static_cast<dealii::types::global_dof_index>(smallest[node]);
    }

  private:
    dealii::LinearAlgebra::distributed::Vector<double> smallest; // node of the body
    unsigned int count;
  };
} // namespace tombolo
