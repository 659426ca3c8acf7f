// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/materials/flow_stress.h>

#include <cmath>

namespace tombolo
{
  /**
   * The factor 1 + (ε̇_p / C)^(1/P) of a flow stress at the plastic strain rate ε̇_p (Cowper and
   * Symonds 1957). Below a millionth of C the power is replaced by its chord, since its slope has
   * no bound there.
   */
  class CowperSymonds
  {
  public:
    CowperSymonds() = default;

    explicit CowperSymonds(const Entries &e)
        : reference_rate(e.number("Cowper-Symonds rate", "0", zero_or_positive(), "1/T",
                                  "C of a factor $1 + (\\dot\\varepsilon_p/C)^{1/P}$; 0: none.")),
          exponent(1. /
                   e.number("Cowper-Symonds exponent", "5", between(1., 1000.), "1", "P of it."))
    {}

    bool is_on() const
    {
      return reference_rate > 0.;
    }

    /** Multiplies the flow stress in @p batch, with its slope. */
    void apply(const FlowStressBatch &batch) const
    {
      if (!is_on())
        return;
      constexpr double smallest = 1e-6;
      const double chord_slope = std::pow(smallest, exponent) / smallest;
      const double rate_of_increment = batch.inverse_time_increment / reference_rate;
      for (unsigned int i = 0; i < batch.n; ++i)
      {
        const double rate = rate_of_increment * batch.increment[i];
        const double power = rate > smallest ? std::pow(rate, exponent) : chord_slope * rate;
        const double slope = rate > smallest ? exponent * power / rate : chord_slope;
        batch.slope[i] =
            batch.slope[i] * (1. + power) + batch.flow_stress[i] * slope * rate_of_increment;
        batch.flow_stress[i] *= 1. + power;
      }
    }

  private:
    double reference_rate = 0.; ///< C [1/T]
    double exponent = 1.;       ///< 1/P
  };
} // namespace tombolo
