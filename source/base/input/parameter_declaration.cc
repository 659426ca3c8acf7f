// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameter_declaration.h>

#include <deal.II/base/utilities.h>

#include <tombolo/base/input/parameter_scanner.h>

#include <boost/algorithm/string/predicate.hpp>
#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>

#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    using Tree = boost::property_tree::ptree;

    /** Undoes what ParameterHandler does to names in XML: every character other than a letter or a
     * digit is written as '_' and two hexadecimal digits. */
    std::string demangle(const std::string &name)
    {
      std::string result;
      for (std::size_t i = 0; i < name.size(); ++i)
        if (name[i] == '_' && i + 2 < name.size())
        {
          result += static_cast<char>(std::stoi(name.substr(i + 1, 2), nullptr, 16));
          i += 2;
        }
        else
          result += name[i];
      return result;
    }

    /** A child without children: a property of an entry. The entry "value" of a section is
     * mangled, hence not mistaken for one. */
    const std::string *property(const Tree &tree, const char *name)
    {
      const auto found = tree.find(name);
      return found != tree.not_found() && found->second.empty() ? &found->second.data() : nullptr;
    }

    void collect(const Tree &tree, ParameterDeclaration &section)
    {
      for (const auto &[mangled_name, subtree] : tree)
      {
        ParameterDeclaration child;
        child.name = demangle(mangled_name);
        child.path = joined_path(section.path, child.name);
        if (const auto *alias = property(subtree, "alias"))
        {
          child.alias = *alias;
          child.is_deprecated = subtree.get<std::string>("deprecation_status", "") == "true";
        }
        else if (const auto *default_value = property(subtree, "default_value"))
        {
          child.default_value = *default_value;
          child.documentation = subtree.get<std::string>("documentation", "");
          child.pattern = subtree.get<std::string>("pattern_description", "");
          child.is_mandatory = boost::starts_with(child.documentation, mandatory_mark);
          if (child.is_mandatory)
            child.documentation.erase(0, std::string(mandatory_mark).size());
        }
        else
        {
          child.is_section = true;
          collect(subtree, child);
        }
        section.children.push_back(std::move(child));
      }
    }

    /** "[Double a...b (inclusive)]" or "[Integer range a...b (inclusive)]" in words. */
    std::string describe_range(const std::string &pattern, const std::string &noun,
                               const std::string &lowest, const std::string &highest)
    {
      const std::size_t dots = pattern.find("...");
      if (dots == std::string::npos)
        return noun;
      const std::size_t begin = pattern.rfind(' ', dots) + 1;
      const std::string lower = pattern.substr(begin, dots - begin);
      const std::string upper = pattern.substr(dots + 3, pattern.find(' ', dots) - dots - 3);
      if (lower != lowest && upper != highest)
        return noun + " from " + lower + " to " + upper;
      if (lower != lowest)
        return noun + " of at least " + lower;
      return upper != highest ? noun + " of at most " + upper : noun;
    }

    /** "[List of <...> of length a...b (inclusive) separated by <;>]" in words. */
    std::string describe_list(const std::string &pattern)
    {
      const std::string opening = "[List of <";
      const std::size_t close = pattern.rfind("> of length ");
      if (close == std::string::npos)
        return pattern;
      const std::string item =
          describe_pattern(pattern.substr(opening.size(), close - opening.size()));
      const std::string length = pattern.substr(close + std::string("> of length ").size());
      const std::size_t dots = length.find("...");
      const std::string lower = length.substr(0, dots);
      const std::string upper = length.substr(dots + 3, length.find(' ', dots) - dots - 3);
      const std::size_t mark = length.find("separated by <");
      const std::string separator =
          mark == std::string::npos ? "," : length.substr(mark + 14, length.rfind('>') - mark - 14);
      std::string count = lower + " to " + upper;
      if (lower == upper)
        count = lower;
      else if (upper == std::to_string(Patterns::List::max_int_value))
        count = lower == "0" ? "any number of" : "at least " + lower;
      return "a list, separated by " + (separator == "," ? "commas" : in_quotes(separator)) +
             ", of " + count + " items, each of them " + item;
    }
  } // namespace

  const ParameterDeclaration *ParameterDeclaration::find(const std::string &path) const
  {
    if (path.empty())
      return this;
    const std::size_t slash = path.find('/');
    const std::string first = path.substr(0, slash);
    for (const auto &child : children)
      if (child.name == first)
        return slash == std::string::npos ? &child : child.find(path.substr(slash + 1));
    return nullptr;
  }

  std::vector<std::string> ParameterDeclaration::entry_names() const
  {
    std::vector<std::string> names;
    for (const auto &child : children)
      if (!child.is_section && child.alias.empty())
        names.push_back(child.name);
    return names;
  }

  std::vector<std::string> ParameterDeclaration::section_names() const
  {
    std::vector<std::string> names;
    for (const auto &child : children)
      if (child.is_section)
        names.push_back(child.name);
    return names;
  }

  ParameterDeclaration collect_declarations(const ParameterHandler &handler)
  {
    // XML, since in its JSON form the handler reads a '.' in a name as the end of a section.
    std::stringstream xml;
    handler.print_parameters(xml,
                             ParameterHandler::OutputStyle(ParameterHandler::XML |
                                                           ParameterHandler::KeepDeclarationOrder));
    Tree tree;
    boost::property_tree::read_xml(xml, tree);
    ParameterDeclaration root;
    root.is_section = true;
    collect(tree.get_child("ParameterHandler"), root);
    return root;
  }

  bool set_value(ParameterHandler &handler, const ParameterDeclaration &entry,
                 const std::string &value)
  {
    const auto sections = Utilities::split_string_list(parent_path(entry.path), std::string("/"));
    for (const auto &name : sections)
      handler.enter_subsection(name);
    bool is_suitable = true;
    try
    {
      handler.set(entry.name, value);
    }
    catch (const ParameterHandler::ExcValueDoesNotMatchPattern &)
    {
      is_suitable = false;
    }
    for (unsigned int i = 0; i < sections.size(); ++i)
      handler.leave_subsection();
    return is_suitable;
  }

  std::vector<std::string> pattern_alternatives(const std::string &pattern)
  {
    for (const std::string opening : {"[Selection ", "[MultipleSelection "})
      if (boost::starts_with(pattern, opening))
        return Utilities::split_string_list(
            pattern.substr(opening.size(), pattern.size() - opening.size() - 1), '|');
    return {};
  }

  std::string describe_pattern(const std::string &pattern)
  {
    if (boost::starts_with(pattern, "[Bool"))
      return "\"true\" or \"false\"";
    if (boost::starts_with(pattern, "[Double"))
      return describe_range(pattern, "a number", "-MAX_DOUBLE", "MAX_DOUBLE");
    if (boost::starts_with(pattern, "[Integer"))
      return describe_range(pattern, "a whole number",
                            std::to_string(std::numeric_limits<int>::min()),
                            std::to_string(std::numeric_limits<int>::max()));
    if (boost::starts_with(pattern, "[Selection") && pattern_alternatives(pattern).empty())
      return "the name of a plug-in, of which none is loaded";
    if (boost::starts_with(pattern, "[Selection"))
      return "one of " + in_quotes(pattern_alternatives(pattern));
    if (boost::starts_with(pattern, "[MultipleSelection"))
      return "a list, separated by commas, of " + in_quotes(pattern_alternatives(pattern));
    if (boost::starts_with(pattern, "[List of <"))
      return describe_list(pattern);
    if (boost::starts_with(pattern, "[Anything"))
      return "any text";
    if (boost::starts_with(pattern, "[FileName"))
      return "the name of a file";
    if (boost::starts_with(pattern, "[DirectoryName"))
      return "the name of a directory";
    return pattern;
  }
} // namespace tombolo
