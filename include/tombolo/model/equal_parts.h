// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** PartSetup::equal_parts of the part number @p part, whose section is one of @p part_sections.
   */
  inline std::vector<unsigned int> equal_parts(const std::vector<Section> &part_sections,
                                               const unsigned int part)
  {
    std::vector<unsigned int> result;
    const Section &section = part_sections[part];
    const std::string formulation = section.get("Formulation");
    for (unsigned int p = 0; p < part_sections.size(); ++p)
      if (const Section &other = part_sections[p];
          p != part && other.get("Material") == section.get("Material") &&
          other.get("Formulation") == formulation &&
          section.subsection(formulation).is_equal_to(other.subsection(formulation)))
        result.push_back(p);
    return result;
  }
} // namespace tombolo
