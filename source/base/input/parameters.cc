// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameters.h>

#include <deal.II/base/utilities.h>

#include <tombolo/base/input/name_hints.h>
#include <tombolo/base/input/parameter_page.h>
#include <tombolo/base/input/parameter_printer.h>

#include <algorithm>
#include <memory>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** A mandatory entry has no default: lets the handler take the empty text for it. */
    class EmptyOr : public Patterns::PatternBase
    {
    public:
      explicit EmptyOr(std::unique_ptr<Patterns::PatternBase> pattern) : pattern(std::move(pattern))
      {}

      bool match(const std::string &text) const override
      {
        return text.empty() || pattern->match(text);
      }

      std::string description(const OutputStyle style) const override
      {
        return pattern->description(style);
      }

      std::unique_ptr<Patterns::PatternBase> clone() const override
      {
        return std::make_unique<EmptyOr>(pattern->clone());
      }

    private:
      std::unique_ptr<Patterns::PatternBase> pattern;
    };

    std::string parent_path(const std::string &path)
    {
      const std::size_t slash = path.rfind('/');
      return slash == std::string::npos ? "" : path.substr(0, slash);
    }

    std::string last_name(const std::string &path)
    {
      const std::size_t slash = path.rfind('/');
      return slash == std::string::npos ? path : path.substr(slash + 1);
    }

    std::string section_in_words(const std::string &path)
    {
      return path.empty() ? "the file outside of all sections" : "section " + in_quotes(path);
    }
  } // namespace

  Parameters::Parameters(const MPI_Comm communicator) : scanner(communicator) {}

  void Parameters::read_file(const std::string &file_name)
  {
    if (main_file.empty())
      main_file = file_name;
    scanner.read_file(file_name);
  }

  void Parameters::read_text(const std::string &text, const std::string &name)
  {
    if (main_file.empty())
      main_file = name;
    scanner.read_text(text, name);
  }

  void Parameters::add_override(const std::string &assignment)
  {
    const auto refuse = [&](const std::string &message)
    { throw InputError("--set " + in_quotes(assignment) + ": " + message); };
    const std::size_t equal = assignment.find('=');
    if (equal == std::string::npos)
      refuse("\"=\" is missing. Write --set \"Section/Entry = value\".");
    std::string path;
    for (const auto &part :
         Utilities::split_string_list(assignment.substr(0, equal), std::string("/")))
    {
      const std::string name = Utilities::trim(part);
      if (name.empty())
        refuse("a name is missing before \"=\". Write --set \"Section/Entry = value\".");
      path = joined_path(path, name);
    }
    if (path.empty())
      refuse("a name is missing before \"=\". Write --set \"Section/Entry = value\".");
    const std::string value = Utilities::trim(assignment.substr(equal + 1));
    if (value.find_first_of("#\n\r") != std::string::npos ||
        (!value.empty() && value.back() == '\\'))
      refuse("a value has no \"#\" and no line break and does not end in \"\\\".");
    const auto [other, is_new] = overrides.emplace(path, Item{false, path, value, {"--set", 0}});
    if (!is_new)
      refuse("this entry is already set by " + prefix(other->second) + ". Remove one of them.");
  }

  std::string Parameters::raw(const std::string &path, const std::string &fallback) const
  {
    used.insert(path);
    const Item *const item = setting(path);
    return item == nullptr ? fallback : item->value;
  }

  std::vector<std::string> Parameters::raw_list(const std::string &path) const
  {
    const std::string text = raw(path);
    if (text.empty())
      return {};
    std::vector<std::string> names;
    for (std::size_t begin = 0; begin <= text.size();)
    {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      const std::string name = Utilities::trim(text.substr(begin, end - begin));
      begin = end + 1;
      if (name.empty())
        fail(path, "a name is missing before or after a comma.");
      if (std::find(names.begin(), names.end(), name) != names.end())
        fail(path, "the name " + in_quotes(name) + " stands twice.");
      names.push_back(name);
    }
    return names;
  }

  ParameterHandler &Parameters::handler()
  {
    return parameter_handler;
  }

  void Parameters::declare_mandatory(ParameterHandler &handler, const std::string &entry,
                                     const Patterns::PatternBase &pattern,
                                     const std::string &documentation)
  {
    handler.declare_entry(entry, "", EmptyOr(pattern.clone()), mandatory_mark + documentation);
  }

  void Parameters::assign()
  {
    declaration_tree = collect_declarations(parameter_handler);
    is_assigned = true;
    for (const auto &item : scanner.items())
      if (item.is_section)
        check_section(item.path, to_string(item.location));
      else
        assign_entry(item);
    for (const auto &[path, item] : overrides)
    {
      check_section(parent_path(path), prefix(item));
      assign_entry(item);
    }
  }

  void Parameters::check_section(const std::string &path, const std::string &prefix) const
  {
    const ParameterDeclaration *parent = &declarations();
    for (const auto &name : Utilities::split_string_list(path, std::string("/")))
    {
      const ParameterDeclaration *const section = parent->find(name);
      if (section == nullptr || !section->is_section)
        throw InputError(prefix + ": unknown section " +
                         in_quotes(joined_path(parent->path, name)) + "." +
                         section_hints(*parent, name));
      parent = section;
    }
  }

  void Parameters::assign_entry(const Item &item)
  {
    const ParameterDeclaration &section = *declarations().find(parent_path(item.path));
    const ParameterDeclaration *entry = section.find(last_name(item.path));
    if (entry == nullptr || entry->is_section)
      throw InputError(prefix(item) + ": unknown entry " + in_quotes(item.path) + "." +
                       entry_hints(declarations(), section, last_name(item.path)));
    if (!entry->alias.empty())
    {
      entry = section.find(entry->alias);
      if (const Item *const other = setting(entry->path);
          other != nullptr && other->path != item.path)
        throw InputError(prefix(item) + ": entry " + in_quotes(item.path) + " is another name of " +
                         in_quotes(entry->path) + ", which is set, too (" + prefix(*other) +
                         "). Remove one of them.");
      aliases[entry->path] = item.path;
    }

    const auto sections = Utilities::split_string_list(section.path, std::string("/"));
    for (const auto &name : sections)
      parameter_handler.enter_subsection(name);
    const bool is_missing = entry->is_mandatory && item.value.empty();
    bool is_suitable = !is_missing;
    try
    {
      parameter_handler.set(entry->name, item.value);
    }
    catch (const ParameterHandler::ExcValueDoesNotMatchPattern &)
    {
      is_suitable = false;
    }
    for (unsigned int i = 0; i < sections.size(); ++i)
      parameter_handler.leave_subsection();

    if (!is_suitable)
    {
      const auto alternatives = pattern_alternatives(entry->pattern);
      throw InputError(prefix(item) +
                       (item.location.line == 0
                            ? ""
                            : ": entry " + in_quotes(item.path) + " = " + in_quotes(item.value)) +
                       ": " +
                       (is_missing && describe_pattern(entry->pattern) == "any text"
                            ? "the value is missing. It has no default: " + entry->documentation
                            : "allowed is " + describe_pattern(entry->pattern) + ".") +
                       (alternatives.empty() ? "" : did_you_mean(item.value, alternatives)));
    }
  }

  Section Parameters::section(const std::string &path) const
  {
    return Section(*this, path);
  }

  SourceLocation Parameters::location(const std::string &path) const
  {
    const Item *const item = setting(path);
    return item == nullptr ? SourceLocation() : item->location;
  }

  std::string Parameters::describe(const std::string &path) const
  {
    if (const Item *const item = setting(path))
      return prefix(*item) + (item->location.line == 0 ? ""
                                                       : ": entry " + in_quotes(item->path) +
                                                             " = " + in_quotes(item->value));
    const ParameterDeclaration *const declaration = declarations().find(path);
    if (declaration != nullptr && !declaration->is_section)
      return main_file + ": entry " + in_quotes(path) + " = " +
             in_quotes(declaration->default_value) + " (its default)";
    for (std::string section = path; !section.empty(); section = parent_path(section))
      if (const auto *const found = scanner.section(section))
        return to_string(*found) + ": section " + in_quotes(path);
    return path.empty() ? main_file : main_file + ": section " + in_quotes(path);
  }

  void Parameters::fail(const std::string &path, const std::string &message) const
  {
    throw InputError(describe(path) + ": " + message);
  }

  void Parameters::fail_missing(const ParameterDeclaration &entry) const
  {
    const std::string section = parent_path(entry.path);
    throw InputError(describe(section) + ": the entry " + in_quotes(entry.name) +
                     " is missing. It has no default: " + entry.documentation + " Allowed is " +
                     describe_pattern(entry.pattern) + ". Add \"set " + entry.name +
                     " = ...\" to " + section_in_words(section) + ".");
  }

  void Parameters::refuse_unused() const
  {
    const Item *first = nullptr;
    unsigned int n_unused = 0;
    const auto look_at = [&](const Item &item)
    {
      const bool is_read =
          used.count(item.path) > 0 ||
          std::any_of(aliases.begin(), aliases.end(),
                      [&](const auto &alias)
                      { return alias.second == item.path && used.count(alias.first) > 0; });
      if (!item.is_section && !is_read)
      {
        first = first == nullptr ? &item : first;
        ++n_unused;
      }
    };
    for (const auto &item : scanner.items())
      look_at(item);
    for (const auto &override : overrides)
      look_at(override.second);
    if (first == nullptr)
      return;
    throw InputError(prefix(*first) +
                     (first->location.line == 0
                          ? ""
                          : ": entry " + in_quotes(first->path) + " = " + in_quotes(first->value)) +
                     " has no effect here: " + reason_of_no_effect(first->path) +
                     " Remove it, or make it a comment." +
                     (n_unused == 1 ? ""
                                    : " (" + std::to_string(n_unused) +
                                          " entries have no effect; this is the first.)"));
  }

  std::vector<std::string> Parameters::renaming_notes() const
  {
    std::vector<std::string> notes;
    for (const auto &[path, former_path] : aliases)
      if (declarations().find(former_path)->is_deprecated)
        notes.push_back(prefix(*setting(former_path)) + ": entry " + in_quotes(former_path) +
                        " is now called " + in_quotes(last_name(path)) + ".");
    return notes;
  }

  std::string Parameters::reason_of_no_effect(const std::string &path) const
  {
    // The outermost section of which nothing was read, and the entry beside it that selects
    // another one.
    std::string outermost;
    for (std::string section = parent_path(path); !section.empty() && !is_used_below(section);
         section = parent_path(section))
      outermost = section;
    if (outermost.empty())
      return "nothing reads it with the other entries as they are.";
    const std::string name = last_name(outermost);
    for (const auto &sibling : declarations().find(parent_path(outermost))->children)
    {
      const auto alternatives = pattern_alternatives(sibling.pattern);
      if (std::find(alternatives.begin(), alternatives.end(), name) != alternatives.end())
        return "section " + in_quotes(outermost) + " is read only with " + in_quotes(sibling.path) +
               " = " + in_quotes(name) + ", but it is " + in_quotes(value(sibling.path)) +
               (setting(sibling.path) == nullptr ? " by default."
                                                 : " (" + prefix(*setting(sibling.path)) + ").");
    }
    return "nothing reads section " + in_quotes(outermost) + " with the other entries as they are.";
  }

  bool Parameters::is_used_below(const std::string &section) const
  {
    const auto first = used.lower_bound(section + "/");
    return first != used.end() && first->compare(0, section.size() + 1, section + "/") == 0;
  }

  const Parameters::Item *Parameters::setting(const std::string &path) const
  {
    const auto found = overrides.find(path);
    if (found != overrides.end())
      return &found->second;
    if (const Item *const item = scanner.entry(path))
      return item;
    const auto alias = aliases.find(path);
    return alias == aliases.end() ? nullptr : setting(alias->second);
  }

  const ParameterDeclaration &Parameters::declarations() const
  {
    if (!is_assigned)
      declaration_tree = collect_declarations(parameter_handler);
    return declaration_tree;
  }

  std::string Parameters::prefix(const Item &item) const
  {
    return item.location.line == 0 ? "--set " + in_quotes(item.path + " = " + item.value)
                                   : to_string(item.location);
  }

  std::string Parameters::value(const std::string &path) const
  {
    const std::string section = parent_path(path);
    return parameter_handler.get(Utilities::split_string_list(section, std::string("/")),
                                 last_name(path));
  }

  void Parameters::print(std::ostream &out, const std::string &format,
                         const bool with_documentation) const
  {
    const ParameterPrinter printer(
        declarations(), used.empty(),
        [&](const std::string &path) { return setting(path) != nullptr || used.count(path) > 0; },
        [&](const std::string &path) { return value(path); });
    if (format == "prm")
      printer.print_prm(out, with_documentation);
    else if (format == "json")
      printer.print_json(out);
    else if (format == "xml")
      parameter_handler.print_parameters(
          out,
          ParameterHandler::OutputStyle(
              ParameterHandler::XML | ParameterHandler::KeepDeclarationOrder |
              (with_documentation ? ParameterHandler::DefaultStyle : ParameterHandler::Short)));
    else if (format == "markdown")
      print_parameter_page(out, declarations());
    else
      throw InputError("The format " + in_quotes(format) +
                       " of parameters is unknown; known are \"prm\", \"json\", \"xml\" and "
                       "\"markdown\".");
  }

  const std::string &Parameters::file_name() const
  {
    return main_file;
  }

  std::string Parameters::original_text() const
  {
    return scanner.text();
  }
} // namespace tombolo
