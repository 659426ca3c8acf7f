// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/node_lanes.h>

namespace tombolo
{
  /** a × b of the first three components; the last one is zero where it is in a or b. */
  TOMBOLO_ALWAYS_INLINE NodeLanes cross_product(const NodeLanes &a, const NodeLanes &b)
  {
    const NodeLanes a_next = permute<1, 2, 0, 3>(a);
    const NodeLanes b_next = permute<1, 2, 0, 3>(b);
    const NodeLanes c = a * b_next - a_next * b;
    return permute<1, 2, 0, 3>(c);
  }
} // namespace tombolo
