// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameter_declaration.h>

#include <tombolo/base/input/registry.h>
#include <tombolo/base/json.h>

#include <deal.II/base/utilities.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>
#include <ostream>

namespace tombolo
{
  namespace
  {
    /** Text for a cell of a table: what markdown would read as markup is escaped, but for code in
     * backticks and formulas between dollar signs. */
    std::string table_text(const std::string &text)
    {
      const std::string markup = "*_<[\\";
      std::string result;
      bool is_literal = false;
      for (const char c : text)
      {
        if (c == '`' || c == '$')
          is_literal = !is_literal;
        if (c == '|' || (!is_literal && markup.find(c) != std::string::npos))
          result += '\\';
        result += c == '\n' ? ' ' : c;
      }
      return result;
    }

    std::string as_code(const std::string &text)
    {
      return text.empty() ? "" : "`" + text + "`";
    }

    /** The description of the plug-in that a section belongs to; empty where it belongs to none.
     * Of kinds that both have a plug-in of this name, it is the one that shares most names with
     * the entry beside the section that selects it. */
    std::string plugin_description(const ParameterDeclaration &parent,
                                   const ParameterDeclaration &section)
    {
      std::map<std::string, std::size_t> n_shared; // by kind
      const auto plugins = list_plugins();
      for (const ParameterDeclaration &sibling : parent.children)
      {
        const auto names = pattern_alternatives(sibling.pattern);
        if (std::find(names.begin(), names.end(), section.name) != names.end())
          for (const PluginDescription &plugin : plugins)
            n_shared[plugin.kind] +=
                std::find(names.begin(), names.end(), plugin.name) != names.end() ? 1 : 0;
      }
      std::string description;
      std::size_t most = 0;
      for (const PluginDescription &plugin : plugins)
        if (plugin.name == section.name && n_shared[plugin.kind] > most)
        {
          most = n_shared[plugin.kind];
          description = plugin.description;
        }
      if (!description.empty())
        description[0] =
            static_cast<char>(std::toupper(static_cast<unsigned char>(description[0])));
      return description;
    }

    void print_row(std::ostream &out, const ParameterDeclaration &section,
                   const ParameterDeclaration &entry)
    {
      std::string meaning = entry.documentation;
      for (const ParameterDeclaration &other : section.children)
        if (other.alias == entry.name)
          meaning += " Also read as " + as_code(other.name) + ".";
      out << "| " << table_text(as_code(entry.name)) << " | "
          << (entry.is_mandatory ? "mandatory" : table_text(as_code(entry.default_value))) << " | "
          << table_text(describe_pattern(entry.pattern)) << " | " << table_text(meaning) << " |\n";
    }

    void print_section(std::ostream &out, const ParameterDeclaration &section,
                       const std::string &description)
    {
      const auto depth = std::count(section.path.begin(), section.path.end(), '/');
      out << (depth == 0 ? "\n## " : "\n### ")
          << (section.path.empty() ? "Outside of all sections" : as_code(section.path)) << "\n";
      if (!description.empty())
        out << "\n" << table_text(description) << ".\n";
      if (!section.entry_names().empty())
        out << "\n| entry | default | allowed | meaning |\n|---|---|---|---|\n";
      else if (section.section_names().empty())
        out << "\nNo entries.\n";
      for (const ParameterDeclaration &child : section.children)
        if (!child.is_section && child.alias.empty())
          print_row(out, section, child);
      for (const ParameterDeclaration &child : section.children)
        if (child.is_section)
          print_section(out, child, plugin_description(section, child));
    }
  } // namespace

  void print_parameter_page(std::ostream &out, const ParameterDeclaration &root)
  {
    out << "# Parameters\n\n"
           "The entries of a parameter file, section by section. A section of a plug-in, such as a "
           "material, is read only where\nthe entry beside it selects the plug-in. L, M and T are "
           "the units of length, mass and time that the file uses.\n";
    print_section(out, root, "");
  }

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

    void print_entries(std::ostream &out, const PrintedEntries &entries,
                       const ParameterDeclaration &section, const unsigned int depth,
                       const bool with_documentation)
    {
      const std::string indent(2 * depth, ' ');
      const auto is_listed = [&](const ParameterDeclaration &declaration)
      { return declaration.alias.empty() && (with_documentation || entries.has(declaration)); };

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
          const std::string text = entries.value(entry.path);
          out << indent << (entries.is_in_use(entry.path) ? "" : "# ") << "set " << entry.name
              << std::string(width - entry.name.size(), ' ') << " =" << (text.empty() ? "" : " ")
              << text << '\n';
          is_first = false;
        }

      for (const auto &child : section.children)
        if (child.is_section && is_listed(child))
        {
          out << (is_first ? "" : "\n") << indent << "subsection " << child.name << '\n';
          print_entries(out, entries, child, depth + 1, with_documentation);
          out << indent << "end\n";
          is_first = false;
        }
    }

    void print_object(std::ostream &out, const PrintedEntries &entries,
                      const ParameterDeclaration &section, const unsigned int depth)
    {
      const std::string indent(2 * (depth + 1), ' ');
      bool is_first = true;
      out << '{';
      for (const auto &child : section.children)
        if (entries.has(child))
        {
          out << (is_first ? "\n" : ",\n") << indent << json_string(child.name) << ": ";
          if (child.is_section)
            print_object(out, entries, child, depth + 1);
          else
            out << json_value(entries.value(child.path), child.pattern);
          is_first = false;
        }
      out << (is_first ? "" : "\n" + std::string(2 * depth, ' ')) << '}';
    }
  } // namespace

  bool PrintedEntries::has(const ParameterDeclaration &declaration) const
  {
    if (!declaration.alias.empty())
      return false;
    if (are_all)
      return true;
    if (!declaration.is_section)
      return is_in_use(declaration.path);
    for (const auto &child : declaration.children)
      if (has(child))
        return true;
    return false;
  }

  void print_prm(std::ostream &out, const PrintedEntries &entries,
                 const ParameterDeclaration &section, const bool with_documentation)
  {
    const auto names = Utilities::split_string_list(section.path, std::string("/"));
    const auto depth = static_cast<unsigned int>(names.size());
    for (unsigned int i = 0; i < depth; ++i)
      out << std::string(2 * i, ' ') << "subsection " << names[i] << '\n';
    print_entries(out, entries, section, depth, with_documentation);
    for (unsigned int i = depth; i-- > 0;)
      out << std::string(2 * i, ' ') << "end\n";
  }

  void print_json(std::ostream &out, const PrintedEntries &entries,
                  const ParameterDeclaration &section)
  {
    print_object(out, entries, section, 0);
    out << '\n';
  }

  void refuse_format(const std::string &format)
  {
    if (format == "xml")
      throw InputError(
          "The format \"xml\" of parameters has all sections; of one there are \"prm\", "
          "\"json\" and \"markdown\".");
    throw InputError("The format " + in_quotes(format) +
                     " of parameters is unknown; known are \"prm\", \"json\", \"xml\" and "
                     "\"markdown\".");
  }
} // namespace tombolo
