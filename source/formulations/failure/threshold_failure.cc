// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/failure/threshold_failure.h>

#include <limits>

namespace tombolo
{
  using namespace dealii;

  ThresholdFailure::ThresholdFailure(const Entries &e, const std::string &unit,
                                     const std::string &documentation_of_limit)
      : section(e.section())
  {
    limit = e.number("Limit", mandatory, positive(), unit, documentation_of_limit);
    critical_stretch = e.number("Stretch", "1", positive(), "1",
                                "The present over the initial distance of a pair beyond which it "
                                "can break; at 1 bonds that are shorter than at the start hold.");
    needs_both = e.choice("Combination", "both", "both|either",
                          "A bond breaks where the limit is reached and it is stretched beyond "
                          "`Stretch` (`both`), or where either is so. With `either` all pairs are "
                          "looked at in every check.") == "both";
    e.refuse(!needs_both && critical_stretch <= 1., "Stretch",
             "where `Combination` is `either`, allowed is a number above 1: at 1 or below, all "
             "bonds would break at the start");
  }

  double ThresholdFailure::threshold() const
  {
    return needs_both ? limit : std::numeric_limits<double>::lowest();
  }

  void ThresholdFailure::judge(const unsigned int n, const double *mean, const double *stretch,
                               std::uint8_t *breaks) const
  {
    // Pairs that are as long as at the start differ from 1 by round-off of their positions.
    constexpr double margin = 1e-9;
    const double largest = (1. + margin) * critical_stretch;
    for (unsigned int k = 0; k < n; ++k)
    {
      const bool is_reached = mean[k] >= limit, is_stretched = stretch[k] > largest;
      breaks[k] = (needs_both ? is_reached && is_stretched : is_reached || is_stretched) ? 1 : 0;
    }
  }
} // namespace tombolo
