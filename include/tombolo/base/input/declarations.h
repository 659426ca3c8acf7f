// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <limits>
#include <optional>
#include <string>

namespace tombolo
{
  /** In place of a default: the entry has none, see Parameters::declare_mandatory(). */
  constexpr std::nullopt_t mandatory = std::nullopt;

  /**
   * Declares entries in the present subsection of a ParameterHandler by the kind of their value. A
   * unit is added to the documentation as " Units: UNIT."; none is added where it is empty. The
   * handler must outlive it.
   */
  class Declarations
  {
  public:
    explicit Declarations(dealii::ParameterHandler &handler);

    /** A number from @p smallest to @p largest, both allowed. */
    void number(const std::string &entry, std::optional<double> default_value,
                const std::string &unit, const std::string &documentation,
                double smallest = -std::numeric_limits<double>::max(),
                double largest = std::numeric_limits<double>::max());

    /** A number of at least zero. */
    void non_negative(const std::string &entry, std::optional<double> default_value,
                      const std::string &unit, const std::string &documentation);

    /** A whole number of at least @p smallest. */
    void whole_number(const std::string &entry, std::optional<int> default_value, int smallest,
                      const std::string &documentation);

    /** @p n numbers, separated by commas. */
    void numbers(const std::string &entry, const std::optional<std::string> &default_value,
                 unsigned int n, const std::string &unit, const std::string &documentation);

    /** One of the @p alternatives, which are separated by "|". */
    void choice(const std::string &entry, const std::optional<std::string> &default_value,
                const std::string &alternatives, const std::string &documentation);

    /** Text whose form the reader checks: expressions, names, lists of unknown length. */
    void text(const std::string &entry, const std::optional<std::string> &default_value,
              const std::string &unit, const std::string &documentation);

  private:
    void declare(const std::string &entry, const std::optional<std::string> &default_value,
                 const dealii::Patterns::PatternBase &pattern, const std::string &unit,
                 const std::string &documentation);

    dealii::ParameterHandler &handler;
  };
} // namespace tombolo
