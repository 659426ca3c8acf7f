// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/node_partition.h>

#include <deal.II/lac/la_parallel_vector.h>

#include <algorithm>
#include <memory>

namespace tombolo
{
  /** The largest of the values that cells of all ranks give to each node. First raise(), then
   * share(), then the rest. */
  class NodeMaxima
  {
  public:
    /** Nodes that get no value have @p nothing. */
    explicit NodeMaxima(const std::shared_ptr<const NodePartition> &partition,
                        const double nothing = -1e300)
        : of_nodes(std::make_unique<Vector>(partition->scalars()))
    {
      for (unsigned int i = 0; i < partition->n_owned() + partition->n_ghosts(); ++i)
        of_nodes->local_element(i) = nothing;
    }

    void raise(const unsigned int node, const double value)
    {
      double &of_node = of_nodes->local_element(node);
      of_node = std::max(of_node, value);
    }

    /** Collective. */
    void share()
    {
      of_nodes->compress(dealii::VectorOperation::max);
      of_nodes->update_ghost_values();
    }

    /** Of an owned or ghost node. */
    double operator[](const unsigned int node) const
    {
      return of_nodes->local_element(node);
    }

    template <typename Nodes>
    double largest_of(const Nodes &nodes) const
    {
      double result = (*this)[nodes[0]];
      for (const unsigned int node : nodes)
        result = std::max(result, (*this)[node]);
      return result;
    }

  private:
    using Vector = dealii::LinearAlgebra::distributed::Vector<double>;
    std::unique_ptr<Vector> of_nodes; // a Vector that is copied or moved loses its ghosts
  };
} // namespace tombolo
