// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameter_page.h>

#include <tombolo/base/input/registry.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <ostream>
#include <string>
#include <vector>

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
} // namespace tombolo
