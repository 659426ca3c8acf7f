// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/unroll.h>
#include <tombolo/base/simd/vectorization.h>

namespace tombolo
{
  namespace internal
  {
#if defined(__AVX512F__)
    TOMBOLO_ALWAYS_INLINE void transpose(const NodeRegister (&node)[8],
                                         LaneRegister (&component)[4])
    {
      const auto pair = [&](const unsigned int i)
      { return __builtin_shufflevector(node[i], node[i + 4], 0, 1, 2, 3, 4, 5, 6, 7); };
      const LaneRegister a = pair(0), b = pair(1), c = pair(2), d = pair(3);
      const LaneRegister ab_even = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
      const LaneRegister ab_odd = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
      const LaneRegister cd_even = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
      const LaneRegister cd_odd = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
      component[0] = __builtin_shufflevector(ab_even, cd_even, 0, 1, 8, 9, 4, 5, 12, 13);
      component[1] = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 8, 9, 4, 5, 12, 13);
      component[2] = __builtin_shufflevector(ab_even, cd_even, 2, 3, 10, 11, 6, 7, 14, 15);
      component[3] = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 10, 11, 6, 7, 14, 15);
    }

    TOMBOLO_ALWAYS_INLINE void transpose(const LaneRegister (&component)[3],
                                         NodeRegister (&node)[8])
    {
      const LaneRegister zero = {};
      const LaneRegister xy_even =
          __builtin_shufflevector(component[0], component[1], 0, 8, 2, 10, 4, 12, 6, 14);
      const LaneRegister xy_odd =
          __builtin_shufflevector(component[0], component[1], 1, 9, 3, 11, 5, 13, 7, 15);
      const LaneRegister z_even =
          __builtin_shufflevector(component[2], zero, 0, 8, 2, 10, 4, 12, 6, 14);
      const LaneRegister z_odd =
          __builtin_shufflevector(component[2], zero, 1, 9, 3, 11, 5, 13, 7, 15);
      const LaneRegister pairs[4] = {
          __builtin_shufflevector(xy_even, z_even, 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(xy_odd, z_odd, 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(xy_even, z_even, 2, 3, 10, 11, 6, 7, 14, 15),
          __builtin_shufflevector(xy_odd, z_odd, 2, 3, 10, 11, 6, 7, 14, 15)};
      TOMBOLO_UNROLL
      for (unsigned int i = 0; i < 4; ++i)
      {
        node[i] = __builtin_shufflevector(pairs[i], pairs[i], 0, 1, 2, 3);
        node[i + 4] = __builtin_shufflevector(pairs[i], pairs[i], 4, 5, 6, 7);
      }
    }
#elif defined(__AVX__)
    TOMBOLO_ALWAYS_INLINE void transpose(const NodeRegister (&node)[4],
                                         LaneRegister (&component)[4])
    {
      const LaneRegister ab_even = __builtin_shufflevector(node[0], node[1], 0, 4, 2, 6);
      const LaneRegister ab_odd = __builtin_shufflevector(node[0], node[1], 1, 5, 3, 7);
      const LaneRegister cd_even = __builtin_shufflevector(node[2], node[3], 0, 4, 2, 6);
      const LaneRegister cd_odd = __builtin_shufflevector(node[2], node[3], 1, 5, 3, 7);
      component[0] = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
      component[1] = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
      component[2] = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
      component[3] = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
    }

    TOMBOLO_ALWAYS_INLINE void transpose(const LaneRegister (&component)[3],
                                         NodeRegister (&node)[4])
    {
      const LaneRegister zero = {};
      const LaneRegister xy_even = __builtin_shufflevector(component[0], component[1], 0, 4, 2, 6);
      const LaneRegister xy_odd = __builtin_shufflevector(component[0], component[1], 1, 5, 3, 7);
      const LaneRegister z_even = __builtin_shufflevector(component[2], zero, 0, 4, 2, 6);
      const LaneRegister z_odd = __builtin_shufflevector(component[2], zero, 1, 5, 3, 7);
      node[0] = __builtin_shufflevector(xy_even, z_even, 0, 1, 4, 5);
      node[1] = __builtin_shufflevector(xy_odd, z_odd, 0, 1, 4, 5);
      node[2] = __builtin_shufflevector(xy_even, z_even, 2, 3, 6, 7);
      node[3] = __builtin_shufflevector(xy_odd, z_odd, 2, 3, 6, 7);
    }
#else
    inline void transpose(const NodeRegister (&node)[n_lanes], LaneRegister (&component)[4])
    {
      for (unsigned int d = 0; d < 4; ++d)
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          component[d][lane] = node[lane][d];
    }

    inline void transpose(const LaneRegister (&component)[3], NodeRegister (&node)[n_lanes])
    {
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        node[lane] = NodeRegister{component[0][lane], component[1][lane], component[2][lane], 0.};
    }
#endif
  } // namespace internal

  /** The lanes i, j, k, l of a node, in this order. */
  template <int i, int j, int k, int l>
  TOMBOLO_ALWAYS_INLINE NodeLanes permute(const NodeLanes &value)
  {
    const auto in_register = internal::bit_cast<internal::NodeRegister>(value);
    return internal::bit_cast<NodeLanes>(
        internal::NodeRegister(__builtin_shufflevector(in_register, in_register, i, j, k, l)));
  }

  /** @p value in all lanes of a register. The compiler cannot infer that the lanes are equal:
   * otherwise it subtracts numbers and broadcasts the difference, which takes a shuffle each time.
   */
  TOMBOLO_ALWAYS_INLINE NodeLanes broadcast_in_register(const double value)
  {
#if defined(__AVX__)
    internal::NodeRegister result = {value, value, value, value};
    asm("" : "+x"(result));
    return internal::bit_cast<NodeLanes>(result);
#else
    return value;
#endif
  }

  /** Components 0 ... dim-1 of n_lanes nodes. */
  template <int dim>
  TOMBOLO_ALWAYS_INLINE void nodes_to_lanes(const NodeLanes (&nodes)[n_lanes],
                                            Lanes (&components)[dim])
  {
    internal::NodeRegister in_registers[n_lanes];
    TOMBOLO_UNROLL
    for (unsigned int lane = 0; lane < n_lanes; ++lane)
      in_registers[lane] = internal::bit_cast<internal::NodeRegister>(nodes[lane]);
    internal::LaneRegister transposed[4];
    internal::transpose(in_registers, transposed);
    TOMBOLO_UNROLL
    for (unsigned int d = 0; d < dim; ++d)
      components[d] = internal::bit_cast<Lanes>(transposed[d]);
  }

  /** n_lanes nodes of these components; the other components are zero. */
  template <int dim>
  TOMBOLO_ALWAYS_INLINE void lanes_to_nodes(const Lanes (&components)[dim],
                                            NodeLanes (&nodes)[n_lanes])
  {
    internal::LaneRegister in_registers[3] = {};
    TOMBOLO_UNROLL
    for (unsigned int d = 0; d < dim; ++d)
      in_registers[d] = internal::bit_cast<internal::LaneRegister>(components[d]);
    internal::NodeRegister transposed[n_lanes];
    internal::transpose(in_registers, transposed);
    TOMBOLO_UNROLL
    for (unsigned int lane = 0; lane < n_lanes; ++lane)
      nodes[lane] = internal::bit_cast<NodeLanes>(transposed[lane]);
  }

  /** Components 0 ... dim-1 of the nodes with these n_lanes indices of a nodal vector. */
  template <int dim>
  TOMBOLO_ALWAYS_INLINE void gather_nodes(const double *data, const unsigned int *indices,
                                          Lanes (&components)[dim])
  {
    NodeLanes nodes[n_lanes];
    TOMBOLO_UNROLL
    for (unsigned int lane = 0; lane < n_lanes; ++lane)
      nodes[lane] = load_node(data + NodeLanes::size() * indices[lane]);
    nodes_to_lanes(nodes, components);
  }

  /** Adds to the first @p n_valid of n_lanes nodes, one after the other: indices may repeat. */
  template <int dim>
  TOMBOLO_ALWAYS_INLINE void add_to_nodes(const Lanes (&components)[dim],
                                          const unsigned int *indices, const unsigned int n_valid,
                                          double *data)
  {
    NodeLanes nodes[n_lanes];
    lanes_to_nodes(components, nodes);
    const auto add = [&](const unsigned int lane)
    {
      double *const target = data + NodeLanes::size() * indices[lane];
      store_node(load_node(target) + nodes[lane], target);
    };
    if (n_valid == n_lanes)
    {
      TOMBOLO_UNROLL
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        add(lane);
      return;
    }
    for (unsigned int lane = 0; lane < n_valid; ++lane)
      add(lane);
  }

  /** a × b of the first three components; the last one is zero where it is in a or b. */
  TOMBOLO_ALWAYS_INLINE NodeLanes cross_product(const NodeLanes &a, const NodeLanes &b)
  {
    const NodeLanes a_next = permute<1, 2, 0, 3>(a);
    const NodeLanes b_next = permute<1, 2, 0, 3>(b);
    const NodeLanes c = a * b_next - a_next * b;
    return permute<1, 2, 0, 3>(c);
  }
} // namespace tombolo
