// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** Something that a study varies: entries of a parameter file that are set together, and the
   * values that they take. */
  struct Factor
  {
    /** The entry that stands for the parameter file itself. */
    static constexpr const char *base_file = "Base file";

    struct Value
    {
      std::string label;              ///< for tables and pictures, unlike those of other values
      std::vector<std::string> texts; ///< one for each entry
    };

    std::string name;
    std::string section_path;         ///< "Factor: NAME"
    std::vector<std::string> entries; ///< paths of entries, or base_file
    std::vector<Value> values;        ///< at least one

    /** Declares the entries of a section "Factor: NAME". */
    static void declare_parameters(dealii::ParameterHandler &handler);

    /** Reads a section "Factor: NAME". Throws InputError. */
    static Factor read(const Section &section);
  };

  /** The texts between separators, without blanks at their ends; those that are empty stay. */
  std::vector<std::string> split_texts(const std::string &text, const std::string &separator);
} // namespace tombolo
