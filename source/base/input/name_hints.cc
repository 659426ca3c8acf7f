// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/name_hints.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/parameter_scanner.h>
#include <tombolo/base/input/registry.h>

#include <deal.II/base/utilities.h>

#include <boost/algorithm/string/predicate.hpp>

#include <utility>

namespace tombolo
{
  namespace
  {
    struct RemovedEntry
    {
      const char *path;  ///< its last names
      const char *value; ///< the one that was removed; empty: the entry with all of them
      const char *instead;
    };

    constexpr const char *cell_averages = "Take `Shape functions = cell averages`.";
    constexpr const char *no_estimator =
        "Leave it out: the limit is that of the spectrum, which is a bound.";

    constexpr RemovedEntry removed_entries[] = {
        {"Heat/explicit/Estimator", "", no_estimator},
        {"Time step/Estimator", "", no_estimator},
        {"Time step/Integrator", "", "Leave it out: steps are central differences."},
        {"hexahedron/Hourglass", "", "Take `Hourglass stiffness`."},
        {"hexahedron/Hourglass viscosity", "", "Take `Hourglass stiffness`."},
        {"momentum consistent particle/Gradient", "",
         "Take `Shape functions`: `cell averages` pass the patch test, or `moving least squares`."},
        {"momentum consistent particle/Gradient tolerance", "", cell_averages},
        {"momentum consistent particle/Pair residual", "", cell_averages},
        {"momentum consistent particle/Pair residual limit", "", cell_averages},
        {"smoothed cells/Basis", "", "Leave it out: functions are those of largest entropy."},
        {"smoothed cells/Integration", "Gauss", "Take `smoothed`, which passes the patch test."},
        {"smoothed cells/Refill volume ratio", "",
         "Leave it out: a fifth of the volume at the last refill is the limit."}};

    /** What to take instead of the entry at @p path, or of its @p value, where that was removed
     * from the program and files of earlier versions may have it; empty where it was not. */
    std::string instead_of_removed(const std::string &path, const std::string &value = "")
    {
      for (const RemovedEntry &removed : removed_entries)
        if (value == removed.value && boost::ends_with("/" + path, std::string("/") + removed.path))
          return removed.instead;
      return {};
    }

    /** The paths of all entries of a name. */
    void find_entries(const ParameterDeclaration &section, const std::string &name,
                      std::vector<std::string> &paths)
    {
      for (const auto &child : section.children)
        if (child.is_section)
          find_entries(child, name, paths);
        else if (child.name == name)
          paths.push_back(child.path);
    }

    /** Which plug-in library of the project has a section, or an entry with a value ("Entry =
     * value"), as a sentence; empty if none has. */
    std::string library_hint(const std::string &what)
    {
      for (const auto &[name, library] :
           {std::pair{"Lattice filter", "liblattice_filter.so"},
            std::pair{"Refill remap = interpolation", "libinterpolated_remap.so"}})
        if (what == name)
          return " " + in_quotes(what) +
                 " is in a plug-in: write \"set Plugin libraries = " + library + "\".";
      return {};
    }

    /** Which script reads the files that have an entry, as a sentence; empty if none does. */
    std::string script_hint(const std::string &name)
    {
      for (const auto &[entry, script] :
           {std::pair{"Base file", "study"}, std::pair{"Groups", "reflection_study"}})
        if (name == entry)
          return std::string(" Files with it are studies: run scripts/") + script + " FILE.prm.";
      return {};
    }
  } // namespace

  std::string did_you_mean(const std::string &name, const std::vector<std::string> &candidates)
  {
    const std::string nearest = nearest_name(name, candidates);
    return nearest.empty() ? "" : " Did you mean " + in_quotes(nearest) + "?";
  }

  std::string nearest_section(const std::string &name, const ParameterDeclaration &parent)
  {
    const auto names = parent.section_names();
    for (const std::string &candidate : names)
      if (const std::size_t colon = candidate.find(": ");
          colon != std::string::npos && candidate.substr(colon + 2) == name)
        return candidate;
    return nearest_name(name, names);
  }

  std::string entry_hints(const ParameterDeclaration &root, const ParameterDeclaration &section,
                          const std::string &name)
  {
    const std::string instead = instead_of_removed(joined_path(section.path, name));
    if (!instead.empty())
      return " It was removed. " + instead;
    if (const std::string script = script_hint(name); section.path.empty() && !script.empty())
      return script;
    const auto *const same_name = section.find(name);
    if (same_name != nullptr && same_name->is_section)
      return " " + in_quotes(name) + " is a section: write \"subsection " + name + "\".";
    const auto names = section.entry_names();
    std::string hints = did_you_mean(name, names);
    if (hints.empty())
    {
      std::vector<std::string> elsewhere;
      find_entries(root, name, elsewhere);
      if (!elsewhere.empty() && elsewhere.size() <= 5)
        hints = " There is an entry of this name elsewhere: " + in_quotes(elsewhere) + ".";
    }
    const std::string where =
        section.path.empty() ? "outside of all sections" : "of section " + in_quotes(section.path);
    if (names.empty())
      hints += " There are no entries " + where + ".";
    else
      hints += " Known entries " + where + ": " + in_quotes(names) + ".";
    const auto sections = section.section_names();
    if (names.empty() && !sections.empty())
      hints += " Its subsections: " + in_quotes(sections) + ".";
    return hints;
  }

  std::string list_of_sections(const std::string &kind)
  {
    const bool ends_with_hiss = boost::ends_with(kind, "s") || boost::ends_with(kind, "sh");
    return kind + (ends_with_hiss ? "es" : "s");
  }

  std::string section_hints(const ParameterDeclaration &parent, const std::string &name)
  {
    const auto *const same_name = parent.find(name);
    if (same_name != nullptr)
      return " " + in_quotes(name) + " is an entry: write \"set " + name + " = ...\".";
    if (const std::string library = library_hint(name); !library.empty())
      return library;
    const std::string nearest = nearest_section(name, parent);
    std::string hints = nearest.empty() ? "" : " Did you mean " + in_quotes(nearest) + "?";
    const std::size_t colon = name.find(':');
    if (colon != std::string::npos && colon > 0)
    {
      const std::string list = list_of_sections(name.substr(0, colon));
      if (parent.find(list) != nullptr)
        hints += " The section needs its name, " +
                 in_quotes(Utilities::trim(name.substr(colon + 1))) + ", in the list " +
                 in_quotes(joined_path(parent.path, list)) + ".";
    }
    const auto names = parent.section_names();
    const std::string where =
        parent.path.empty() ? "sections" : "subsections of " + in_quotes(parent.path);
    if (names.empty())
      return hints + " There are no " + where + ".";
    return hints + " Known " + where + ": " + in_quotes(names) + ".";
  }

  std::string value_hints(const ParameterDeclaration &entry, const std::string &value)
  {
    const std::string instead = instead_of_removed(entry.path, value);
    if (!instead.empty())
      return " This value was removed. " + instead;
    const auto alternatives = pattern_alternatives(entry.pattern);
    return (alternatives.empty() ? "" : did_you_mean(value, alternatives)) +
           library_hint(entry.name + " = " + value);
  }

  const ParameterDeclaration &find_section(const ParameterDeclaration &root,
                                           const std::string &path)
  {
    const ParameterDeclaration *section = &root;
    for (const std::string &part : Utilities::split_string_list(path, std::string("/")))
    {
      const std::string name = Utilities::trim(part);
      const ParameterDeclaration *next = section->find(name);
      for (const auto &child : section->children)
        if (next == nullptr && child.is_section && child.name.rfind(name + ":", 0) == 0)
          next = &child;
      if (next == nullptr || !next->is_section)
        throw InputError("There is no section " + in_quotes(joined_path(section->path, name)) +
                         " to print." + section_hints(*section, name));
      section = next;
    }
    return *section;
  }
} // namespace tombolo
