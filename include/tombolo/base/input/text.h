// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdlib>
#include <string>
#include <vector>

namespace tombolo
{
  /** A text in quotation marks, shortened in the middle of long texts, for messages. */
  std::string in_quotes(const std::string &text);

  /** Such texts, separated by commas. */
  std::string in_quotes(const std::vector<std::string> &texts);

  /** All texts, with a separator between them. */
  std::string joined(const std::vector<std::string> &texts, const std::string &separator);

  /** "Section/Entry" of a section's path, which may be empty, and a name in it. */
  std::string joined_path(const std::string &section, const std::string &name);

  /** The items between separators, without blanks around them; none of an empty text. */
  std::vector<std::string> split_list(const std::string &text, char separator = ',');

  /** The section and the name of a path. */
  std::string parent_path(const std::string &path);
  std::string last_name(const std::string &path);

  /** Whether the whole text is one number, which @p value becomes; it need not be finite. */
  inline bool is_number(const std::string &text, double &value)
  {
    char *end = nullptr;
    value = std::strtod(text.c_str(), &end);
    return !text.empty() && end == text.c_str() + text.size();
  }
} // namespace tombolo
