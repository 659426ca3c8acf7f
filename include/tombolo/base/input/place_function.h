// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>

#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/table_function.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /** The names of the variables of expressions. */
  std::vector<std::string> variables_of_expressions(unsigned int dim);

  /** The function of place and time that a text means, as muParser reads it, with tables from
   * files. Several threads may evaluate it at the same time. */
  template <int dim>
  class PlaceFunction
  {
  public:
    virtual ~PlaceFunction() = default;

    virtual double evaluate(const dealii::Point<dim> &point, double time) const = 0;

    /** @p entry of @p section has the text, and its files are looked for as read_input_file() does.
     * Throws InputError for a table that cannot be read, and what muParser throws for a text that
     * it cannot read. Collective where there are tables. */
    static std::unique_ptr<PlaceFunction> create(const TableCalls &calls, const Section &section,
                                                 const std::string &entry);
  };
} // namespace tombolo
