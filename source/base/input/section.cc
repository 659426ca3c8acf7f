// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <tombolo/base/input/parameters.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace tombolo
{
  std::string Section::get(const std::string &entry) const
  {
    const std::string path = joined_path(section_path, entry);
    const ParameterDeclaration *declaration = parameters->declarations().find(path);
    if (declaration != nullptr && !declaration->alias.empty())
      return get(declaration->alias);
    AssertThrow(declaration != nullptr && !declaration->is_section,
                ExcMessage("Nothing declares the entry \"" + path + "\" that is to be read."));
    return parameters->read(*declaration);
  }

  double Section::get_double(const std::string &entry) const
  {
    double value = 0;
    if (!is_number(get(entry), value) || !std::isfinite(value))
      fail(entry, "allowed is a number.");
    return value;
  }

  double Section::get_positive(const std::string &entry) const
  {
    const double value = get_double(entry);
    if (!(value > 0))
      fail(entry, "allowed is a number larger than zero.");
    return value;
  }

  unsigned int Section::get_unsigned(const std::string &entry) const
  {
    const std::string text = get(entry);
    char *end = nullptr;
    const long long value = std::strtoll(text.c_str(), &end, 10);
    if (text.empty() || end != text.c_str() + text.size() || value < 0 ||
        value > std::numeric_limits<unsigned int>::max())
      fail(entry, "allowed is a whole number from 0 to " +
                      std::to_string(std::numeric_limits<unsigned int>::max()) + ".");
    return static_cast<unsigned int>(value);
  }

  bool Section::get_bool(const std::string &entry) const
  {
    const std::string text = get(entry);
    if (text != "true" && text != "false")
      fail(entry, "allowed is \"true\" or \"false\".");
    return text == "true";
  }

  std::vector<std::string> Section::get_list(const std::string &entry) const
  {
    const std::vector<std::string> items = split_list(get(entry));
    for (const std::string &item : items)
      if (item.empty())
        fail(entry, "an item is missing before or after a comma.");
    return items;
  }

  std::vector<double> Section::get_doubles(const std::string &entry) const
  {
    std::vector<double> values;
    for (const auto &item : get_list(entry))
    {
      values.emplace_back();
      if (!is_number(item, values.back()) || !std::isfinite(values.back()))
        fail(entry,
             in_quotes(item) + " is not a number; allowed are numbers, separated by commas.");
    }
    return values;
  }

  bool Section::is_declared(const std::string &entry) const
  {
    const auto *const found = parameters->declarations().find(joined_path(section_path, entry));
    return found != nullptr && !found->is_section;
  }

  bool Section::is_equal_to(const Section &other) const
  {
    const auto *const declared = parameters->declarations().find(section_path);
    return declared == nullptr ||
           std::all_of(
               declared->children.begin(), declared->children.end(),
               [&](const ParameterDeclaration &child)
               {
                 return child.is_section
                            ? subsection(child.name).is_equal_to(other.subsection(child.name))
                            : parameters->value(child.path) ==
                                  parameters->value(joined_path(other.section_path, child.name));
               });
  }

  std::string Section::name() const
  {
    const std::string last = section_path.substr(section_path.rfind('/') + 1);
    const std::size_t colon = last.find(':');
    return colon == std::string::npos ? last : Utilities::trim(last.substr(colon + 1));
  }

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
