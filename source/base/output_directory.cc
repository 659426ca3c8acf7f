// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/exceptions.h>

#include <tombolo/base/file_stream.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/base/output_directory.h>

#include <deal.II/base/mpi.h>

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <ostream>
#include <regex>
#include <system_error>

namespace tombolo
{
  namespace fs = std::filesystem;

  std::string what_prevents_directory(const std::string &path)
  {
    if (path.empty())
      return "the name is empty; give a path that can be written.";
    std::error_code code;
    fs::path existing = fs::absolute(path, code).lexically_normal();
    if (!existing.has_filename()) // a slash at the end
      existing = existing.parent_path();
    bool is_parent = false;
    // On the way up: below a file nothing exists either.
    while (!fs::exists(existing, code) && existing.has_relative_path())
    {
      existing = existing.parent_path();
      is_parent = true;
    }
    if (!fs::is_directory(existing, code))
      return is_parent ? "\"" + existing.string() +
                             "\" is a file, so that there can be no directory in it; name a path "
                             "whose parents exist or can be made."
                       : "this is a file, not a directory; name another path, or move the file "
                         "away.";
    if (access(existing.c_str(), W_OK | X_OK) != 0)
      return "the directory \"" + existing.string() + "\" cannot be written (" +
             std::strerror(errno) + "); change its permissions or name another path.";
    return "";
  }

  namespace
  {
    /** Not a link to one. */
    bool is_file(const std::string &path)
    {
      std::error_code ignored;
      return fs::is_regular_file(fs::symlink_status(path, ignored));
    }

    bool is_directory(const std::string &path)
    {
      std::error_code ignored;
      return fs::is_directory(fs::symlink_status(path, ignored));
    }

    /** Writes a file beside its path and renames it. Returns what went wrong, or nothing. */
    std::string write_atomically(const std::string &path, const OutputDirectory::Writer &writer)
    {
      const std::string temporary = path + ".tmp";
      try
      {
        FileStream out(temporary, FileStream::Mode::create);
        if (!out)
          return "Cannot create " + temporary + ": " + out.close() + ".";
        writer(out);
        if (const std::string reason = out.close(); !reason.empty())
        {
          std::error_code ignored;
          fs::remove(temporary, ignored);
          return "Cannot write " + path + ": " + reason + ".";
        }
        fs::rename(temporary, path);
      }
      catch (const std::exception &exception)
      {
        std::error_code ignored;
        fs::remove(temporary, ignored);
        return "Cannot write " + path + ": " + exception.what();
      }
      return "";
    }

    /** Calls @p act on the first rank. Throws the RunError that it returns on all. Collective. */
    template <typename Act>
    void act_on_first_rank(const MPI_Comm communicator, const Act &act)
    {
      const std::string error = from_first_rank(communicator, act);
      if (!error.empty())
        throw RunError(error);
    }
  } // namespace

  OutputDirectory::OutputDirectory(const Section &section, const std::string &entry,
                                   const MPI_Comm communicator)
      : directory(section.get(entry)), mpi_communicator(communicator)
  {
    if (const std::string error = create(); !error.empty())
      section.fail(entry, error);
  }

  OutputDirectory::OutputDirectory(const std::string &path, const MPI_Comm communicator)
      : directory(path), mpi_communicator(communicator)
  {
    if (const std::string error = create(); !error.empty())
      throw InputError("Output directory \"" + path + "\": " + error);
  }

  std::string OutputDirectory::create() const
  {
    return from_first_rank(
        mpi_communicator,
        [&]
        {
          std::error_code code;
          std::string error = what_prevents_directory(directory);
          if (!error.empty())
            return error;
          fs::create_directories(directory, code);
          if (code)
            return "cannot create the directory (" + code.message() +
                   "); name a path whose parents exist or can be made.";
          const std::string probe = file(".write_test");
          if (!write_atomically(probe, [](std::ostream &out) { out << "\n"; }).empty())
            error = std::string("the directory cannot be written (") + std::strerror(errno) +
                    "); change its permissions or name another path.";
          fs::remove(probe, code);
          return error;
        });
  }

  std::string OutputDirectory::file(const std::string &name) const
  {
    return (fs::path(directory) / name).string();
  }

  void OutputDirectory::create_subdirectory(const std::string &name) const
  {
    act_on_first_rank(mpi_communicator,
                      [&]() -> std::string
                      {
                        std::error_code code;
                        const bool is_link = fs::is_symlink(file(name), code);
                        if (!is_link)
                          fs::create_directories(file(name), code);
                        if (!is_link && !code)
                          return "";
                        return "Cannot create the directory " + file(name) + ": " +
                               (is_link ? "a link has that name, and links are not followed"
                                        : code.message()) +
                               ".";
                      });
  }

  void OutputDirectory::write(const std::string &name, const Writer &writer) const
  {
    act_on_first_rank(mpi_communicator, [&] { return write_atomically(file(name), writer); });
  }

  void OutputDirectory::append(const std::string &name, const std::string &text) const
  {
    act_on_first_rank(mpi_communicator,
                      [&]
                      {
                        FileStream out(file(name), FileStream::Mode::append);
                        out << text;
                        const std::string reason = out.close();
                        return reason.empty() ? reason
                                              : "Cannot write " + file(name) + ": " + reason + ".";
                      });
  }

  std::uint64_t OutputDirectory::size(const std::string &name) const
  {
    return from_first_rank(mpi_communicator,
                           [&]
                           {
                             std::error_code code;
                             const std::uint64_t bytes =
                                 is_file(file(name)) ? fs::file_size(file(name), code) : 0;
                             return code ? 0 : bytes;
                           });
  }

  void OutputDirectory::truncate(const std::string &name, const std::uint64_t bytes) const
  {
    const std::uint64_t present = size(name);
    if (present < bytes)
      throw RunError(file(name) + " has " + std::to_string(present) + " bytes, fewer than the " +
                     std::to_string(bytes) + " at the checkpoint: it cannot be continued. Resume " +
                     "into another output directory.");
    act_on_first_rank(mpi_communicator,
                      [&]() -> std::string
                      {
                        std::error_code code;
                        fs::resize_file(file(name), bytes, code);
                        return code ? "Cannot shorten " + file(name) + ": " + code.message() + "."
                                    : "";
                      });
  }

  void OutputDirectory::write_pieces(const std::string &name, const Writer &writer) const
  {
    throw_on_all_ranks<RunError>(write_atomically(file(name), writer), mpi_communicator);
  }

  void OutputDirectory::write_parameters(const Parameters &parameters) const
  {
    write("original.prm", [&](std::ostream &out) { out << parameters.original_text(); });
    write("parameters.prm", [&](std::ostream &out) { parameters.print(out, "prm", false); });
    write("parameters.json", [&](std::ostream &out) { parameters.print(out, "json", false); });
  }

  void OutputDirectory::remove_summary() const
  {
    if (Utilities::MPI::this_mpi_process(mpi_communicator) == 0)
    {
      std::error_code ignored;
      fs::remove(file("summary.json"), ignored);
    }
  }

  void OutputDirectory::remove_earlier_results() const
  {
    const auto remove_files = [&](const std::string &subdirectory, const std::string &names)
    {
      const std::regex pattern(names);
      if (is_directory(file(subdirectory)))
        for (const auto &entry : fs::directory_iterator(file(subdirectory)))
          if (std::regex_match(entry.path().filename().string(), pattern))
            fs::remove(entry.path());
    };
    act_on_first_rank(
        mpi_communicator,
        [&]() -> std::string
        {
          try
          {
            // This scene may write fewer tables and series than the last one.
            for (const char *const name :
                 {"summary.json",     "solution.pvd",     "tools.pvd",      "cells.xdmf",
                  "cells.h5",         "particles.xdmf",   "particles.h5",   "tools.xdmf",
                  "tools.h5",         "statistics.csv",   "conditions.csv", "contact.csv",
                  "sections.csv",     "rigid_bodies.csv", "parts.csv",      "probes.csv",
                  "points.csv",       "links.csv",        "specimen.csv",   "histories.h5",
                  "histories.h5.tmp", "refinement.h5.tmp"})
              fs::remove(file(name));
            remove_files("checkpoint", "(step_[0-9]+|end)\\.h5(\\.tmp)?");
            remove_files("solution", "(cells|particles|tools)_[0-9]+(\\.[0-9]+)?\\.p?vtu(\\.tmp)?");
          }
          catch (const fs::filesystem_error &exception)
          {
            return std::string("Cannot remove the results of an earlier run: ") + exception.what();
          }
          return "";
        });
  }
} // namespace tombolo
