// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/text.h>

#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>
#include <stdexcept>
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

    explicit TableCalls(const std::string &expression)
    {
      std::size_t done = 0, begin = 0, opening = 0;
      while (find_call(expression, begin, opening))
      {
        const std::size_t closing = closing_parenthesis(expression, opening);
        const std::size_t comma = expression.find(',', opening);
        Call call;
        if (closing != std::string::npos && comma < closing)
        {
          call.file = dealii::Utilities::trim(expression.substr(opening + 1, comma - opening - 1));
          call.argument =
              dealii::Utilities::trim(expression.substr(comma + 1, closing - comma - 1));
        }
        if (call.file.empty() || call.argument.empty())
        {
          problem = "a table is `table(FILE, ARGUMENT)`, for example `table(load.csv, t)`.";
          return;
        }
        call.name = std::string(word) + "_" + std::to_string(calls.size() + 1);
        text += expression.substr(done, begin - done) + call.name;
        calls.push_back(call);
        done = begin = closing + 1;
      }
      text += expression.substr(done);
    }

  private:
    static constexpr char word[] = "table";

    static bool is_of_name(const char character)
    {
      return std::isalnum(static_cast<unsigned char>(character)) != 0 || character == '_';
    }

    /** The position of the next `table` that is a word and is called, and of its parenthesis. */
    static bool find_call(const std::string &text, std::size_t &begin, std::size_t &parenthesis)
    {
      while ((begin = text.find(word, begin)) != std::string::npos)
      {
        const std::size_t end = begin + sizeof(word) - 1;
        parenthesis = text.find_first_not_of(" \t", end);
        if ((begin == 0 || !is_of_name(text[begin - 1])) && parenthesis != std::string::npos &&
            text[parenthesis] == '(')
          return true;
        begin = end;
      }
      return false;
    }

    static std::size_t closing_parenthesis(const std::string &text, const std::size_t opening)
    {
      int depth = 0;
      for (std::size_t i = opening; i < text.size(); ++i)
      {
        depth += text[i] == '(' ? 1 : text[i] == ')' ? -1 : 0;
        if (depth == 0)
          return i;
      }
      return std::string::npos;
    }
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
    explicit TableFunction(const std::string &text)
    {
      std::istringstream stream(text);
      unsigned int number = 0;
      bool may_be_heading = true;
      for (std::string line; std::getline(stream, line);)
      {
        ++number;
        const std::vector<std::string> fields = fields_of(line);
        if (fields.empty())
          continue;
        double point[2] = {0, 0};
        bool has_number = false;
        for (const std::string &field : fields)
          has_number = is_number(field, point[0]) || has_number;
        if (may_be_heading && !has_number)
        {
          may_be_heading = false;
          continue;
        }
        may_be_heading = false;
        if (fields.size() != 2)
          fail(number, "two numbers are needed, an argument and a value; found " +
                           std::to_string(fields.size()) + " entries.");
        for (unsigned int i = 0; i < 2; ++i)
          if (fields[i].empty())
            fail(number, "the " + std::string(i == 0 ? "argument" : "value") + " is missing.");
          else if (!is_number(fields[i], point[i]) || !std::isfinite(point[i]))
            fail(number, "\"" + fields[i] + "\" is not a finite number.");
        if (!arguments.empty() && !(point[0] > arguments.back()))
          fail(number, "arguments must rise from line to line; \"" + fields[0] +
                           "\" is not above that of the line before.");
        arguments.push_back(point[0]);
        values.push_back(point[1]);
      }
      if (arguments.size() < 2)
        throw std::invalid_argument("a table needs two points or more, found " +
                                    std::to_string(arguments.size()) + ".");
    }

    double value(const double argument) const
    {
      if (!(argument > arguments.front()))
        return std::isnan(argument) ? argument : values.front();
      if (argument >= arguments.back())
        return values.back();
      const auto next = static_cast<std::size_t>(
          std::upper_bound(arguments.begin(), arguments.end(), argument) - arguments.begin());
      const double fraction =
          (argument - arguments[next - 1]) / (arguments[next] - arguments[next - 1]);
      return values[next - 1] + fraction * (values[next] - values[next - 1]);
    }

  private:
    /** The fields of a line without its comment: none where it is empty. Blanks separate fields
     * only where nothing else does. */
    static std::vector<std::string> fields_of(std::string line)
    {
      line.erase(std::min(line.find('#'), line.size()));
      if (line.find_first_not_of(" \t\r") == std::string::npos)
        return {};
      const char separator = line.find(';') != std::string::npos   ? ';'
                             : line.find(',') != std::string::npos ? ','
                                                                   : ' ';
      if (separator == ' ')
        std::replace(line.begin(), line.end(), '\t', ' ');
      std::vector<std::string> fields = split_list(line, separator);
      if (separator == ' ')
        fields.erase(std::remove(fields.begin(), fields.end(), ""), fields.end());
      return fields;
    }

    [[noreturn]] static void fail(const unsigned int line, const std::string &what)
    {
      throw std::invalid_argument("line " + std::to_string(line) + ": " + what);
    }

    std::vector<double> arguments, values;
  };
} // namespace tombolo
