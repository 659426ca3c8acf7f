// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/output_directory.h>
#include <tombolo/output/unit_labels.h>

#include <string>
#include <vector>

namespace tombolo
{
  class StateArchive;

  /** A number as text: the shortest that reads back as the same double; whole numbers without a
   * point; "nan", "inf", "-inf". */
  std::string format_number(double value);

  /** A field of a table of comma-separated values, quoted where it must be (RFC 4180). */
  std::string csv_field(const std::string &text);

  /**
   * One table of a run, a row per output, as comma-separated values with a header that names the
   * units. Whoever has something to say adds it to the present row; a name that is new makes a
   * new column, and rows without it have an empty field there. Values must agree on all ranks: rank
   * 0 writes its own.
   */
  class Statistics
  {
  public:
    /** Nothing is written before the first row. */
    Statistics(const OutputDirectory &directory, const std::string &file_name,
               const UnitLabels &unit_labels);

    /** Starts a row: values that were added since the last one was written are forgotten. */
    void begin_row();

    /** Sets a value of the present row. @p unit in terms of L, M, T and K; "1" for none. A name
     * has one unit and at most one value a row. */
    void add(const std::string &name, const std::string &unit, double value);

    /** The value of a column in the present row; NaN where it has none. */
    double present(const std::string &name) const;

    /** Writes the present row, so that it is in the file when this returns, and starts the next.
     * Throws RunError on every rank where the file cannot be written. Collective. */
    void write_row();

    /** Writes the rows so far to a checkpoint or reads them from it. Collective. */
    void serialize(StateArchive &archive);

    /** Writes the file anew with the rows so far: a resumed run leaves out those that came after
     * its checkpoint. Throws RunError. Collective. */
    void write_all_rows();

    /** Rows that were written, for tests and for what summarizes the run. NaN where a row has no
     * value. */
    std::vector<double> column(const std::string &name) const;

    /** Names in the order of columns. */
    std::vector<std::string> names() const;

  private:
    struct Column
    {
      std::string name;
      std::string unit;
      std::vector<double> values;
      std::vector<bool> is_given;
    };

    std::string header() const;
    std::string row(std::size_t index) const;

    OutputDirectory directory;
    std::string file_name;
    UnitLabels unit_labels;
    std::vector<Column> columns;
    std::size_t n_rows = 0;
    std::size_t n_columns_in_file = 0;
  };
} // namespace tombolo
