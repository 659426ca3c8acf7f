// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <complex>
#include <vector>

namespace tombolo
{
  /** What the two unknowns of one column do to those of another, row by row. */
  using ChainBlock = std::array<std::complex<double>, 4>;

  /** The two half spaces beside column 0. */
  enum class ChainSide
  {
    left,
    right
  };

  /**
   * A linear operator on an endless chain of columns with two complex unknowns each: what Bloch's
   * theorem makes of a two-dimensional lattice with an interface at column 0. Blocks are given for
   * the source columns first() ... last(); those before are as the first, shifted, and those after
   * as the last. A source column acts on columns at most reach() away.
   */
  class BlochOperator
  {
  public:
    /** All blocks zero. @p first ≤ @p last. */
    BlochOperator(int reach, int first, int last);

    int reach() const;
    int first() const;
    int last() const;

    /** The block by which column @p source acts on column @p target; zero beyond the reach. */
    ChainBlock block(int target, int source) const;

    /** For setting it: @p source from first() to last(), @p target within the reach. */
    ChainBlock &given_block(int target, int source);

    /** Takes away the outer columns of the reach where all blocks are below @p tolerance times the
     * largest entry, and sets real and imaginary parts below it to zero. */
    void drop_round_off(double tolerance);

    /** this after @p other. */
    BlochOperator operator*(const BlochOperator &other) const;

    /** The operator of an endless chain that is everywhere as this one far to a side. */
    BlochOperator homogeneous(ChainSide side) const;

    /** The 2 x 2 matrix of its action on p exp(i @p phase j) (j: number of the column) far to a
     * side. */
    ChainBlock symbol(ChainSide side, double phase) const;

    /** Largest absolute value of an entry. */
    double largest_entry() const;

  private:
    int operator_reach, first_source, last_source;
    std::vector<ChainBlock> blocks; // [source][target - source + reach]
  };
} // namespace tombolo
