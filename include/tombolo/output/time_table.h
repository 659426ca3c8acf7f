// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/output_directory.h>
#include <tombolo/output/unit_labels.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  class Entries;
  class Records;
  class Section;
  class StateArchive;

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

    /** Begins a new table, or goes on after its first @p first_rows rows, if not zero. Throws
     * RunError on every rank where these are not there or it cannot be written. Collective. */
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

  /** In which files the tables of a run are. */
  struct TableFormat
  {
    TableFormat() = default;

    /** Reads `Table format` of section Output. */
    explicit TableFormat(const Entries &e);

    /** The value of the entry. */
    std::string name() const
    {
      return !hdf5 ? "csv" : csv ? "csv and hdf5" : "hdf5";
    }

    bool csv = true, hdf5 = false;
  };

  /**
   * A table over time: a file of comma-separated values with a row per time and a header that names
   * columns and units, or a Hdf5Table, or both. The present row is filled by name; a new name makes
   * a new column, whose field is empty in rows without a value. Values must agree on all ranks:
   * rank 0 writes its own.
   *
   * Rows are stored in one of two ways. A table that is `in_memory` keeps all its rows, so that
   * columns may appear at any row, column() returns them, and a checkpoint contains them. A table
   * that is `in_file` is for long histories: it keeps only the rows since the last flush(), its
   * columns are those of the row that is present at open(), and a checkpoint contains the length of
   * the file.
   */
  class TimeTable
  {
  public:
    enum class Rows
    {
      in_memory,
      in_file
    };

    /** An empty table, to be written to the file @p file_name of the directory given to open(). In
     * HDF5 it has the same name without the ending. */
    TimeTable(const std::string &file_name, Rows rows);

    /** Before open(). */
    void set_format(const TableFormat &new_format)
    {
      format = new_format;
    }

    /** The file has time, step and these columns, without units; `*` is any text. Empty: all. */
    void choose(const std::vector<std::string> &names)
    {
      chosen = names;
    }

    bool is_open() const
    {
      return directory != nullptr;
    }

    bool has_choice() const
    {
      return !chosen.empty();
    }

    /** Throws the InputError that one of them is no column of the present row. */
    void refuse_unknown(const Section &section, const std::string &entry) const;

    /** Starts a row: values that were added since the last row was written are discarded. */
    void begin_row();
    /** The same, with the columns that every history begins with: time [T] and step. */
    void begin_row(double time, std::uint64_t step);

    /** Sets a value of the present row. @p unit in terms of L, M, T and K; "1" for none. A name
     * has one unit and at most one value a row. */
    void add(const std::string &name, const std::string &unit, double value);

    /** Throws InputError where the table in this directory that open() would continue has other
     * columns than the present row, or another format. Changes nothing. Collective. */
    void refuse_other(const OutputDirectory &directory, const UnitLabels &unit_labels) const;

    /** Begins the file, or continues it where an earlier state of this table was read:
     * rows after the checkpoint are removed. With rows in memory nothing is written before there is
     * a row; with rows in the file the present row determines the columns and is discarded. Throws
     * RunError where the file cannot be written and InputError as refuse_other(). Collective. */
    void open(const OutputDirectory &directory, const UnitLabels &unit_labels);

    /** Ends the present row and starts the next. With rows in memory the row is in the file when
     * this returns: collective, and throws RunError on every rank where it cannot be written. With
     * rows in the file it is there after flush(). */
    void write_row();

    /** Writes rows that are not in the file. Throws RunError on every rank. Collective. */
    void flush();

    /** Lists the state, which is read before open(). */
    void list(Records &records);

    /** With rows in the file: whether a state was read, whose file open() continues. */
    bool is_continued() const
    {
      return bytes_at_checkpoint > 0 || format_at_checkpoint != TableFormat().name();
    }

    /** Before open(): whether the columns in the file are not those of the present row. */
    bool has_other_columns(const UnitLabels &unit_labels) const;

    /** The values of a column in the rows that were written, NaN where a row has none. Empty for
     * an unknown name and with rows in the file. */
    std::vector<double> column(const std::string &name) const;

    /** The value of a column in the present row; NaN where it has none. */
    double present(const std::string &name) const;

    /** Names in the order of columns. */
    std::vector<std::string> names() const;

  private:
    struct Column
    {
      std::string name;
      std::string unit;
      std::vector<double> values; ///< of kept rows and the present one
      std::vector<bool> is_given;
      bool is_in_file = true;
    };

    bool is_chosen(const std::string &name) const;
    Column &find_column(const std::string &name, const std::string &unit);
    std::string header(const UnitLabels &labels) const;
    std::string text_of_row(std::size_t index) const;
    /** Numbers of a row for HDF5, behind @p values. */
    void append_row(std::size_t index, std::vector<double> &values) const;
    void begin_hdf5(std::uint64_t first_rows);
    void write_all_rows();
    void serialize_format(StateArchive &archive);
    void serialize_rows(StateArchive &archive);
    void serialize_length_of_file(StateArchive &archive);

    std::string file_name;
    Rows rows;
    std::vector<std::string> chosen; ///< empty: all
    std::vector<Column> columns;
    std::size_t next_column = 0; ///< that a row in the same order as the last one fills next
    std::size_t n_kept_rows = 0; ///< in memory; the present row is the one after them
    std::size_t n_columns_in_file = 0;
    TableFormat format;
    Hdf5Table hdf5;
    std::string unwritten_rows;           ///< of the file of comma-separated values
    std::vector<double> unwritten_values; ///< of that of HDF5
    std::string header_at_checkpoint, format_at_checkpoint = TableFormat().name();
    std::uint64_t bytes_at_checkpoint = 0, rows_at_checkpoint = 0; ///< the latter in HDF5
    UnitLabels unit_labels;
    std::unique_ptr<OutputDirectory> directory; ///< null before open()
  };
} // namespace tombolo
