// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/study/factor.h>
#include <tombolo/study/quantity_of_interest.h>

#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  /** A quantity of interest, and the value it ought to have. */
  struct Target
  {
    QuantityOfInterest quantity;
    bool has_reference = false;
    double reference = 0; ///< the error is relative to it; without one the number is the error
  };

  /** An entry whose largest value with which runs still succeed is wanted. */
  struct Search
  {
    std::string entry;
    /** A value of a first run without the entry, of which `from` and `to` are multiples. */
    std::optional<QuantityOfInterest> unit;
    double from = 0, to = 0;
    double tolerance = 0.01; ///< of the ratio of failing to succeeding value, less one
    std::vector<QuantityOfInterest> bounds;
    std::vector<double> limits; ///< of the magnitudes of the bounds
  };

  /** One product of factors: which of their values it takes. Factors that it does not name stay as
   * the parameter file has them. */
  struct Grid
  {
    std::string text;
    struct Axis
    {
      unsigned int factor;
      std::vector<unsigned int> values;
    };
    std::vector<Axis> axes;
  };

  /** What a study file says. */
  struct StudySettings
  {
    static constexpr unsigned int untouched = static_cast<unsigned int>(-1);

    static void declare_parameters(Parameters &parameters);

    /** Reads everything. Throws InputError. */
    explicit StudySettings(const Parameters &parameters);

    std::string title;
    std::string base_file; ///< as a path that can be opened
    std::vector<std::string> common_settings;
    std::vector<Factor> factors;
    std::vector<Grid> grids;

    std::string program; ///< empty: tombolo beside this program
    unsigned int repetitions = 1;
    unsigned int at_a_time = 1;
    unsigned int ranks = 1;
    double time_limit = 0; ///< of one run, seconds; zero: none
    /** A program that measures each run, and its arguments; empty: none. */
    std::vector<std::string> measurement;

    std::string error_name;
    std::string combination; ///< "mean", "largest" or "root mean square"
    std::vector<Target> targets;
    /** For every factor the value of the run whose numbers are the references; empty: none. */
    std::vector<unsigned int> reference_run;
    std::string cost_name;
    QuantityOfInterest cost{"summary.json/wall_seconds"};
    std::vector<QuantityOfInterest> columns; ///< further numbers for the table

    bool has_search = false;
    Search search;

    /** "pareto", "lines" or "map". */
    std::string picture;
    bool logarithmic_values = false;

    /** The choices of all grids, each once: for every factor the number of its value, or untouched.
     */
    std::vector<std::vector<unsigned int>> choices() const;

    /** Stands for the output directory of a run in `measurement`. */
    static constexpr const char *output_mark = "{output}";

  private:
    Grid read_grid(const Section &section, const std::string &text) const;
    /** The number of a factor, and of one of its values by its label. */
    unsigned int factor_number(const Section &section, const std::string &entry,
                               const std::string &name) const;
    unsigned int value_number(const Section &section, const std::string &entry, unsigned int factor,
                              const std::string &label) const;
    void read_error(const Section &section);
    void read_search(const Section &section);
    void read_measurement(const Section &section);
    std::string resolved(const Section &section, const std::string &entry,
                         const std::string &file) const;

    std::string directory; ///< of the study file
  };
} // namespace tombolo
