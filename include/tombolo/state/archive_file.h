// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>

#include <mpi.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tombolo
{
  /** A checkpoint file that differs from what was written: truncated, or with changed bits. */
  class DamagedCheckpoint : public InputError
  {
  public:
    using InputError::InputError;
  };

  /**
   * The HDF5 file of a checkpoint, to be written or to be read: tables of numbers by path, with
   * rows and columns. Rank 0 writes what the ranks send it; all ranks read. Every table carries a
   * checksum that does not depend on its distribution. All functions are collective, but for those
   * that only query; tables hold double, std::uint64_t or char.
   */
  class ArchiveFile
  {
  public:
    enum class Mode
    {
      write,
      read
    };

    /** Creates or opens a file. Throws RunError where it cannot be created and DamagedCheckpoint
     * where it cannot be read. */
    ArchiveFile(const std::string &name, Mode mode, MPI_Comm communicator);
    ~ArchiveFile();
    ArchiveFile(const ArchiveFile &) = delete;
    ArchiveFile &operator=(const ArchiveFile &) = delete;

    /** Ends writing, with all bits on the disk. Throws RunError where something could not be
     * written. */
    void close();

    bool is_reading() const
    {
      return mode == Mode::read;
    }

    MPI_Comm communicator() const
    {
      return mpi_communicator;
    }

    const std::string &name() const
    {
      return file_name;
    }

    /** Whether there is a table or a group of this path; true when writing. */
    bool has(const std::string &path) const;

    /** Rows and columns of a table. Throws InputError where there is none. */
    std::array<std::uint64_t, 2> extent(const std::string &path) const;

    /** Writes a table of @p n_rows, of which @p values are those of this rank, from @p first_row
     * on. Groups on the way are made. Failures are reported by close(). */
    template <typename Value>
    void write(const std::string &path, const std::vector<Value> &values, std::uint64_t n_rows,
               std::uint64_t n_columns, std::uint64_t first_row);

    /** Rows of a table that has them, each rank its own. Throws InputError. */
    template <typename Value>
    std::vector<Value> read(const std::string &path, std::uint64_t first_row, std::uint64_t n_rows,
                            std::uint64_t n_columns) const;

    /** Reads all tables of a file and compares their checksums. Throws a DamagedCheckpoint that
     * names the first which is wrong. */
    static void verify(const std::string &name, MPI_Comm communicator);

    /** Throws an InputError that begins with the name of the file. */
    [[noreturn]] void fail(const std::string &message) const;

    /** The same on all ranks where one has a message. */
    void throw_on_all_ranks(const std::string &message) const;

    /** Fails if a table does not have @p expected values. */
    void check_size(const std::string &path, std::size_t given, std::size_t expected) const;

  private:
    std::string file_name;
    Mode mode;
    MPI_Comm mpi_communicator;
    std::int64_t handle = -1; // hid_t, whose header is left to the source
    std::string write_failure;
  };
} // namespace tombolo
