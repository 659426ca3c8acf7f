// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <map>
#include <string>

namespace tombolo
{
  class Section;

  /** An output that is not named in `Further outputs`: a scene has it where it has what the output
   * shows. A static object makes it known. */
  struct OutputOfScene
  {
    OutputOfScene(const int order, const std::string &name, const std::string &switched_by,
                  const std::function<bool(const Section &)> &is_wanted)
        : name(name), switched_by(switched_by), is_wanted(is_wanted)
    {
      all().emplace(order, *this);
    }

    std::string name;                               ///< of the plug-in
    std::string switched_by;                        ///< for messages
    std::function<bool(const Section &)> is_wanted; ///< from section Output

    /** All of them, by their order. */
    static std::multimap<int, OutputOfScene> &all();
  };
} // namespace tombolo
