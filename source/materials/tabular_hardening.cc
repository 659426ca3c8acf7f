// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/materials/flow_stress.h>

#include <deal.II/base/utilities.h>

#include <cmath>
#include <vector>

namespace tombolo
{
  namespace
  {
    void check_increasing(const Section &section, const std::string &entry,
                          const std::vector<double> &knots)
    {
      for (std::size_t k = 0; k < knots.size(); ++k)
        if (k > 0 && !(knots[k] > knots[k - 1]))
          section.fail(entry, "allowed are finite numbers that increase; number " +
                                  std::to_string(k + 1) + " does not.");
    }

    std::vector<std::vector<double>> read_rows(const Section &section, const std::string &entry)
    {
      std::vector<std::vector<double>> rows;
      for (const std::string &row : Utilities::split_string_list(section.get(entry), ';'))
      {
        rows.emplace_back();
        for (const std::string &number : Utilities::split_string_list(row, ','))
          if (!is_number(number, rows.back().emplace_back()))
            section.fail(entry, "\"" + number + "\" is not a number.");
      }
      return rows;
    }
  } // namespace

  /** A flow stress interpolated linearly in a table over the effective plastic strain and, in
   * tables of several rows, the temperature or plastic strain rate; constant beyond its ends. */
  class TabularHardening : public FlowStress
  {
  public:
    explicit TabularHardening(const Entries &e)
    {
      e.text("Plastic strains", mandatory, "1",
             "Effective plastic strains of the columns, increasing from 0, separated by commas.");
      e.text("Temperatures", "", "",
             "Temperatures of the rows, increasing, separated by commas; empty for a table of one "
             "row that holds at all temperatures.");
      e.text("Strain rates", "", "1/T",
             "Plastic strain rates of the rows in place of temperatures.");
      e.text(
          "Flow stresses", mandatory, "M/(L T^2)",
          "The table: flow stresses of a row separated by commas, rows separated by semicolons.");
      rate_factor = CowperSymonds(e);
      if (e.declares())
        return;
      const Section &section = e.section();
      strains = section.get_doubles("Plastic strains");
      over_rates = !section.get_doubles("Strain rates").empty();
      const std::string row_entry = over_rates ? "Strain rates" : "Temperatures";
      if (over_rates && !section.get_doubles("Temperatures").empty())
        section.fail("Strain rates", "rows are over the temperature or over the rate: empty "
                                     "`Temperatures`, or this entry.");
      if (over_rates && rate_factor.is_on())
        section.fail("Cowper-Symonds rate", "the table has `Strain rates` already: one of both.");
      knots_of_rows = section.get_doubles(row_entry);
      if (strains.empty() || strains.front() != 0.)
        section.fail("Plastic strains", "allowed are numbers that increase from 0.");
      check_increasing(section, "Plastic strains", strains);
      check_increasing(section, row_entry, knots_of_rows);

      const std::vector<std::vector<double>> rows = read_rows(section, "Flow stresses");
      const std::size_t n_rows = knots_of_rows.empty() ? 1 : knots_of_rows.size();
      if (rows.size() != n_rows)
        section.fail("Flow stresses", "found " + std::to_string(rows.size()) +
                                          " rows, separated by semicolons; needed are " +
                                          std::to_string(n_rows) +
                                          (over_rates ? ", one a rate." : ", one a temperature."));
      for (std::size_t r = 0; r < n_rows; ++r)
      {
        const std::vector<double> &row = rows[r];
        if (row.size() != strains.size())
          section.fail("Flow stresses", "row " + std::to_string(r + 1) + " has " +
                                            std::to_string(row.size()) + " values; needed are " +
                                            std::to_string(strains.size()) +
                                            ", one a plastic strain.");
        for (const double value : row)
          if (!(value >= 0. && std::isfinite(value)))
            section.fail("Flow stresses", "allowed are zero and positive numbers.");
        values.insert(values.end(), row.begin(), row.end());
        if (row.size() == 1)
          values.push_back(row.front());
      }
      if (strains.size() == 1)
        strains.push_back(1.);
      if (knots_of_rows.size() == 1) // it holds everywhere
        knots_of_rows.clear();
    }

    bool depends_on_temperature() const override
    {
      return !knots_of_rows.empty() && !over_rates;
    }

    void evaluate(const FlowStressBatch &batch) const override
    {
      if (knots_of_rows.empty())
        interpolate<Rows::one>(batch);
      else if (over_rates)
        interpolate<Rows::over_rates>(batch);
      else
        interpolate<Rows::over_temperatures>(batch);
      rate_factor.apply(batch);
    }

  private:
    enum class Rows
    {
      one,
      over_temperatures,
      over_rates
    };

    template <Rows rows>
    void interpolate(const FlowStressBatch &batch) const
    {
      const double *const strain_knots = strains.data();
      const double *const row_knots = knots_of_rows.data();
      const double *const table = values.data();
      const auto n_strains = static_cast<int>(strains.size());
      const auto n_rows = static_cast<int>(knots_of_rows.size());
      for (unsigned int begin = 0; begin < batch.n; begin += n_lanes)
      {
        const double *const p = batch.plastic_strain + begin;
        double t[n_lanes]; // where the rows are evaluated
        for (unsigned int lane = 0; lane < n_lanes && rows != Rows::one; ++lane)
          t[lane] = rows == Rows::over_rates
                        ? batch.increment[begin + lane] * batch.inverse_time_increment
                        : batch.temperature[begin + lane];
        // The intervals, found by counting: all lanes walk the table together.
        long long column[n_lanes] = {}, row[n_lanes] = {};
        for (int k = 1; k < n_strains - 1; ++k)
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
            column[lane] += p[lane] >= strain_knots[k] ? 1 : 0;
        if constexpr (rows != Rows::one)
          for (int k = 1; k < n_rows - 1; ++k)
            for (unsigned int lane = 0; lane < n_lanes; ++lane)
              row[lane] += t[lane] >= row_knots[k] ? 1 : 0;

#pragma GCC ivdep
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
        {
          const long long j = column[lane];
          const double width = strain_knots[j + 1] - strain_knots[j];
          const double w = (p[lane] - strain_knots[j]) / width;
          const bool is_inside = w < 1.;
          const double weight = is_inside ? w : 1.;
          const double slope_factor = is_inside ? 1. / width : 0.;
          const double *const lower = table + row[lane] * n_strains + j;
          double value = (1. - weight) * lower[0] + weight * lower[1];
          double slope = slope_factor * (lower[1] - lower[0]);
          if constexpr (rows != Rows::one)
          {
            const double *const upper = lower + n_strains;
            const double upper_value = (1. - weight) * upper[0] + weight * upper[1];
            const double range = row_knots[row[lane] + 1] - row_knots[row[lane]];
            const double s = (t[lane] - row_knots[row[lane]]) / range;
            const bool is_between = s > 0. && s < 1.;
            const double share = s > 0. ? (s < 1. ? s : 1.) : 0.;
            const double slope_of_rows = is_between ? (upper_value - value) / range : 0.;
            const double change = rows == Rows::over_rates ? batch.inverse_time_increment
                                                           : batch.temperature_change[begin + lane];
            const double upper_slope = slope_factor * (upper[1] - upper[0]);
            slope = (1. - share) * slope + share * upper_slope + slope_of_rows * change;
            value = (1. - share) * value + share * upper_value;
          }
          batch.flow_stress[begin + lane] = value;
          batch.slope[begin + lane] = slope;
        }
      }
    }

    // Knots of an axis with one value are doubled, so that every axis has an interval.
    std::vector<double> strains, knots_of_rows;
    bool over_rates = false;
    CowperSymonds rate_factor;
    std::vector<double> values; // [M/(L T^2)], strain fastest
  };

  TOMBOLO_REGISTER(FlowStress, TabularHardening, "tabular",
                   "a table over the plastic strain and the temperature or the strain rate")
} // namespace tombolo
