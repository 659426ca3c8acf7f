// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>

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
    std::size_t add(unsigned int n, const double *value, const double *gradient);

    /** How many values are kept. */
    std::size_t size() const
    {
      return kept_values.size();
    }

    /** Makes what is kept the values and gradients of @p shape. */
    void store(Stencils &shape) const;

  private:
    struct Kept
    {
      std::size_t start;
      unsigned int n;
    };

    bool is_same(const Kept &kept, unsigned int n, const double *value,
                 const double *gradient) const;

    std::vector<double> kept_values, kept_gradients;
    std::unordered_multimap<std::uint64_t, Kept> kept_rows; // by hash of the rounded values
  };
} // namespace tombolo
