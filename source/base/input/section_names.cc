// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/section_names.h>

namespace tombolo
{
  std::vector<std::string> section_names(const Parameters &parameters, const std::string &list)
  {
    std::vector<std::string> names;
    for (const std::string &name : parameters.raw_list(list))
      if (name.find('/') == std::string::npos)
        names.push_back(name);
      else
        parameters.refuse(list, "the name \"" + name +
                                    "\" contains \"/\", which separates sections: allowed are all "
                                    "other characters.");
    return names;
  }
} // namespace tombolo
