// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameter_printer.h>

#include <tombolo/base/json.h>

#include <deal.II/base/utilities.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <ostream>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr unsigned int line_width = 90;

    std::string json_string(const std::string &text)
    {
      return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
    }

    /** The value as JSON: numbers and truth values of entries that are declared so, else text. */
    std::string json_value(const std::string &value, const std::string &pattern)
    {
      const bool is_number = pattern.rfind("[Double", 0) == 0 || pattern.rfind("[Integer", 0) == 0;
      if (is_number && Json::accept(value))
        return value;
      if (is_number && !value.empty())
        return Json(std::strtod(value.c_str(), nullptr)).dump(); // ".5", "+3" are not JSON
      if (pattern.rfind("[Bool", 0) == 0 && (value == "true" || value == "false"))
        return value;
      return json_string(value);
    }

    void print_comment(std::ostream &out, const std::string &text, const std::string &indent)
    {
      for (const auto &line : Utilities::break_text_into_lines(
               text, line_width - static_cast<unsigned int>(indent.size()) - 2))
        out << indent << "# " << line << '\n';
    }
  } // namespace

  ParameterPrinter::ParameterPrinter(const bool prints_all, IsInUse is_in_use, Value value)
      : prints_all(prints_all), is_in_use(std::move(is_in_use)), value(std::move(value))
  {}

  bool ParameterPrinter::is_printed(const ParameterDeclaration &declaration) const
  {
    if (!declaration.alias.empty())
      return false;
    if (prints_all)
      return true;
    if (!declaration.is_section)
      return is_in_use(declaration.path);
    for (const auto &child : declaration.children)
      if (is_printed(child))
        return true;
    return false;
  }

  void ParameterPrinter::print_prm(std::ostream &out, const bool with_documentation,
                                   const ParameterDeclaration &section) const
  {
    const auto names = Utilities::split_string_list(section.path, std::string("/"));
    const auto depth = static_cast<unsigned int>(names.size());
    for (unsigned int i = 0; i < depth; ++i)
      out << std::string(2 * i, ' ') << "subsection " << names[i] << '\n';
    print_prm(out, section, depth, with_documentation);
    for (unsigned int i = depth; i-- > 0;)
      out << std::string(2 * i, ' ') << "end\n";
  }

  void ParameterPrinter::print_json(std::ostream &out, const ParameterDeclaration &section) const
  {
    print_json(out, section, 0);
    out << '\n';
  }

  void ParameterPrinter::print_prm(std::ostream &out, const ParameterDeclaration &section,
                                   const unsigned int depth, const bool with_documentation) const
  {
    const std::string indent(2 * depth, ' ');
    const auto is_listed = [&](const ParameterDeclaration &declaration)
    { return declaration.alias.empty() && (with_documentation || is_printed(declaration)); };

    std::size_t width = 0;
    for (const auto &entry : section.children)
      if (!entry.is_section && is_listed(entry))
        width = std::max(width, entry.name.size());

    bool is_first = true;
    for (const auto &entry : section.children)
      if (!entry.is_section && is_listed(entry))
      {
        if (with_documentation)
        {
          out << (is_first ? "" : "\n");
          print_comment(out,
                        (entry.is_mandatory ? mandatory_mark : "") + entry.documentation +
                            (entry.documentation.empty() ? "" : " ") +
                            "Allowed: " + describe_pattern(entry.pattern) + "." +
                            (entry.is_mandatory || entry.default_value.empty()
                                 ? ""
                                 : " Default: " + entry.default_value),
                        indent);
        }
        const std::string text = value(entry.path);
        out << indent << (is_in_use(entry.path) ? "" : "# ") << "set " << entry.name
            << std::string(width - entry.name.size(), ' ') << " =" << (text.empty() ? "" : " ")
            << text << '\n';
        is_first = false;
      }

    for (const auto &child : section.children)
      if (child.is_section && is_listed(child))
      {
        out << (is_first ? "" : "\n") << indent << "subsection " << child.name << '\n';
        print_prm(out, child, depth + 1, with_documentation);
        out << indent << "end\n";
        is_first = false;
      }
  }

  void ParameterPrinter::print_json(std::ostream &out, const ParameterDeclaration &section,
                                    const unsigned int depth) const
  {
    const std::string indent(2 * (depth + 1), ' ');
    bool is_first = true;
    out << '{';
    for (const auto &child : section.children)
      if (is_printed(child))
      {
        out << (is_first ? "\n" : ",\n") << indent << json_string(child.name) << ": ";
        if (child.is_section)
          print_json(out, child, depth + 1);
        else
          out << json_value(value(child.path), child.pattern);
        is_first = false;
      }
    out << (is_first ? "" : "\n" + std::string(2 * depth, ' ')) << '}';
  }
} // namespace tombolo
