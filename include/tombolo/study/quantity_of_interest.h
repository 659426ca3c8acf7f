// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>
#include <string>

namespace tombolo
{
  /** Of a quantity that a run did not have. */
  constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

  /**
   * A number that a run left in its output directory, named by a text:
   *
   *   summary.json/results/length                        a value of a JSON file, by its path;
   *                                                      elements of arrays by number
   *   statistics.csv/energy error                        the last row of a column of a table
   *   statistics.csv/relative error of stress xx at 9    the row of a time
   *   largest of statistics.csv/energy error             the largest magnitude of a column,
   *   mean of statistics.csv/relative error of stress xx the mean, where it is defined
   *
   * Columns are named without their units.
   */
  class QuantityOfInterest
  {
  public:
    /** Throws std::invalid_argument with what is wrong with the text. */
    explicit QuantityOfInterest(const std::string &text);

    const std::string &text() const;

    /** The number in this output directory. Throws RunError where there is none, or none that is
     * finite. */
    double value(const std::string &directory) const;

  private:
    enum class Take
    {
      last,
      largest,
      mean,
      at_time
    };

    double value_of_json(const std::string &file) const;
    double value_of_table(const std::string &file) const;

    std::string whole_text;
    std::string file_name;
    std::string name; ///< of the column, or the path in the document
    Take take = Take::last;
    double time = 0;
  };
} // namespace tombolo
