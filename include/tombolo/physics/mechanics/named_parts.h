// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/model/part.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

namespace tombolo
{
  /** The number of the part that an entry of @p section names. Throws InputError. */
  template <int dim>
  unsigned int part_of_entry(const Section &section, const std::string &entry,
                             const std::string &name, const std::vector<Part<dim>> &parts)
  {
    std::vector<std::string> names;
    for (const Part<dim> &part : parts)
      names.push_back(part.name);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end())
      return static_cast<unsigned int>(found - names.begin());
    const std::string nearest = nearest_name(name, names);
    section.fail(entry, "there is no part \"" + name + "\"" +
                            (nearest.empty() ? "." : ", did you mean \"" + nearest + "\"?") +
                            " Parts are " + in_quotes(names) + ".");
  }

  /** The numbers of the parts of an entry that is a list of names. Throws InputError. */
  template <int dim>
  std::set<unsigned int> parts_of_entry(const Section &section, const std::string &entry,
                                        const std::vector<Part<dim>> &parts)
  {
    std::set<unsigned int> result;
    for (const std::string &name : section.get_list(entry))
      result.insert(part_of_entry(section, entry, name, parts));
    return result;
  }
} // namespace tombolo
