// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/override.h>

#include <tombolo/base/exceptions.h>

#include <deal.II/base/utilities.h>

namespace tombolo
{
  using namespace dealii;

  ParameterScanner::Item read_override(const std::string &assignment)
  {
    const auto refuse = [&](const std::string &message)
    { throw InputError("--set " + in_quotes(assignment) + ": " + message); };
    const std::size_t equal = assignment.find('=');
    if (equal == std::string::npos)
      refuse("\"=\" is missing. Write --set \"Section/Entry = value\".");
    std::string path;
    for (const auto &part :
         Utilities::split_string_list(assignment.substr(0, equal), std::string("/")))
    {
      const std::string name = Utilities::trim(part);
      if (name.empty())
        refuse("a name is missing before \"=\". Write --set \"Section/Entry = value\".");
      path = joined_path(path, name);
    }
    if (path.empty())
      refuse("a name is missing before \"=\". Write --set \"Section/Entry = value\".");
    const std::string value = Utilities::trim(assignment.substr(equal + 1));
    if (value.find_first_of("#\n\r") != std::string::npos ||
        (!value.empty() && value.back() == '\\'))
      refuse("a value has no \"#\" and no line break and does not end in \"\\\".");
    return {false, path, value, {"--set", 0}};
  }
} // namespace tombolo
