// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameter_declaration.h>

#include <algorithm>
#include <string>

namespace tombolo
{
  /** The entry of @p parent that chooses among sections, @p section among them; or nullptr. */
  inline const ParameterDeclaration *entry_that_chooses(const std::string &section,
                                                        const ParameterDeclaration &parent)
  {
    for (const ParameterDeclaration &entry : parent.children)
    {
      const auto alternatives = pattern_alternatives(entry.pattern);
      if (std::find(alternatives.begin(), alternatives.end(), section) != alternatives.end())
        return &entry;
    }
    return nullptr;
  }
} // namespace tombolo
