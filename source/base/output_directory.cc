// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/directory_check.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/file_stream.h>
#include <tombolo/base/output_directory.h>

#include <deal.II/base/mpi.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <ostream>
#include <regex>
#include <system_error>

namespace tombolo
{
  using namespace dealii;
  namespace fs = std::filesystem;

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

    /** Writes a file beside its place and renames it. Returns what went wrong, or nothing. */
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
  } // namespace

  OutputDirectory::OutputDirectory(const Section &section, const std::string &entry,
                                   const MPI_Comm communicator)
      : directory(section.get(entry)), mpi_communicator(communicator)
  {
    const std::string error = create();
    if (!error.empty())
      section.fail(entry, error);
  }

  OutputDirectory::OutputDirectory(const std::string &path, const MPI_Comm communicator)
      : directory(path), mpi_communicator(communicator)
  {
    const std::string error = create();
    if (!error.empty())
      throw InputError("Output directory \"" + path + "\": " + error);
  }

  std::string OutputDirectory::create() const
  {
    std::string error;
    if (Utilities::MPI::this_mpi_process(mpi_communicator) == 0)
    {
      std::error_code code;
      error = what_prevents_directory(directory);
      if (error.empty())
      {
        fs::create_directories(directory, code);
        if (code)
          error = "cannot create the directory (" + code.message() +
                  "); name a path whose parents exist or can be made.";
        else
        {
          const std::string probe = file(".write_test");
          if (!write_atomically(probe, [](std::ostream &out) { out << "\n"; }).empty())
            error = std::string("the directory cannot be written (") + std::strerror(errno) +
                    "); change its permissions or name another path.";
          fs::remove(probe, code);
        }
      }
    }
    return Utilities::MPI::broadcast(mpi_communicator, error, 0);
  }

  std::string OutputDirectory::file(const std::string &name) const
  {
    return (fs::path(directory) / name).string();
  }

  void OutputDirectory::create_subdirectory(const std::string &name) const
  {
    std::string error;
    if (Utilities::MPI::this_mpi_process(mpi_communicator) == 0)
    {
      std::error_code code;
      const bool is_link = fs::is_symlink(file(name), code);
      if (!is_link)
        fs::create_directories(file(name), code);
      if (is_link || code)
        error = "Cannot create the directory " + file(name) + ": " +
                (is_link ? "a link has that name, and links are not followed" : code.message()) +
                ".";
    }
    throw_on_all_ranks<RunError>(error, mpi_communicator);
  }

  void OutputDirectory::write(const std::string &name, const Writer &writer) const
  {
    std::string error;
    if (Utilities::MPI::this_mpi_process(mpi_communicator) == 0)
      error = write_atomically(file(name), writer);
    throw_on_all_ranks<RunError>(error, mpi_communicator);
  }

  void OutputDirectory::append(const std::string &name, const std::string &text) const
  {
    std::string error;
    if (Utilities::MPI::this_mpi_process(mpi_communicator) == 0)
    {
      FileStream out(file(name), FileStream::Mode::append);
      out << text;
      if (const std::string reason = out.close(); !reason.empty())
        error = "Cannot write " + file(name) + ": " + reason + ".";
    }
    throw_on_all_ranks<RunError>(error, mpi_communicator);
  }

  std::uint64_t OutputDirectory::size(const std::string &name) const
  {
    std::uint64_t bytes = 0;
    if (Utilities::MPI::this_mpi_process(mpi_communicator) == 0)
    {
      std::error_code code;
      if (is_file(file(name)))
        bytes = fs::file_size(file(name), code);
      if (code)
        bytes = 0;
    }
    return Utilities::MPI::broadcast(mpi_communicator, bytes, 0);
  }

  void OutputDirectory::truncate(const std::string &name, const std::uint64_t bytes) const
  {
    std::string error;
    const std::uint64_t present = size(name);
    if (present < bytes)
      error = file(name) + " has " + std::to_string(present) + " bytes, fewer than the " +
              std::to_string(bytes) + " at the checkpoint: it cannot be continued. Resume into " +
              "another output directory.";
    else if (Utilities::MPI::this_mpi_process(mpi_communicator) == 0)
    {
      std::error_code code;
      fs::resize_file(file(name), bytes, code);
      if (code)
        error = "Cannot shorten " + file(name) + ": " + code.message() + ".";
    }
    throw_on_all_ranks<RunError>(error, mpi_communicator);
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
    std::string error;
    if (Utilities::MPI::this_mpi_process(mpi_communicator) == 0)
    {
      try
      {
        fs::remove(file("summary.json"));
        // This scene may write fewer tables and series than the last one.
        for (const char *const name :
             {"solution.pvd", "tools.pvd", "cells.xdmf", "cells.h5", "particles.xdmf",
              "particles.h5", "tools.xdmf", "tools.h5", "statistics.csv", "conditions.csv",
              "contact.csv", "sections.csv", "rigid_bodies.csv", "parts.csv", "probes.csv",
              "specimen.csv"})
          fs::remove(file(name));
        const std::regex checkpoint_file("(step_[0-9]+|end)\\.h5(\\.tmp)?");
        if (is_directory(file("checkpoint")))
          for (const auto &entry : fs::directory_iterator(file("checkpoint")))
            if (std::regex_match(entry.path().filename().string(), checkpoint_file))
              fs::remove(entry.path());
        const std::regex solution_file(
            "(cells|particles|tools)_[0-9]+(\\.[0-9]+)?\\.p?vtu(\\.tmp)?");
        if (is_directory(file("solution")))
          for (const auto &entry : fs::directory_iterator(file("solution")))
            if (std::regex_match(entry.path().filename().string(), solution_file))
              fs::remove(entry.path());
      }
      catch (const fs::filesystem_error &exception)
      {
        error = std::string("Cannot remove the results of an earlier run: ") + exception.what();
      }
    }
    throw_on_all_ranks<RunError>(error, mpi_communicator);
  }
} // namespace tombolo
