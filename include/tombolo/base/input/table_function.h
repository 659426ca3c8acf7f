// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace tombolo
{
  /** An expression whose calls `table(FILE, argument)` are taken out: in `text` their values have
   * the names `table_1`, `table_2`, ... */
  struct TableCalls
  {
    struct Call
    {
      std::string name, file, argument; ///< the argument may have calls itself
    };

    std::string text;
    std::vector<Call> calls;
    std::string problem; ///< what is wrong with a call, a sentence; empty: nothing

    explicit TableCalls(const std::string &expression);
  };

  /** A piecewise linear function of one variable, by its points: `table(FILE, ...)` in an
   * expression. Before the first point and after the last one it is constant. */
  class TableFunction
  {
  public:
    /** Reads two numbers a line, separated by a comma, a semicolon, a tab or blanks. What follows
     * `#` is a comment, and a first line that is no numbers is a heading. Throws
     * std::invalid_argument with the number of the line where one has not two finite numbers or its
     * first is not above that of the line before, or where there are fewer than two points. */
    explicit TableFunction(const std::string &text);

    double value(double argument) const;

  private:
    std::vector<double> arguments, values;
  };
} // namespace tombolo
