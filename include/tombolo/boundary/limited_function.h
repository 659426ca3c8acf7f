// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/input/parameters.h>

#include <limits>
#include <sstream>
#include <string>

namespace tombolo
{
  /** A function of position and time whose values must be within limits. */
  template <int dim>
  class LimitedFunction
  {
  public:
    /** @p allowed completes "allowed is ...". Throws InputError where the function is outside of
     * the limits at the start, if it does not depend on the position. */
    LimitedFunction(const Section &section, const std::string &entry, const double lowest,
                    const double highest, const std::string &allowed)
        : expression(section, entry, 1), description(section.describe(entry)), allowed(allowed),
          lowest(lowest), highest(highest)
    {
      if (!depends_on_position())
        check_start(dealii::Point<dim>());
    }

    /** Without limits. */
    LimitedFunction(const Section &section, const std::string &entry)
        : expression(section, entry, 1), lowest(-std::numeric_limits<double>::infinity()),
          highest(std::numeric_limits<double>::infinity())
    {}

    bool depends_on_position() const
    {
      return expression.depends_on_position();
    }

    /** Throws RunError, on this rank alone, without a finite value or beyond the limits. */
    double value(const dealii::Point<dim> &point, const double time) const
    {
      const double result = expression.value(point, time);
      if (!(result >= lowest && result <= highest))
      {
        std::ostringstream message;
        message << description << ": allowed is " << allowed << ", but it is " << result;
        if (depends_on_position())
          message << " at (" << point << ")";
        message << " at t = " << time << ".";
        throw RunError(message.str());
      }
      return result;
    }

    void check_start(const dealii::Point<dim> &point) const
    {
      try
      {
        value(point, 0.);
      }
      catch (const RunError &error)
      {
        throw InputError(error.what());
      }
    }

  private:
    Expression<dim> expression;
    std::string description, allowed;
    double lowest, highest;
  };
} // namespace tombolo
