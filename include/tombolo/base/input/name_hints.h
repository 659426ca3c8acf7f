// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameter_declaration.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** " Did you mean ...?" with the candidate nearest to @p name; empty if none is near. */
  std::string did_you_mean(const std::string &name, const std::vector<std::string> &candidates);

  /** Sentences for a message about an entry that @p section, below @p root, does not have: what was
   * meant perhaps, and its known entries. */
  std::string entry_hints(const ParameterDeclaration &root, const ParameterDeclaration &section,
                          const std::string &name);

  /** The section of @p parent that @p name means perhaps: the nearest name, or "Part: side" for
   * "side"; empty if there is none. */
  std::string nearest_section(const std::string &name, const ParameterDeclaration &parent);

  /** The entry that lists the names of the sections "KIND: NAME": "Parts", "Processes", "Meshes".
   */
  std::string list_of_sections(const std::string &kind);

  /** Likewise for a section that @p parent does not have. Sections as "Part: side" exist for the
   * names that a list, here "Parts", has in the section above. */
  std::string section_hints(const ParameterDeclaration &parent, const std::string &name);

  /** Likewise for a value that @p entry does not allow. */
  std::string value_hints(const ParameterDeclaration &entry, const std::string &value);

  /** The section at a path below @p root, "" for the root. "Part" stands for a section "Part:
   * NAME". Throws InputError. */
  const ParameterDeclaration &find_section(const ParameterDeclaration &root,
                                           const std::string &path);
} // namespace tombolo
