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

    constexpr RemovedEntry removed_entries[] = {
        {"smoothed cells/Basis", "", "Leave it out: functions are those of largest entropy."},
        {"smoothed cells/Integration", "Gauss", "Take `smoothed`, which passes the patch test."},
        {"Time step/Integrator", "", "Leave it out: steps are central differences."},
        {"Heat/explicit/Estimator", "",
         "Leave it out: the limit is that of the spectrum, which is a bound."},
        {"Time step/Estimator", "",
         "Leave it out: the limit is that of the spectrum, which is a bound."},
        {"hexahedron/Hourglass", "stiffness", "Leave it out: there is no other control."},
        {"hexahedron/Hourglass", "", "Take `Hourglass stiffness`."},
        {"hexahedron/Hourglass viscosity", "", "Take `Hourglass stiffness`."},
        {"momentum consistent particle/Gradient", "moving least squares",
         "Take `Shape functions = moving least squares`."},
        {"momentum consistent particle/Gradient", "",
         "Cell averages pass the patch test: take `Shape functions`."},
        {"momentum consistent particle/Gradient tolerance", "",
         "Cell averages pass the patch test: take `Shape functions`."},
        {"momentum consistent particle/Pair residual", "",
         "Take `Shape functions = cell averages`, or a `Lattice filter`."},
        {"momentum consistent particle/Pair residual limit", "",
         "Take `Shape functions = cell averages`, or a `Lattice filter`."}};

    bool is_end_of(const std::string &path, const std::string &end)
    {
      return path == end || (path.size() > end.size() &&
                             path.compare(path.size() - end.size() - 1, std::string::npos,
                                          "/" + end) == 0);
    }
  } // namespace

  std::string instead_of_removed(const std::string &path, const std::string &value)
  {
    for (const RemovedEntry &removed : removed_entries)
      if (is_end_of(path, removed.path) && (*removed.value == '\0' || value == removed.value))
        return removed.instead;
    return {};
  }
} // namespace tombolo
