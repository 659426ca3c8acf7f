// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>

#include <cstddef>
#include <vector>

namespace tombolo
{
  /** Particles that have lost what carried them, and their rows of φ before. */
  struct LeavingParticles
  {
    std::vector<unsigned int> row;       ///< of the shape functions, ascending
    std::vector<std::size_t> row_start;  ///< of each and of what is behind the last one
    std::vector<unsigned int> neighbour; ///< local nodes of the partition in force before
    std::vector<double> value;           ///< φ

    /** Adds one behind the others. */
    void add(unsigned int row, const Stencils::Row &former);
  };

  /** The shape functions of one part as they were before they changed. */
  class FormerRows
  {
  public:
    /** Copies φ of all rows, unless it has a copy already. */
    void remember(const Stencils &shape);

    /** Which of the ascending @p candidates, rows of @p shape, were not rigid or had more
     * neighbours with φ ≠ 0 before. Forgets the copy; without one, none. */
    LeavingParticles leaving(const Stencils &shape, const std::vector<unsigned int> &candidates);

  private:
    /** As it was, without ∇φ. */
    Stencils::Row former_row(unsigned int i) const;

    bool is_kept = false;
    std::vector<std::size_t> row_start, coefficient_start;
    std::vector<unsigned int> neighbour, rank_deficient_rows;
    dealii::AlignedVector<double> value;
  };
} // namespace tombolo
