// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/removed_entries.h>

namespace tombolo
{
  namespace
  {
    struct RemovedEntry
    {
      const char *path;  ///< its last names
      const char *value; ///< the one that was removed; empty: the entry with all of them
      const char *instead;
    };

    constexpr const char *cell_averages = "Take `Shape functions = cell averages`.";
    constexpr const char *no_estimator =
        "Leave it out: the limit is that of the spectrum, which is a bound.";

    constexpr RemovedEntry removed_entries[] = {
        {"Heat/explicit/Estimator", "", no_estimator},
        {"Time step/Estimator", "", no_estimator},
        {"Time step/Integrator", "", "Leave it out: steps are central differences."},
        {"hexahedron/Hourglass", "", "Take `Hourglass stiffness`."},
        {"hexahedron/Hourglass viscosity", "", "Take `Hourglass stiffness`."},
        {"momentum consistent particle/Gradient", "",
         "Take `Shape functions`: `cell averages` pass the patch test, or `moving least squares`."},
        {"momentum consistent particle/Gradient tolerance", "", cell_averages},
        {"momentum consistent particle/Pair residual", "", cell_averages},
        {"momentum consistent particle/Pair residual limit", "", cell_averages},
        {"smoothed cells/Basis", "", "Leave it out: functions are those of largest entropy."},
        {"smoothed cells/Integration", "Gauss", "Take `smoothed`, which passes the patch test."},
        {"smoothed cells/Refill volume ratio", "",
         "Leave it out: a fifth of the volume at the last refill is the limit."}};

    bool is_end_of(const std::string &path, const std::string &end)
    {
      return path == end ||
             (path.size() > end.size() &&
              path.compare(path.size() - end.size() - 1, std::string::npos, "/" + end) == 0);
    }
  } // namespace

  std::string instead_of_removed(const std::string &path, const std::string &value)
  {
    for (const RemovedEntry &removed : removed_entries)
      if (value == removed.value && is_end_of(path, removed.path))
        return removed.instead;
    return {};
  }
} // namespace tombolo
