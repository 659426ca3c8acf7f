// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameters.h>

#include <tombolo/base/input/choosing_entry.h>
#include <tombolo/base/input/empty_or.h>
#include <tombolo/base/input/name_hints.h>
#include <tombolo/base/input/registry.h>

#include <deal.II/base/utilities.h>

#include <algorithm>

namespace tombolo
{
  void Parameters::refuse(const std::string &path, const std::string &message) const
  {
    mistakes.mark_refused(path);
    mistakes.add(describe(path) + ": " + message);
  }

  void Parameters::read_file(const std::string &file_name)
  {
    if (main_file.empty())
      main_file = file_name;
    try
    {
      scanner.read_file(file_name);
    }
    catch (const InputError &error)
    {
      // What comes after it cannot be understood.
      mistakes.add(error.what());
      refuse_mistakes();
    }
  }

  void Parameters::read_text(const std::string &text, const std::string &name)
  {
    if (main_file.empty())
      main_file = name;
    scanner.read_text(text, name);
  }

  void Parameters::add_override(const std::string &assignment)
  {
    const Item item = read_override(assignment);
    const auto [other, is_new] = overrides.emplace(item.path, item);
    if (!is_new)
      throw InputError("--set " + in_quotes(assignment) + ": this entry is already set by " +
                       prefix(other->second) + ". Remove one of them.");
  }

  std::string Parameters::raw(const std::string &path, const std::string &fallback) const
  {
    used.insert(path);
    const Item *const item = setting(path);
    return item == nullptr ? fallback : item->value;
  }

  std::vector<std::string> Parameters::raw_list(const std::string &path) const
  {
    std::vector<std::string> names;
    for (const std::string &name : split_list(raw(path)))
      if (name.empty())
        refuse(path, "a name is missing before or after a comma.");
      else if (std::find(names.begin(), names.end(), name) != names.end())
        refuse(path, "the name " + in_quotes(name) + " stands twice.");
      else
        names.push_back(name);
    return names;
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
    const std::map<std::string, Item> given = overrides;
    for (const auto &[path, item] : given)
      if (const ParameterDeclaration *const entry = declarations().find(path);
          item.value.empty() && entry != nullptr && !entry->alias.empty())
        overrides.emplace(joined_path(parent_path(path), entry->alias), item);
    for (const auto &item : scanner.items())
      if (item.is_section)
        check_section(item.path, to_string(item.location), false);
      else
        assign_entry(item);
    for (const auto &[path, item] : given)
    {
      check_section(parent_path(path), prefix(item), true);
      assign_entry(item);
    }
  }

  void Parameters::check_section(const std::string &path, const std::string &prefix,
                                 const bool repeats) const
  {
    const ParameterDeclaration *parent = &declarations();
    const auto names = Utilities::split_string_list(path, std::string("/"));
    for (std::size_t i = 0; i < names.size(); ++i)
    {
      const std::string &name = names[i];
      const ParameterDeclaration *const section = parent->find(name);
      if (section != nullptr && section->is_section)
      {
        parent = section;
        continue;
      }
      if (i + 1 < names.size() && !repeats)
        return;
      const std::string list =
          joined_path(parent->path, list_of_sections(name.substr(0, name.find(':'))));
      const bool is_listed = declarations().find(list) != nullptr;
      if (!is_listed || !(mistakes.is_meant(list) || mistakes.is_refused(list)))
        mistakes.add(prefix + ": unknown section " + in_quotes(joined_path(parent->path, name)) +
                     "." + section_hints(*parent, name));
      if (is_listed && setting(list) == nullptr)
        mistakes.mark_meant(list);
      if (const std::string nearest = nearest_section(name, *parent); !nearest.empty())
        mistakes.mark_meant(joined_path(parent->path, nearest));
      return;
    }
  }

  void Parameters::assign_entry(const Item &item)
  {
    const ParameterDeclaration *const section = declarations().find(parent_path(item.path));
    if (section == nullptr || !section->is_section)
      return; // refused by check_section()
    const std::string name = last_name(item.path);
    const ParameterDeclaration *entry = section->find(name);
    if (entry == nullptr || entry->is_section)
    {
      mistakes.add(prefix(item) + ": unknown entry " + in_quotes(item.path) + "." +
                   entry_hints(declarations(), *section, name));
      if (const std::string nearest = nearest_name(name, section->entry_names()); !nearest.empty())
        mistakes.mark_meant(joined_path(section->path, nearest));
      return;
    }
    if (!entry->alias.empty())
      entry = section->find(entry->alias);
    if (is_reset(entry->path))
      return;
    // A scene in three dimensions can include one in two.
    const Item *const last = scanner.entry(item.path);
    if (item.location.line > 0 && last != nullptr && last != &item)
      return;
    if (entry->path != item.path)
    {
      if (const Item *const other = setting(entry->path);
          other != nullptr && other->path != item.path)
      {
        mistakes.add(prefix(item) + ": entry " + in_quotes(item.path) + " is another name of " +
                     in_quotes(entry->path) + ", which is set, too (" + prefix(*other) +
                     "). Remove one of them.");
        return;
      }
      aliases[entry->path] = item.path;
    }
    const bool is_missing = entry->is_mandatory && item.value.empty();
    if (set_value(parameter_handler, *entry, item.value) && !is_missing)
      return;
    mistakes.mark_refused(entry->path);
    mistakes.add(prefix_with_value(item) + ": " +
                 (is_missing && describe_pattern(entry->pattern) == "any text"
                      ? "the value is missing. It has no default: " + entry->documentation
                      : "allowed is " + describe_pattern(entry->pattern) + ".") +
                 value_hints(*entry, item.value));
  }

  std::string Parameters::prefix_with_value(const Item &item) const
  {
    return prefix(item) + (item.location.line == 0
                               ? ""
                               : ": entry " + in_quotes(item.path) + " = " + in_quotes(item.value));
  }

  bool Parameters::is_reset(const std::string &path) const
  {
    const auto found = overrides.find(path);
    return found != overrides.end() && found->second.value.empty();
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
      return prefix_with_value(*item);
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

  void Parameters::refuse_missing(const ParameterDeclaration &entry) const
  {
    const std::string section = parent_path(entry.path);
    mistakes.mark_refused(entry.path);
    mistakes.add(
        describe(section) + ": the entry " + in_quotes(entry.name) +
        " is missing. It has no default: " + entry.documentation + " Allowed is " +
        describe_pattern(entry.pattern) + ". Add \"set " + entry.name + " = ...\" to " +
        (section.empty() ? "the file outside of all sections" : "section " + in_quotes(section)) +
        ".");
  }

  std::string Parameters::read(const ParameterDeclaration &entry) const
  {
    used.insert(entry.path);
    const bool is_unset = setting(entry.path) == nullptr;
    if (!mistakes.are_collected())
    {
      if (is_unset && entry.is_mandatory)
        refuse_missing(entry);
      return value(entry.path);
    }
    const bool is_refused = mistakes.is_refused(entry.path);
    if (is_refused && !entry.is_mandatory && pattern_alternatives(entry.pattern).empty())
      return value(entry.path); // its default is a value as good as others
    const bool is_known = is_refused || mistakes.is_meant(entry.path);
    if (is_unset && entry.is_mandatory && !is_known)
      refuse_missing(entry);
    if (is_refused || (is_unset && (entry.is_mandatory || is_known)))
      return mistakes.stand_in(entry);
    return value(entry.path);
  }

  void Parameters::refuse_unused() const
  {
    used_in_check = used;
    std::vector<const Item *> unused;
    bool is_certain = false;
    const auto check_item = [&](const Item &item)
    {
      const bool is_read =
          used.count(item.path) > 0 ||
          std::any_of(aliases.begin(), aliases.end(),
                      [&](const auto &alias)
                      { return alias.second == item.path && used.count(alias.first) > 0; });
      if (!item.is_section && !is_read && !is_reset(item.path) && !mistakes.is_refused(item.path) &&
          declarations().find(item.path) != nullptr &&
          !reason_of_no_effect(item.path, is_certain).empty())
        unused.push_back(&item);
    };
    for (const auto &item : scanner.items())
      check_item(item);
    for (const auto &override : overrides)
      check_item(override.second);
    // After other mistakes much is not read; another choice is a reason all the same.
    const bool is_read_to_the_end = mistakes.empty();
    for (const Item *const item : unused)
    {
      is_certain = false;
      const std::string reason = reason_of_no_effect(item->path, is_certain);
      if (is_read_to_the_end || is_certain)
        mistakes.add(prefix_with_value(*item) + " has no effect here: " + reason +
                     " Remove it, or make it a comment." +
                     (unused.size() == 1 || mistakes.are_collected()
                          ? ""
                          : " (" + std::to_string(unused.size()) +
                                " entries have no effect; this is the first.)"));
    }
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

  std::string Parameters::reason_of_no_effect(const std::string &path, bool &is_certain) const
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
    const ParameterDeclaration *const entry =
        entry_that_chooses(name, *declarations().find(parent_path(outermost)));
    if (entry == nullptr)
      return "nothing reads section " + in_quotes(outermost) +
             " with the other entries as they are.";
    const Item *const choice = setting(entry->path);
    is_certain = value(entry->path) != name && !mistakes.is_refused(entry->path) &&
                 (!entry->is_mandatory || choice != nullptr);
    if (is_certain && choice != nullptr && choice->location.depth < setting(path)->location.depth)
      return "";
    return "section " + in_quotes(outermost) + " is read only with " + in_quotes(entry->path) +
           " = " + in_quotes(name) + ", but it is " + in_quotes(value(entry->path)) +
           (choice == nullptr ? " by default." : " (" + prefix(*choice) + ").");
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
      return found->second.value.empty() ? nullptr : &found->second;
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
                         const bool with_documentation, const std::string &section) const
  {
    const std::set<std::string> &used_entries = used_in_check.empty() ? used : used_in_check;
    const PrintedEntries entries{used_entries.empty() || main_file.empty(),
                                 [&](const std::string &path) {
                                   return setting(path) != nullptr || used_entries.count(path) > 0;
                                 },
                                 [&](const std::string &path) { return value(path); }};
    const ParameterDeclaration &printed = find_section(declarations(), section);
    if (format == "prm")
      print_prm(out, entries, printed, with_documentation);
    else if (format == "json")
      print_json(out, entries, printed);
    else if (format == "xml" && section.empty())
      parameter_handler.print_parameters(
          out,
          ParameterHandler::OutputStyle(
              ParameterHandler::XML | ParameterHandler::KeepDeclarationOrder |
              (with_documentation ? ParameterHandler::DefaultStyle : ParameterHandler::Short)));
    else if (format == "markdown")
      print_parameter_page(out, printed);
    else
      refuse_format(format);
  }
} // namespace tombolo
