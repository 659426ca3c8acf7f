// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace tombolo
{
  /**
   * Rows of φ and ∇φ that differ by round-off only, kept once. On a lattice all rows inside are the
   * same, along an extruded body those of one line along its axis; their sweeps then read a table
   * of some kilobytes instead of a kilobyte a particle. The neighbours of a row must be in an order
   * that does not depend on their numbers (see Neighbourhoods::order_by_offset).
   */
  class RowSharing
  {
  public:
    /** Values may differ by this, gradients by this times the largest of the row. */
    static constexpr double tolerance = 1e-12;

    /** Where a row of @p n neighbours with these values (n) and gradients (three each) is in
     * the kept values, and, times three, in the kept gradients: the first such row that was added.
     */
    std::size_t add(const unsigned int n, const double *value, const double *gradient)
    {
      const std::uint64_t hash = hash_of(n, value, gradient);
      const auto range = kept_rows.equal_range(hash);
      for (auto row = range.first; row != range.second; ++row)
        if (is_same(row->second, n, value, gradient))
          return row->second.start;
      const std::size_t start = kept_values.size();
      kept_values.insert(kept_values.end(), value, value + n);
      kept_gradients.insert(kept_gradients.end(), gradient, gradient + std::size_t(n_gradient) * n);
      kept_rows.insert({hash, {start, n}});
      return start;
    }

    std::size_t size() const
    {
      return kept_values.size();
    }

    /** Makes what is kept the values and gradients of @p shape. */
    void store(Stencils &shape) const
    {
      shape.value.resize_fast(kept_values.size());
      std::copy(kept_values.begin(), kept_values.end(), shape.value.begin());
      shape.gradient.resize_fast(kept_gradients.size() + 1);
      std::copy(kept_gradients.begin(), kept_gradients.end(), shape.gradient.begin());
      shape.gradient.back() = 0.;
    }

  private:
    static constexpr unsigned int n_gradient = Stencils::n_gradient;

    static double largest_of(const unsigned int n, const double *gradient)
    {
      double largest = 0.;
      for (unsigned int k = 0; k < n_gradient * n; ++k)
        largest = std::max(largest, std::abs(gradient[k]));
      return largest;
    }

    static std::uint64_t hash_of(const unsigned int n, const double *value, const double *gradient)
    {
      // Far coarser than what rows differ by: a value that happens to be rounded both ways keeps
      // its row twice, which does no harm.
      constexpr double resolution = 1 << 26;
      std::uint64_t hash = n;
      const auto add = [&](const double number)
      {
        hash = (hash ^ static_cast<std::uint64_t>(std::llrint(number * resolution))) *
               0x9e3779b97f4a7c15u;
      };
      std::for_each(value, value + n, add);
      if (const double largest = largest_of(n, gradient); largest > 0.)
        std::for_each(gradient, gradient + std::size_t(n_gradient) * n,
                      [&](const double component) { add(component / largest); });
      return hash ^ (hash >> 32);
    }

    struct Kept
    {
      std::size_t start;
      unsigned int n;
    };

    bool is_same(const Kept &kept, const unsigned int n, const double *value,
                 const double *gradient) const
    {
      if (kept.n != n)
        return false;
      const double *const kept_value = kept_values.data() + kept.start;
      const double *const kept_gradient = kept_gradients.data() + n_gradient * kept.start;
      double difference = 0;
      for (unsigned int k = 0; k < n; ++k)
        difference = std::max(difference, std::abs(kept_value[k] - value[k]));
      double gradient_difference = 0;
      for (unsigned int k = 0; k < n_gradient * n; ++k)
        gradient_difference =
            std::max(gradient_difference, std::abs(kept_gradient[k] - gradient[k]));
      return difference <= tolerance &&
             gradient_difference <= tolerance * largest_of(n, kept_gradient);
    }

    std::vector<double> kept_values, kept_gradients;
    std::unordered_multimap<std::uint64_t, Kept> kept_rows; // by hash of rounded entries
  };
} // namespace tombolo
