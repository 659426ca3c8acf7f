// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <tombolo/base/input/text.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/materials/temperature_table.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace
  {
    std::string allowed(const std::string &argument)
    {
      return "allowed are one number, or pairs `" + argument +
             ": value` separated by commas, for example 0: 237, 200: 240.";
    }

    double to_number(const Section &section, const std::string &entry, const std::string &text,
                     const std::string &argument)
    {
      double number = 0;
      if (!is_number(text, number))
        section.fail(entry, in_quotes(text) + " is not a number; " + allowed(argument));
      if (!std::isfinite(number))
        section.fail(entry, in_quotes(text) + " is not finite; allowed are finite numbers.");
      return number;
    }
  } // namespace

  TemperatureTable::TemperatureTable(const double constant) : knots{0.}, knot_values{constant} {}

  TemperatureTable::TemperatureTable(const Section &section, const std::string &entry,
                                     const std::string &argument)
  {
    const std::vector<std::string> items = section.get_list(entry);
    if (items.size() == 1 && items.front().find(':') == std::string::npos)
    {
      knots = {0.};
      knot_values = {to_number(section, entry, items.front(), argument)};
      return;
    }
    std::string previous;
    for (const std::string &item : items)
    {
      const std::size_t colon = item.find(':');
      if (colon == std::string::npos)
        section.fail(entry, in_quotes(item) + " is no pair `" + argument +
                                ": value`; allowed are one number, or such pairs separated by "
                                "commas, for example 0: 237, 200: 240.");
      const std::string temperature = Utilities::trim(item.substr(0, colon));
      knots.push_back(to_number(section, entry, temperature, argument));
      knot_values.push_back(
          to_number(section, entry, Utilities::trim(item.substr(colon + 1)), argument));
      if (knots.size() > 1 && !(knots.back() > knots[knots.size() - 2]))
        section.fail(entry, "the " + argument + " " + temperature + " stands after " + previous +
                                "; allowed are " + argument + "s that increase.");
      previous = temperature;
    }
    if (knots.empty())
      section.fail(entry, allowed(argument));
  }

  double TemperatureTable::value(const double temperature) const
  {
    double result;
    evaluate(1, &temperature, &result);
    return result;
  }

  namespace
  {
    /** For n_lanes temperatures, in a table of at least two knots. */
    void interpolate(const std::vector<double> &knots, const std::vector<double> &values,
                     const double *const temperature, double *const result)
    {
      const double *const knot = knots.data();
      const double *const table = values.data();
      const auto n_knots = static_cast<int>(knots.size());
      // The intervals, found by counting: all lanes walk the table together.
      long long interval[n_lanes] = {};
      for (int k = 1; k < n_knots - 1; ++k)
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          interval[lane] += temperature[lane] >= knot[k] ? 1 : 0;
#pragma GCC ivdep
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        const long long k = interval[lane];
        const double share = (temperature[lane] - knot[k]) / (knot[k + 1] - knot[k]);
        const double weight = share > 0. ? (share < 1. ? share : 1.) : 0.;
        result[lane] = (1. - weight) * table[k] + weight * table[k + 1];
      }
    }
  } // namespace

  void TemperatureTable::evaluate(const unsigned int n, const double *const temperature,
                                  double *const result) const
  {
    if (is_constant())
    {
      std::fill(result, result + n, knot_values.front());
      return;
    }
    const unsigned int n_full = n / n_lanes * n_lanes;
    for (unsigned int begin = 0; begin < n_full; begin += n_lanes)
      interpolate(knots, knot_values, temperature + begin, result + begin);
    if (n_full < n)
    {
      double padded[n_lanes], padded_result[n_lanes];
      std::fill(padded, padded + n_lanes, knots.front());
      std::copy(temperature + n_full, temperature + n, padded);
      interpolate(knots, knot_values, padded, padded_result);
      std::copy(padded_result, padded_result + (n - n_full), result + n_full);
    }
  }

  double TemperatureTable::smallest() const
  {
    return *std::min_element(knot_values.begin(), knot_values.end());
  }

  double TemperatureTable::largest() const
  {
    return *std::max_element(knot_values.begin(), knot_values.end());
  }
} // namespace tombolo
