// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>
#include <tombolo/base/input/name_hints.h>
#include <tombolo/base/input/parameter_scanner.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/on_ranks.h>

#include <deal.II/base/utilities.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * A chain of runs in one file: `set Stages = press, cool, release`, with a section "Stage: NAME"
   * each, whose entries and sections replace those outside of it. Each stage is a run of
   * its own, with its own clock and output directory (that of the file, then the name of the
   * stage), which starts from the state at the end of the one before. Sections of conditions,
   * materials and the like that a stage does not list, but another does, are no part of it.
   */
  class Stages
  {
  public:
    /** Reads the file. Throws InputError where stages and their sections do not fit. Collective. */
    Stages(const std::string &file, const MPI_Comm communicator)
        : file_name(file), communicator(communicator), scanner(communicator, mistakes)
    {
      scanner.read_file(file);
      const ParameterScanner::Item *const entry = scanner.entry("Stages");
      if (entry == nullptr)
        return;
      stage_names = split_list(entry->value);
      const auto refuse = [&](const SourceLocation &location, const std::string &message)
      { throw InputError(to_string(location) + ": " + message); };
      std::set<std::string> found_names;
      for (const std::string &name : stage_names)
      {
        if (name.empty() || name.find('/') != std::string::npos || name[0] == '.')
          refuse(entry->location, "entry \"Stages\" = " + in_quotes(entry->value) +
                                      ": allowed are names, separated by commas, that can be names "
                                      "of directories.");
        if (!found_names.insert(name).second)
          refuse(entry->location,
                 "entry \"Stages\": the name " + in_quotes(name) + " stands twice.");
        if (scanner.section(stage_prefix + name) == nullptr)
          refuse(entry->location, "entry \"Stages\" = " + in_quotes(entry->value) +
                                      ": the section " + in_quotes(stage_prefix + name) +
                                      " of the stage is missing.");
      }
      for (const ParameterScanner::Item &item : scanner.items())
      {
        if (!item.is_section || item.path.rfind(stage_prefix, 0) != 0 ||
            item.path.find('/') != std::string::npos)
          continue;
        const std::string name = item.path.substr(stage_prefix.size());
        if (found_names.count(name) == 0)
        {
          refuse(item.location,
                 "section " + in_quotes(item.path) +
                     " is of no stage; the entry \"Stages\" lists: " + joined(stage_names, ", ") +
                     "." + did_you_mean(name, stage_names));
        }
      }
    }

    const std::vector<std::string> &names() const
    {
      return stage_names;
    }

    /** The entries of a stage with @p overrides of the command line, not declared yet. Throws
     * InputError. */
    std::unique_ptr<Parameters> parameters(const std::size_t stage,
                                           const std::vector<std::string> &overrides) const
    {
      const std::string &name = stage_names[stage];
      auto result = std::make_unique<Parameters>(communicator);
      result->read_file(file_name);
      result->replace_items(items(name));
      std::set<std::string> overridden;
      for (const std::string &assignment : overrides)
      {
        // Others start from the end of the stage before.
        if (stage > 0 && path_of(assignment) == "Initial state")
          continue;
        overridden.insert(path_of(assignment));
        if (path_of(assignment) != "Output directory")
          result->add_override(assignment);
      }
      const auto set = [&](const std::string &entry, const std::string &value)
      {
        if (overridden.count(entry) == 0 &&
            scanner.entry(stage_prefix + name + "/" + entry) == nullptr)
          result->add_override(entry + " = " + value);
      };
      result->add_override("Output directory = " + output_directory(stage, overrides));
      set("Checkpoint/End state", "true");
      if (stage > 0)
        set("Initial state", output_directory(stage - 1, overrides) + "/checkpoint");
      return result;
    }

    /** Throws InputError where an override of the command line is one of stages. */
    static void refuse_stages(const std::string &assignment)
    {
      const std::string path = path_of(assignment);
      if (path == "Stages" || path.rfind(stage_prefix, 0) == 0)
        throw InputError("--set " + in_quotes(assignment) +
                         ": stages and what they set stand in the file; allowed are entries of all "
                         "stages.");
    }

    /** The output directory of a stage with these overrides. */
    std::string output_directory(const std::size_t stage,
                                 const std::vector<std::string> &overrides) const
    {
      const std::string entry = "Output directory", &name = stage_names[stage];
      const auto in_directory = [&](const std::string &directory)
      { return (directory.empty() ? "output" : directory) + "/" + name; };
      for (const std::string &assignment : overrides)
        if (path_of(assignment) == entry)
          return in_directory(Utilities::trim(assignment.substr(assignment.find('=') + 1)));
      const ParameterScanner::Item *const own = scanner.entry(stage_prefix + name + "/" + entry);
      return own != nullptr ? own->value : in_directory(value(name, entry));
    }

  private:
    static inline const std::string stage_prefix = "Stage: ";

    static std::string path_of(const std::string &assignment)
    {
      std::string path;
      for (const std::string &part : Utilities::split_string_list(
               assignment.substr(0, assignment.find('=')), std::string("/")))
        path = joined_path(path, Utilities::trim(part));
      return path;
    }

    /** The value of an entry outside of all sections, of a stage or of the file. */
    std::string value(const std::string &stage, const std::string &entry) const
    {
      const ParameterScanner::Item *item = scanner.entry(stage_prefix + stage + "/" + entry);
      if (item == nullptr)
        item = scanner.entry(entry);
      return item == nullptr ? "" : item->value;
    }

    /** Whether a section "KIND: NAME" is of other stages only. */
    bool is_in_other_stages(const std::string &stage, const std::string &section) const
    {
      const std::size_t colon = section.find(": ");
      if (colon == std::string::npos || colon == 0)
        return false;
      const std::string kind = section.substr(0, colon), name = section.substr(colon + 2);
      const std::string list = list_of_sections(kind);
      const auto lists_it = [&](const std::string &stage_name)
      {
        const std::vector<std::string> listed = split_list(value(stage_name, list));
        return std::find(listed.begin(), listed.end(), name) != listed.end();
      };
      return !lists_it(stage) && std::any_of(stage_names.begin(), stage_names.end(), lists_it);
    }

    /** Sections and entries of a stage: those of all stages, and after them its own. It is one run,
     * without `Stages`. */
    std::vector<ParameterScanner::Item> items(const std::string &stage) const
    {
      std::vector<ParameterScanner::Item> result, own;
      const std::string own_prefix = stage_prefix + stage + "/";
      for (ParameterScanner::Item item : scanner.items())
        if (item.path.rfind(own_prefix, 0) == 0)
        {
          item.path = item.path.substr(own_prefix.size());
          own.push_back(item);
        }
        else if (item.path != "Stages" && item.path.rfind(stage_prefix, 0) != 0 &&
                 !is_in_other_stages(stage, item.path.substr(0, item.path.find('/'))))
        {
          ++item.location.depth; // as if the stage included them: another choice leaves them alone
          result.push_back(item);
        }
      result.insert(result.end(), own.begin(), own.end());
      return result;
    }

    std::string file_name;
    MPI_Comm communicator;
    Mistakes mistakes; // collects none: each is thrown
    ParameterScanner scanner;
    std::vector<std::string> stage_names;
  };

  /** Whether this directory has checkpoints to resume from. Collective. */
  inline bool has_checkpoints(const std::string &output_directory, const MPI_Comm communicator)
  {
    return from_first_rank(
        communicator,
        [&]
        {
          std::error_code code;
          bool result = false;
          for (const auto &file :
               std::filesystem::directory_iterator(output_directory + "/checkpoint", code))
            result = result || (file.path().filename().string().rfind("step_", 0) == 0 &&
                                file.path().extension() == ".h5");
          return result;
        });
  }

  /** Whether the run in this directory came to its end. Collective. */
  inline bool has_finished(const std::string &output_directory, const MPI_Comm communicator)
  {
    return from_first_rank(communicator,
                           [&]
                           {
                             std::ifstream in(output_directory + "/summary.json");
                             const auto summary = nlohmann::json::parse(in, nullptr, false);
                             return summary.is_object() && summary.value("ended", "") == "finished";
                           });
  }
} // namespace tombolo
