// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/failure/bond_failure.h>

#include <string>

namespace tombolo
{
  /** A bond breaks where the mean measure of the pair reaches a limit and the pair is stretched
   * beyond a ratio, or either of them. What the measure is, derived classes say. */
  class ThresholdFailure : public BondFailure
  {
  public:
    double threshold() const override;
    void judge(unsigned int n, const double *mean, const double *stretch,
               std::uint8_t *breaks) const override;

  protected:
    /** `Limit` of the measure, with its unit and documentation, `Stretch` and `Combination`. */
    ThresholdFailure(const Entries &e, const std::string &unit,
                     const std::string &documentation_of_limit);

    Section section;

  private:
    double limit;
    double critical_stretch;
    bool needs_both;
  };
} // namespace tombolo
