// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace tombolo
{
  /** A function of the distance that ends at a radius, as straight lines between equal intervals:
   * what pair terms need of a kernel beyond its gradient, without a call of the kernel per pair. */
  class RadialTable
  {
  public:
    /** Zero everywhere. */
    RadialTable() = default;

    /** Of the values of @p function at distances from 0 to @p radius; zero beyond. */
    RadialTable(const double radius, const std::function<double(double)> &function)
        : intervals_per_length(n_intervals / radius), values(n_intervals + 2, 0.)
    {
      for (std::size_t k = 0; k < n_intervals; ++k)
        values[k] = function(static_cast<double>(k) / intervals_per_length);
    }

    double operator()(const double distance) const
    {
      const double place = std::min(distance * intervals_per_length, double(n_intervals));
      const auto interval = static_cast<std::size_t>(place);
      const double fraction = place - static_cast<double>(interval);
      return values[interval] + fraction * (values[interval + 1] - values[interval]);
    }

    Lanes operator()(const Lanes &distance) const
    {
      alignas(64) double entries[n_lanes];
      store_lanes(distance, entries);
      for (double &entry : entries)
        entry = (*this)(entry);
      return load_lanes(entries);
    }

  private:
    static constexpr std::size_t n_intervals = 2048;

    double intervals_per_length = 0.;
    std::vector<double> values = std::vector<double>(n_intervals + 2, 0.);
  };
} // namespace tombolo
