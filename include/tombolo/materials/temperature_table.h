// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** A property as a function of the temperature: one number, or pairs `temperature: value` that
   * are joined by straight lines and constant beyond the first and the last. */
  class TemperatureTable
  {
  public:
    /** Constant. */
    explicit TemperatureTable(double constant = 0.);

    /** Reads "237" or "0: 237, 200: 240, 400: 230". Throws InputError where that is neither, where
     * temperatures do not increase, where a number is not finite. Messages call what the table is
     * over @p argument: it need not be a temperature. */
    TemperatureTable(const Section &section, const std::string &entry,
                     const std::string &argument = "temperature");

    bool is_constant() const
    {
      return knots.size() == 1;
    }

    double value(double temperature) const;
    /** For @p n temperatures, vectorized. */
    void evaluate(unsigned int n, const double *temperature, double *result) const;
    double smallest() const;
    double largest() const;

    /** The knots; one for a constant. */
    const std::vector<double> &temperatures() const
    {
      return knots;
    }

    const std::vector<double> &values() const
    {
      return knot_values;
    }

  private:
    std::vector<double> knots;
    std::vector<double> knot_values;
  };
} // namespace tombolo
