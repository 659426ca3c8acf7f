// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/output_directory.h>

#include <cstdint>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * A table in `histories.h5`, the file of HDF5 with all tables of a run: a dataset with the name
   * of the table, of rows times columns in double precision, whose attributes `columns` and `units`
   * name the columns. A value that a row does not have is NaN. Rank 0 writes.
   *
   * Between two calls the file is closed, and it is whole at any time, so that a run that is killed
   * loses nothing that was written before: rows are added in the mode of HDF5 for a single writer
   * and many readers, which orders what it writes, and all other changes are made to a copy that
   * replaces the file.
   */
  class Hdf5Table
  {
  public:
    struct Column
    {
      std::string name, unit;
    };

    static const char *const file_name; ///< "histories.h5"

    explicit Hdf5Table(const std::string &name) : name(name) {}

    /** Begins a new table, or goes on after its first @p first_rows rows where these are not
     * zero. Throws RunError on every rank where they are not there or the file cannot be written.
     * Collective. */
    void begin(const OutputDirectory &directory, const std::vector<Column> &columns,
               std::uint64_t first_rows);

    /** Adds rows, one after the other, whose values are those of rank 0. Throws RunError on every
     * rank where they cannot be written. Collective. */
    void append(const OutputDirectory &directory, const std::vector<double> &values);

    std::uint64_t n_rows() const
    {
      return n_written;
    }

  private:
    std::string name;
    std::uint64_t n_columns = 0, n_written = 0;
  };
} // namespace tombolo
