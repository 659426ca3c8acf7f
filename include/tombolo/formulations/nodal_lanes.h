#pragma once

#include <tombolo/base/register_transpose.h>
#include <tombolo/base/unroll.h>
#include <tombolo/base/vectorization.h>
#include <tombolo/state/node_partition.h>

#include <cstddef>

namespace tombolo
{
  static_assert(n_slots == 4, "A node is one NodeVector.");

  /** Components 0 ... dim-1 of n_lanes nodes of a nodal vector with n_slots doubles a node. */
  template <int dim>
  TOMBOLO_ALWAYS_INLINE void gather_nodes(const double *data, const unsigned int *nodes,
                                          Lanes (&values)[dim])
  {
    internal::NodeVector node[n_lanes];
    TOMBOLO_UNROLL
    for (unsigned int i = 0; i < n_lanes; ++i)
      node[i] = internal::load_node_vector(data + std::size_t(n_slots) * nodes[i]);
    internal::LaneVector component[3];
    internal::nodes_to_lanes(node, component);
    TOMBOLO_UNROLL
    for (unsigned int d = 0; d < dim; ++d)
      values[d] = internal::to_lanes(component[d]);
  }

  /** Adds to the first @p n_valid of n_lanes nodes, one after the other: nodes may repeat. */
  template <int dim>
  TOMBOLO_ALWAYS_INLINE void add_to_nodes(const Lanes (&values)[dim], const unsigned int *nodes,
                                          const unsigned int n_valid, double *data)
  {
    internal::LaneVector component[3] = {};
    TOMBOLO_UNROLL
    for (unsigned int d = 0; d < dim; ++d)
      component[d] = internal::from_lanes(values[d]);
    internal::NodeVector node[n_lanes];
    internal::lanes_to_nodes(component, node);
    if (n_valid == n_lanes)
    {
      TOMBOLO_UNROLL
      for (unsigned int i = 0; i < n_lanes; ++i)
        internal::add_node_vector(data + std::size_t(n_slots) * nodes[i], node[i]);
      return;
    }
    for (unsigned int i = 0; i < n_valid; ++i)
      internal::add_node_vector(data + std::size_t(n_slots) * nodes[i], node[i]);
  }
} // namespace tombolo
