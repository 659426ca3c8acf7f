// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>

namespace tombolo
{
  /** The reason why a directory cannot be made or written, as far as it can be found without
   * writing; empty where there is none. Checks the file system of this rank. */
  std::string what_prevents_directory(const std::string &path);

  /**
   * The directory of one run. Whole files are written beside their path and renamed to it, so
   * that a reader never finds half a file and a run that is killed never leaves one. The directory
   * itself may be reached through links; what is in it is not: no link, no pipe and no file of
   * somebody else is written through.
   */
  class OutputDirectory
  {
  public:
    using Writer = std::function<void(std::ostream &)>;

    /** Creates the directory that @p entry of @p section names, parents included, and proves by
     * writing a file that it can be written. Throws InputError about the entry where it cannot, or
     * where the path is a file. Collective. */
    OutputDirectory(const Section &section, const std::string &entry, MPI_Comm communicator);

    /** The same for a path; throws an InputError that names it. Collective. */
    OutputDirectory(const std::string &path, MPI_Comm communicator);

    /** The path as it was given. */
    const std::string &path() const
    {
      return directory;
    }

    /** The path of a file in this directory. */
    std::string file(const std::string &name) const;

    MPI_Comm communicator() const
    {
      return mpi_communicator;
    }

    /** Creates a directory in this one, on rank 0. Throws RunError. Collective. */
    void create_subdirectory(const std::string &name) const;

    /** Rank 0 writes a file; the others wait. Throws RunError on every rank where the file cannot
     * be written (a full disk). Collective. */
    void write(const std::string &name, const Writer &writer) const;

    /** Rank 0 adds text to the end of a file and closes it. Throws RunError on every rank where it
     * cannot. Collective. */
    void append(const std::string &name, const std::string &text) const;

    /** The size of a file in bytes, zero where there is none. Collective. */
    std::uint64_t size(const std::string &name) const;

    /** Cuts a file to its first @p size bytes, for a resumed run: what came after its checkpoint is
     * written again. Throws RunError on every rank where the file is shorter. Collective. */
    void truncate(const std::string &name, std::uint64_t size) const;

    /** Every rank writes a file of its own, whose name must differ from those of the others.
     * Throws RunError on every rank where one fails. Collective. */
    void write_pieces(const std::string &name, const Writer &writer) const;

    /** `original.prm` (the files as they were read), `parameters.prm` and `parameters.json` (every
     * value in use). Collective. */
    void write_parameters(const Parameters &parameters) const;

    /** Removes what an earlier run left and this one might not write again: the summary, the
     * tables, the solution files and the checkpoints. For runs that start anew. Collective. */
    void remove_earlier_results() const;

    /** Removes the summary alone: while a resumed run goes on, it is not complete. Collective. */
    void remove_summary() const;

  private:
    /** Empty, or what is wrong. */
    std::string create() const;

    std::string directory;
    MPI_Comm mpi_communicator;
  };
} // namespace tombolo
