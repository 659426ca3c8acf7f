// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/parameter_scanner.h>
#include <tombolo/base/log.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/base/output_directory.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <boost/algorithm/string/predicate.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * When checkpoints are written, and their files: `checkpoint/step_NNNNNNNNNNNN.h5` in the output
   * directory. One is written under another name, put on the disk, read again and compared with its
   * checksums, then renamed; only after that the oldest are removed. The last complete one
   * therefore survives wherever the run is killed. The state at the end of a run, from which other
   * runs can start, is `checkpoint/end.h5`.
   */
  class Checkpoints
  {
  public:
    /** Reads section "Checkpoint". */
    explicit Checkpoints(const Entries &e)
    {
      step_interval = e.integer("Step interval", "0", between(0, 1000000000),
                                "A checkpoint is written every so many steps; 0 is not by steps.");
      wall_interval = e.number(
          "Wall time interval", "1800", at_least(0.), "seconds",
          "A checkpoint is written when this time has passed since the last one; 0 is not by time. "
          "Whatever the intervals are, one is written where a signal ends the run. At its end "
          "there "
          "is one where `Step interval` is set, or where the run has written one before.");
      keep = e.integer("Keep", "2", between(1, 1000000),
                       "So many of the newest checkpoints are kept.");
      keeps_end_state =
          e.flag("End state", "false",
                 "Whether the state at the end of the run is kept in `checkpoint/end.h5`, for runs "
                 "that start from it (entry `Initial state`).");
    }

    /** Whether the number of steps asks for one, or the end of the run where it would have asked or
     * one was written before. The same on all ranks. */
    bool is_due(const unsigned long step, const bool is_end) const
    {
      return (step_interval > 0 && (is_end || step % step_interval == 0)) ||
             (is_end && !newest.empty());
    }

    /** Whether the time that has passed since the last one asks for one, on this rank's clock. */
    bool is_due_by_wall_time() const
    {
      return wall_interval > 0 &&
             std::chrono::duration<double>(std::chrono::steady_clock::now() - last).count() >=
                 wall_interval;
    }

    /** Writes one with what @p serialize puts into it. Throws RunError where it cannot be written
     * or not be read again. Collective. */
    void write(const OutputDirectory &directory, const unsigned long step,
               const std::function<void(StateArchive &)> &serialize)
    {
      const MPI_Comm communicator = directory.communicator();
      const std::string path = directory.file(subdirectory);
      const std::string file = path + "/step_" + Utilities::to_string(step, 12) + ".h5";
      write_file(directory, file, serialize);
      change_files(communicator, "An old checkpoint cannot be removed: ",
                   [&]
                   {
                     auto files = files_in(path);
                     for (; files.size() > keep; files.erase(files.begin()))
                       if (files.begin()->second != file)
                         std::filesystem::remove(files.begin()->second);
                   });
      newest = file;
      last = std::chrono::steady_clock::now();
    }

    /** Whether the scene keeps the state at its end. */
    bool keep_end_state() const
    {
      return keeps_end_state;
    }

    /** Writes that state with what @p serialize puts into it. Throws likewise. Collective. */
    void write_end_state(const OutputDirectory &directory,
                         const std::function<void(StateArchive &)> &serialize) const
    {
      write_file(directory, directory.file(subdirectory) + "/" + end_file, serialize);
    }

    /** The file written last, relative to the working directory; empty if none was. */
    const std::string &last_file() const
    {
      return newest;
    }

    /** The checkpoint to resume from: @p wanted, a file or a directory of checkpoints, or where it
     * is empty the newest whole one of the output directory. Warns of damaged ones that are passed
     * over. Throws InputError where there is none, or where the one that was named is damaged.
     * Collective. */
    static std::string find(const std::string &wanted, const std::string &output_directory,
                            Log &log, MPI_Comm communicator)
    {
      const std::string directory =
          wanted.empty() ? (std::filesystem::path(output_directory) / subdirectory).string()
                         : wanted;
      const auto is_directory = [&]
      {
        std::error_code code;
        return wanted.empty() || std::filesystem::is_directory(directory, code);
      };
      const auto newest_first = [&]
      {
        std::vector<std::string> files;
        for (const auto &[step, file] : files_in(directory))
          files.insert(files.begin(), file);
        return files;
      };
      if (!from_first_rank(communicator, is_directory))
      {
        StateArchive::verify(wanted, communicator);
        return wanted;
      }
      const std::vector<std::string> candidates = from_first_rank(communicator, newest_first);
      for (const std::string &candidate : candidates)
      {
        try
        {
          StateArchive::verify(candidate, communicator);
          return candidate;
        }
        catch (const DamagedCheckpoint &error)
        {
          log.warn(std::string(error.what()) + " The one before it is tried.");
        }
      }
      throw InputError(
          "--resume: there is no " + std::string(candidates.empty() ? "" : "whole ") +
          "checkpoint in " + directory +
          ". Runs write them where a signal ends them, after each `Wall time interval` of "
          "section \"Checkpoint\", and where it sets a `Step interval`. Run without --resume to "
          "start anew, or name a file with "
          "--resume=FILE.");
    }

    /** The state that another run left, for one that starts from it: @p wanted is a file, or a
     * directory of checkpoints with the state at the end of a run, or without it the newest
     * checkpoint there. Throws InputError about the entry @p entry of @p section where there is
     * none, or where it is damaged. Collective. */
    static std::string find_state(const Section &section, const std::string &entry,
                                  const MPI_Comm communicator)
    {
      const std::string wanted = section.get(entry);
      const auto find_file = [&]
      {
        std::error_code code;
        const bool is_directory = std::filesystem::is_directory(wanted, code);
        std::string file =
            is_directory ? (std::filesystem::path(wanted) / end_file).string() : wanted;
        if (const auto files = files_in(wanted);
            !files.empty() && !std::filesystem::exists(file, code))
          file = files.rbegin()->second;
        const std::string problem =
            std::filesystem::exists(file, code) ? ""
            : is_directory
                ? "there is no checkpoint in this directory. A run leaves the state at its "
                  "end there where its section \"Checkpoint\" sets `End state = true`."
                : "there is no such file or directory. A run leaves the state at its end in "
                  "`checkpoint` of its output directory where its section \"Checkpoint\" "
                  "sets `End state = true`.";
        return std::vector<std::string>{file, problem};
      };
      const std::vector<std::string> found = from_first_rank(communicator, find_file);
      if (!found[1].empty())
        section.fail(entry, found[1]);
      StateArchive::verify(found[0], communicator);
      return found[0];
    }

    /** Removes the checkpoints of steps after @p step and what is left of an unfinished one, when a
     * run is resumed. Collective. */
    static void remove_later(const OutputDirectory &directory, const unsigned long step)
    {
      change_files(directory.communicator(), "Cannot remove checkpoints after the resumed one: ",
                   [&]
                   {
                     const std::string path = directory.file(subdirectory);
                     for (const auto &[its_step, file] : files_in(path))
                       if (its_step > step)
                         std::filesystem::remove(file);
                     std::error_code code;
                     for (const auto &entry : std::filesystem::directory_iterator(path, code))
                       if (entry.path().extension() == ".tmp")
                         std::filesystem::remove(entry.path());
                   });
    }

  private:
    static constexpr const char *subdirectory = "checkpoint";

    static constexpr const char *end_file = "end.h5";

    /** The whole checkpoints of a directory by step, on rank 0; unfinished ones have another name.
     */
    static std::map<unsigned long, std::string> files_in(const std::string &directory)
    {
      std::map<unsigned long, std::string> result;
      const std::regex pattern("step_([0-9]+)\\.h5");
      std::error_code code;
      std::smatch match;
      for (const auto &entry : std::filesystem::directory_iterator(directory, code))
      {
        const std::string name = entry.path().filename().string();
        if (std::regex_match(name, match, pattern))
          result[std::stoul(match[1])] = entry.path().string();
      }
      return result;
    }

    /** Does something to files on the first rank. Throws RunError on all. Collective. */
    static void change_files(const MPI_Comm communicator, const std::string &failure,
                             const std::function<void()> &change)
    {
      std::string error;
      if (Utilities::MPI::this_mpi_process(communicator) == 0)
        try
        {
          change();
        }
        catch (const std::filesystem::filesystem_error &exception)
        {
          error = failure + exception.what();
        }
      throw_on_all_ranks<RunError>(error, communicator);
    }

    /** A rename is on the disk when its directory is. */
    static void synchronize_directory(const std::string &directory)
    {
      const int descriptor = open(directory.c_str(), O_RDONLY | O_DIRECTORY);
      if (descriptor < 0)
        return;
      fsync(descriptor);
      close(descriptor);
    }

    /** Writes a file under another name, verifies it, and renames it. Throws RunError. Collective.
     */
    static void write_file(const OutputDirectory &directory, const std::string &file,
                           const std::function<void(StateArchive &)> &serialize)
    {
      const MPI_Comm communicator = directory.communicator();
      directory.create_subdirectory(subdirectory);
      const std::string temporary = file + ".tmp";
      const bool is_first = Utilities::MPI::this_mpi_process(communicator) == 0;
      const auto remove = [&]
      {
        std::error_code ignored;
        if (is_first)
          std::filesystem::remove(temporary, ignored);
      };
      try
      {
        {
          StateArchive archive(temporary, StateArchive::Mode::write, communicator);
          serialize(archive);
          archive.close();
        }
        StateArchive::verify(temporary, communicator);
      }
      catch (const DamagedCheckpoint &error)
      {
        remove();
        throw RunError(std::string(error.what()) + " It was just written: is the disk sound?");
      }
      catch (const std::exception &)
      {
        remove();
        throw;
      }
      change_files(communicator, "A checkpoint cannot take its place: ",
                   [&]
                   {
                     std::filesystem::rename(temporary, file);
                     synchronize_directory(directory.file(subdirectory));
                   });
    }

    unsigned int step_interval;
    double wall_interval;
    unsigned int keep;
    bool keeps_end_state;
    std::string newest;
    std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();
  };

  /** Every entry that @p parameters use, as text in a checkpoint. */
  inline std::string text_of_entries(const Parameters &parameters)
  {
    std::ostringstream text;
    parameters.print(text, "prm", false);
    return text.str();
  }

  inline std::map<std::string, std::string> entries_of(const std::string &text,
                                                       MPI_Comm communicator)
  {
    Mistakes mistakes;
    ParameterScanner scanner(communicator, mistakes);
    scanner.read_text(text, "checkpoint");
    std::map<std::string, std::string> result;
    for (const ParameterScanner::Item &item : scanner.items())
      if (!item.is_section)
        result[item.path] = item.value;
    return result;
  }

  /** What a state hangs on: the mesh, and which of its cells are what. */
  inline bool describes_parts(const std::string &path)
  {
    if (path.rfind("Mesh/Adaptive refinement/", 0) == 0)
      return false; // the state says which cells are divided
    return path == "Dimension" || path == "Parts" || path.rfind("Mesh", 0) == 0 ||
           (path.rfind("Part: ", 0) == 0 &&
            (boost::ends_with(path, "/Cells") || boost::ends_with(path, "/Formulation")));
  }

  /** What changes neither the model nor what was computed so far. */
  inline bool may_change(const std::string &path)
  {
    if (path == "Output/probes/Locations") // columns of a table that goes on
      return false;
    for (const char *const entry :
         {"End time", "Title", "Output directory", "Plugin libraries", "Time step/Safety factor",
          "Time step/Maximum", "Time step/Fixed", "Time step/Check interval",
          "Time step/Look interval", "Time step/Re-estimation threshold",
          "Time step/Change that matters"})
      if (path == entry)
        return true;
    for (const char *const section : {"Output/", "Checkpoint/", "Exact solution/", "Unit labels/"})
      if (path.rfind(section, 0) == 0)
        return true;
    return false;
  }

  /** Refuses entries that @p counts and that are other ones than in the text @p earlier. */
  inline void refuse_entries(const Parameters &parameters, const std::string &earlier,
                             const MPI_Comm communicator,
                             const std::function<bool(const std::string &)> &counts,
                             const std::string &had, const std::string &before_missing,
                             const std::string &after_missing, const std::string &advice)
  {
    const auto before = entries_of(earlier, communicator);
    const auto now = entries_of(text_of_entries(parameters), communicator);
    for (const auto &[path, value] : now)
      if (const auto found = before.find(path);
          counts(path) && (found == before.end() || found->second != value))
        parameters.fail(
            path, had +
                      (found == before.end() ? "no such entry." : in_quotes(found->second) + ".") +
                      advice);
    for (const auto &[path, value] : before)
      if (counts(path) && now.count(path) == 0)
        throw InputError(parameters.file_name() + ": " + before_missing + in_quotes(path) + " = " +
                         in_quotes(value) + after_missing + advice);
  }

  /** Throws an InputError that names the first entry with another value than in @p earlier
   * (text_of_entries() of the run that wrote @p file), except those that a resumed run may change.
   */
  inline void refuse_changed_entries(const Parameters &parameters, const std::string &earlier,
                                     const std::string &file, MPI_Comm communicator)
  {
    refuse_entries(
        parameters, earlier, communicator, [](const auto &path) { return !may_change(path); },
        "the checkpoint " + file + " was written with ", "the entry ",
        " of the run that wrote the checkpoint " + file + " is missing or not in use here.",
        " A resumed run may change `End time`, the output, the checkpoints and the "
        "safety factor of the time step, nothing of the model: set it back, or start "
        "anew without --resume.");
  }

  /** The same of the entries that say what the mesh and its parts are, for a run that starts from
   * the state of another. */
  inline void refuse_other_parts(const Parameters &parameters, const std::string &earlier,
                                 const std::string &file, MPI_Comm communicator)
  {
    refuse_entries(parameters, earlier, communicator, &describes_parts,
                   "the run that wrote the state " + file + " had ",
                   "the run that wrote the state " + file + " had the entry ",
                   ", which is missing here.",
                   " A run starts from the state of another on the same mesh with the same parts; "
                   "materials, conditions, contacts and time integration may be other ones.");
  }
} // namespace tombolo
