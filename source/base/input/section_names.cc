// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/section_names.h>

namespace tombolo
{
  std::vector<std::string> section_names(const Parameters &parameters, const std::string &list)
  {
    std::vector<std::string> names = parameters.raw_list(list);
    for (const std::string &name : names)
      if (name.find('/') != std::string::npos)
        parameters.fail(list, "the name \"" + name +
                                  "\" contains \"/\", which separates sections: allowed are all "
                                  "other characters.");
    return names;
  }
} // namespace tombolo
