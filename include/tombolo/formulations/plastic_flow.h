// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/state/material_points.h>

#include <algorithm>

namespace tombolo
{
  /** Which points flow plastically in a step: those whose "effective plastic strain" grows. */
  class PlasticFlow
  {
  public:
    /** Finds the field in @p points. */
    void set(const MaterialPoints &points)
    {
      field = points.find_field("effective plastic strain");
      can_flow = field < points.fields().size();
    }

    bool is_possible() const
    {
      return can_flow;
    }

    /** Keeps the strain of @p n points from @p first on, before the stress is advanced. */
    void keep(const MaterialPoints &points, const std::size_t first, const unsigned int n,
              double *before) const
    {
      std::copy_n(points.component(field, 0) + first, n, before);
    }

    /** The von Mises stress of n_lanes points from @p i on, zero where they do not flow. */
    Lanes stress(const MaterialPoints &points, const std::size_t i, const double *before) const
    {
      Lanes s[6];
      for (unsigned int c = 0; c < 6; ++c)
        s[c] = load_lanes(points.component(MaterialPoints::stress, c) + i);
      const Lanes mean = (s[0] + s[1] + s[2]) * (1. / 3.);
      Lanes squared = 0.;
      for (unsigned int c = 0; c < 3; ++c)
        squared += 1.5 * (s[c] - mean) * (s[c] - mean) + 3. * s[3 + c] * s[3 + c];
      Lanes result = square_root(squared);
      where(!(load_lanes(points.component(field, 0) + i) > load_lanes(before)), result) = 0.;
      return result;
    }

  private:
    unsigned int field = 0;
    bool can_flow = false;
  };
} // namespace tombolo
