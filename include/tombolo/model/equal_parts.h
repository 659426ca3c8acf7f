// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/formulations/formulation.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** Sets the equal parts, and those of another material, of a part whose section is one of
   * @p part_sections. */
  template <int dim>
  void find_equal_parts(const std::vector<Section> &part_sections, PartSetup<dim> &setup)
  {
    const Section &section = part_sections[setup.index];
    const std::string formulation = section.get("Formulation");
    for (unsigned int p = 0; p < part_sections.size(); ++p)
      if (const Section &other = part_sections[p];
          p != setup.index && other.get("Formulation") == formulation &&
          section.subsection(formulation).is_equal_to(other.subsection(formulation)))
        (other.get("Material") == section.get("Material") ? setup.equal_parts
                                                          : setup.parts_of_other_material)
            .push_back(p);
  }
} // namespace tombolo
