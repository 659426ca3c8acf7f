// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <experimental/simd>

namespace tombolo
{
  /** As many doubles as one register of the machine holds, with elementwise arithmetic. Wider ones
   * (std::simd of a fixed size) are passed through memory, at five times the cost. deal.II's
   * VectorizedArray cannot serve: Debian builds it with a width of one. */
  using Lanes = std::experimental::native_simd<double>;

  /** The number of points or cells that one vector instruction treats together: 8 with AVX-512, 4
   * with AVX, 2 in portable code. */
  constexpr unsigned int n_lanes = Lanes::size();

  /** Four doubles: the padded vector of one node. */
  using NodeLanes = std::experimental::fixed_size_simd<double, 4>;

  /** n rounded up to whole Lanes. */
  constexpr unsigned int padded_to_lanes(const unsigned int n)
  {
    return (n + n_lanes - 1) / n_lanes * n_lanes;
  }

  inline Lanes load_lanes(const double *data)
  {
    return Lanes(data, std::experimental::element_aligned);
  }

  inline void store_lanes(const Lanes &value, double *data)
  {
    value.copy_to(data, std::experimental::element_aligned);
  }

  inline NodeLanes load_node(const double *data)
  {
    return NodeLanes(data, std::experimental::element_aligned);
  }

  inline void store_node(const NodeLanes &value, double *data)
  {
    value.copy_to(data, std::experimental::element_aligned);
  }
} // namespace tombolo
