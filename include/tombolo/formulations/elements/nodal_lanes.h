// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/register_transpose.h>
#include <tombolo/base/simd/unroll.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/state/node_partition.h>

#include <cstddef>

namespace tombolo
{
  static_assert(node_stride == 4, "A node is one NodeVector.");

  /** Components 0 ... dim-1 of n_lanes nodes of a nodal vector with node_stride doubles a node. */
  template <int dim>
  TOMBOLO_ALWAYS_INLINE void gather_nodes(const double *data, const unsigned int *nodes,
                                          Lanes (&values)[dim])
  {
    internal::NodeVector node[n_lanes];
    TOMBOLO_UNROLL
    for (unsigned int i = 0; i < n_lanes; ++i)
      node[i] = internal::load_node_vector(data + std::size_t(node_stride) * nodes[i]);
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
        internal::add_node_vector(data + std::size_t(node_stride) * nodes[i], node[i]);
      return;
    }
    for (unsigned int i = 0; i < n_valid; ++i)
      internal::add_node_vector(data + std::size_t(node_stride) * nodes[i], node[i]);
  }
} // namespace tombolo
