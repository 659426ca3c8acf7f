// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/on_ranks.h>
#include <tombolo/simulation/results_owner.h>

#include <tombolo/base/json.h>
#include <tombolo/simulation/stages.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <system_error>
#include <unistd.h>

namespace tombolo
{
  namespace fs = std::filesystem;

  namespace
  {
    const char *const owner_file = "run.json";
    const char *const file_key = "parameter_file";
    const char *const title_key = "title";

    std::string full_path(const std::string &path)
    {
      std::error_code code;
      const fs::path result = fs::weakly_canonical(fs::absolute(path, code), code);
      return code ? path : result.string();
    }

    /** The text of a file; empty where it cannot be read. */
    std::string text_of(const fs::path &path)
    {
      std::error_code code;
      if (!fs::is_regular_file(path, code))
        return "";
      std::ifstream in(path, std::ios::binary);
      return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    }

    bool has_results(const fs::path &directory)
    {
      std::error_code code;
      const char *const names[] = {"original.prm", "summary.json", "statistics.csv",
                                   "solution.pvd", "checkpoint",   owner_file};
      return std::any_of(std::begin(names), std::end(names),
                         [&](const char *name) { return fs::exists(directory / name, code); });
    }

    /** The value of a key in run.json; empty where there is none. */
    std::string owner_entry(const fs::path &directory, const char *const key)
    {
      const Json document = Json::parse(text_of(directory / owner_file), nullptr, false);
      if (!document.is_object() || !document.contains(key) || !document[key].is_string())
        return "";
      return document[key].get<std::string>();
    }

    /** Why the results of a directory are not to be replaced; empty where they may be. */
    std::string what_owns_results(const Parameters &parameters, const fs::path &directory)
    {
      const std::string file = full_path(parameters.file_name());
      const std::string owner = owner_entry(directory, file_key);
      if (!has_results(directory) || owner == file ||
          text_of(directory / "original.prm") == parameters.original_text() ||
          fs::path(file).parent_path() == full_path(directory.string()))
        return "";
      const std::string title = owner_entry(directory, title_key);
      return "the directory has the results of another parameter file" +
             (owner.empty() ? "" : ", " + in_quotes(owner)) +
             (title.empty() ? "" : " (" + title + ")") +
             ". Name another directory, or replace them with --overwrite.";
    }
    /** A lock of a whole file. It belongs to the process, and ends with it. */
    struct flock whole_file()
    {
      struct flock lock = {};
      lock.l_type = F_WRLCK;
      lock.l_whence = SEEK_SET;
      return lock;
    }

    bool is_held_by_another(const fs::path &path)
    {
      const int file = open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
      if (file < 0)
        return false;
      struct flock lock = whole_file();
      const bool is_known = fcntl(file, F_GETLK, &lock) == 0;
      close(file);
      return is_known && lock.l_type != F_UNLCK;
    }
  } // namespace

  void refuse_running_run(const Parameters &parameters)
  {
    const std::string directory = parameters.section("").get("Output directory");
    if (from_first_rank(parameters.communicator(),
                        [&] { return is_held_by_another(fs::path(directory) / owner_file); }))
      parameters.fail("Output directory", "another run writes there now. Name another directory, "
                                          "or wait for its end.");
  }

  void hold_results(const OutputDirectory &directory)
  {
    if (Utilities::MPI::this_mpi_process(directory.communicator()) != 0)
      return;
    // Open until the process ends: closing the file would give up the lock.
    const int file = open(directory.file(owner_file).c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
    struct flock lock = whole_file();
    if (file >= 0)
      fcntl(file, F_SETLK, &lock);
  }

  void refuse_results_of_another_file(const Parameters &parameters)
  {
    const std::string directory = parameters.section("").get("Output directory");
    const std::string obstacle = from_first_rank(
        parameters.communicator(), [&] { return what_owns_results(parameters, directory); });
    if (!obstacle.empty())
      parameters.fail("Output directory", obstacle);
  }

  void refuse_unfinished_run(const Parameters &parameters)
  {
    const MPI_Comm communicator = parameters.communicator();
    const std::string directory = parameters.section("").get("Output directory");
    if (has_checkpoints(directory, communicator) && !has_finished(directory, communicator))
      parameters.fail("Output directory",
                      "a run that has not come to its end is there, with a checkpoint. Go on with "
                      "--resume, or start again with --overwrite, which removes its results.");
  }

  void write_owner_of_results(const Parameters &parameters, const OutputDirectory &directory)
  {
    Json document = Json::object();
    document[title_key] = parameters.section("").get("Title");
    document[file_key] = full_path(parameters.file_name());
    directory.write(owner_file, [&](std::ostream &out) { out << json_text(document); });
  }

  bool is_checkpoint_of(const std::string &checkpoint, const std::string &output_directory,
                        const MPI_Comm communicator)
  {
    const fs::path path = full_path(checkpoint);
    const fs::path own = full_path(output_directory);
    const bool is_own = checkpoint.empty() || path.parent_path().parent_path() == own ||
                        (path.parent_path() == own && path.filename() == "checkpoint");
    return Utilities::MPI::broadcast(communicator, is_own, 0);
  }
} // namespace tombolo
