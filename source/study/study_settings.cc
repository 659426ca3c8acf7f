// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/study_settings.h>

#include <tombolo/base/input/registry.h>
#include <tombolo/base/input/section_names.h>

#include <deal.II/base/patterns.h>
#include <deal.II/base/utilities.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>
#include <stdexcept>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    const char *const quantity_documentation =
        "A value is `FILE.json/KEY/KEY` (elements of arrays by number), or `FILE.csv/COLUMN` for "
        "the last row of a column of a table, `FILE.csv/COLUMN at TIME` for the row of a time, "
        "`largest of FILE.csv/COLUMN` or `mean of FILE.csv/COLUMN`, in the output directory of the "
        "run.";

    double number(const Section &section, const std::string &entry, const std::string &text)
    {
      try
      {
        const double value = Utilities::string_to_double(text);
        if (std::isfinite(value))
          return value;
      }
      catch (const std::exception &)
      {}
      section.fail(entry, "\"" + text + "\" is not a number");
    }

    QuantityOfInterest quantity(const Section &section, const std::string &entry,
                                const std::string &text)
    {
      try
      {
        return QuantityOfInterest(text);
      }
      catch (const std::invalid_argument &error)
      {
        section.fail(entry, error.what());
      }
    }

    std::vector<QuantityOfInterest> quantities(const Section &section, const std::string &entry)
    {
      std::vector<QuantityOfInterest> result;
      if (!section.get(entry).empty())
        for (const std::string &text : split_texts(section.get(entry), "|"))
          result.push_back(quantity(section, entry, text));
      return result;
    }

    unsigned int place_of(const Section &section, const std::string &entry,
                          const std::vector<std::string> &names, const std::string &wanted,
                          const std::string &kind)
    {
      const auto found = std::find(names.begin(), names.end(), wanted);
      if (found != names.end())
        return static_cast<unsigned int>(found - names.begin());
      const std::string nearest = nearest_name(wanted, names);
      section.fail(entry, "\"" + wanted + "\" is no " + kind + "; allowed is " +
                              joined(names, ", ") +
                              (nearest.empty() ? "" : ". Did you mean \"" + nearest + "\"?"));
    }

    /** The sections of the factors, under their present name or the former one, "Knob: NAME". */
    std::vector<std::string> factor_sections(const Parameters &parameters)
    {
      std::vector<std::string> paths;
      const bool has_factors = !parameters.raw("Factors").empty();
      for (const std::string &name : section_names(parameters, has_factors ? "Factors" : "Knobs"))
      {
        const std::string former_path = "Knob: " + name;
        const bool is_former = !parameters.raw(former_path + "/Entries").empty();
        paths.push_back(is_former ? former_path : "Factor: " + name);
      }
      return paths;
    }

    /** What is varied, and which values meet. */
    void declare_variation(ParameterHandler &handler)
    {
      const Patterns::Anything text;
      handler.declare_entry("Title", "", text, "A title for tables and pictures.");
      handler.declare_entry("Output directory", "output/trade_study", text,
                            "Where the study leaves its tables, and its runs in `members`; made if "
                            "it does not exist. Runs that are there already are not made again.");
      Parameters::declare_mandatory(handler, "Base file", text,
                                    "The parameter file whose entries are varied, relative to the "
                                    "study file.");
      handler.declare_entry("Common settings", "", text,
                            "`Section/Entry = value` for all runs, separated by ` | `.");
      Parameters::declare_mandatory(
          handler, "Factors", text,
          "Names of what is varied, each with a section `Factor: NAME`, separated by commas.");
      handler.declare_alias("Factors", "Knobs", true);
      handler.declare_entry(
          "Grids", "", text,
          "Which values of factors meet: products of factors such as `spacing x dilation`, "
          "separated by commas. A factor that a product does not name is left as the parameter "
          "file has it; `model = particles x dilation` takes one value, `model = particles / "
          "coupled x dilation` two. Empty: the product of all factors.");
    }

    /** How runs are made. */
    void declare_runs(ParameterHandler &handler)
    {
      const Patterns::Anything text;
      handler.declare_entry("Program", "", text,
                            "The program that makes the runs; empty: tombolo beside trade_study.");
      handler.declare_entry("Repetitions", "1", Patterns::Integer(1, 1000),
                            "Each run is made so many times; the smallest cost counts.");
      handler.declare_entry("Runs at a time", "1", Patterns::Integer(1, 1000),
                            "Runs that are made side by side. More than one disturbs the cost.");
      handler.declare_alias("Runs at a time", "Members at a time", true);
      handler.declare_entry("Ranks", "1", Patterns::Integer(1, 100000), "MPI ranks of each run.");
      handler.declare_entry(
          "Time limit", "0", Patterns::Double(0.),
          "A run that takes longer is ended, and counts as failed. Zero: no limit. "
          "Units: seconds of wall time.");
      handler.declare_entry(
          "Measurement", "", text,
          "A program that measures each run that has ended, relative to the study file, and its "
          "arguments, separated by blanks; `{output}` stands for the output directory of the run. "
          "Numbers that it leaves there, in a JSON file or a table, are quantities of interest "
          "as those of the run are. Empty: none.");
    }

    /** What is drawn. */
    void declare_picture(ParameterHandler &handler)
    {
      handler.declare_entry(
          "Picture", "pareto", Patterns::Selection("pareto|lines|map"),
          "What scripts/study draws: error over cost with the front of the best; "
          "the value over the first factor of each grid, one line for each choice of "
          "the others; or a map over the first two factors of each grid.");
      handler.declare_entry("Logarithmic values", "true", Patterns::Bool(),
                            "Whether lines and maps have a logarithmic scale of values.");
    }

    /** What runs are measured by: the entries of the section Error. */
    void declare_error(ParameterHandler &handler)
    {
      const Patterns::Anything text;
      handler.declare_entry("Name", "error", text, "What tables and pictures call it.");
      handler.declare_entry(
          "Quantities of interest", "", text,
          std::string("Values of a run that tell its error, separated by ` | `. ") +
              quantity_documentation);
      handler.declare_alias("Quantities of interest", "Measures", true);
      handler.declare_entry(
          "References", "", text,
          "What the values ought to be, separated by commas: the error is relative "
          "to it. `-`: the value itself is the error.");
      handler.declare_entry(
          "Reference run", "", text,
          "Instead of references, the run whose values are right, by its factors, "
          "for example `spacing = 0.05, model = elements`.");
      handler.declare_alias("Reference run", "Reference member", true);
      handler.declare_entry("Combination", "mean",
                            Patterns::Selection("mean|largest|root mean square"),
                            "How the errors of several values make one.");
      handler.declare_entry("Cost", "summary.json/wall_seconds", text,
                            "The value that is the cost of a run.");
      handler.declare_entry("Cost name", "wall time [s]", text,
                            "What tables and pictures call the cost.");
      handler.declare_entry("Columns", "", text,
                            "Further values for the table, separated by ` | `.");
    }

    /** The entries of the section Search. */
    void declare_search(ParameterHandler &handler)
    {
      const Patterns::Anything text;
      handler.declare_entry(
          "Entry", "", text,
          "An entry whose largest value with which a run succeeds is searched for "
          "each run, by bisection; this value is then what the study measures. "
          "Empty: no search.");
      handler.declare_entry("Relative to", "", text,
                            "A value of a first run that leaves the entry alone, for example "
                            "summary.json/time_step_max: the values tried, and the one found, are "
                            "multiples of it. Empty: they are values of the entry.");
      handler.declare_entry("From", "0.01", Patterns::Double(1e-300), "The smallest value tried.");
      handler.declare_entry("To", "10", Patterns::Double(1e-300), "The largest value tried.");
      handler.declare_entry("Tolerance", "0.01", Patterns::Double(1e-6, 1.),
                            "The search ends where the smallest value that fails is larger by this "
                            "share than the largest that succeeds.");
      handler.declare_entry("Quantities of interest", "", text,
                            "A run succeeds if it ends and these values are within their bounds, "
                            "separated by ` | `; empty: if it ends.");
      handler.declare_alias("Quantities of interest", "Measures", true);
      handler.declare_entry("At most", "", text,
                            "Bounds of the magnitudes of the values, separated by commas.");
    }
  } // namespace

  void StudySettings::declare_parameters(Parameters &parameters)
  {
    ParameterHandler &handler = parameters.handler();
    declare_variation(handler);
    declare_runs(handler);
    declare_picture(handler);
    handler.enter_subsection("Error");
    declare_error(handler);
    handler.leave_subsection();
    handler.enter_subsection("Search");
    declare_search(handler);
    handler.leave_subsection();
    for (const std::string &path : factor_sections(parameters))
    {
      handler.enter_subsection(path);
      Factor::declare_parameters(handler);
      handler.leave_subsection();
    }
  }

  StudySettings::StudySettings(const Parameters &parameters)
  {
    const Section root = parameters.section("");
    directory = std::filesystem::path(parameters.file_name()).parent_path().string();
    title = root.get("Title");
    base_file = resolved(root, "Base file", root.get("Base file"));
    if (!root.get("Common settings").empty())
      common_settings = split_texts(root.get("Common settings"), " | ");
    for (const std::string &setting : common_settings)
      if (setting.find('=') == std::string::npos)
        root.fail("Common settings", "\"" + setting + "\" is not `Section/Entry = value`");
    program = root.get("Program");
    repetitions = root.get_unsigned("Repetitions");
    at_a_time = root.get_unsigned("Runs at a time");
    ranks = root.get_unsigned("Ranks");
    time_limit = root.get_double("Time limit");
    read_measurement(root);
    picture = root.get("Picture");
    logarithmic_values = root.get_bool("Logarithmic values");

    const std::vector<std::string> paths = factor_sections(parameters);
    if (paths.empty())
      root.fail("Factors", "a study varies at least one factor");
    for (const std::string &path : paths)
    {
      const Section section = parameters.section(path);
      Factor factor = Factor::read(section);
      for (std::size_t e = 0; e < factor.entries.size(); ++e)
        if (factor.entries[e] == Factor::base_file)
          for (Factor::Value &value : factor.values)
            value.texts[e] = resolved(section, "Values", value.texts[e]);
      factors.push_back(std::move(factor));
    }

    std::vector<std::string> products = root.get_list("Grids");
    if (products.empty())
    {
      products.emplace_back();
      for (const Factor &factor : factors)
        products.back() += (products.back().empty() ? "" : " x ") + factor.name;
    }
    for (const std::string &product : products)
      grids.push_back(read_grid(root, product));

    read_error(root.subsection("Error"));
    read_search(root.subsection("Search"));
    if (picture == "map")
      for (const Grid &grid : grids)
        if (grid.axes.size() < 2)
          root.fail("Picture",
                    "a map needs two factors, but the grid \"" + grid.text + "\" has one");
  }

  unsigned int StudySettings::factor_number(const Section &section, const std::string &entry,
                                            const std::string &name) const
  {
    std::vector<std::string> names;
    for (const Factor &factor : factors)
      names.push_back(factor.name);
    return place_of(section, entry, names, name, "factor");
  }

  unsigned int StudySettings::value_number(const Section &section, const std::string &entry,
                                           const unsigned int factor,
                                           const std::string &label) const
  {
    std::vector<std::string> labels;
    for (const Factor::Value &value : factors[factor].values)
      labels.push_back(value.label);
    return place_of(section, entry, labels, label, "value of the factor " + factors[factor].name);
  }

  Grid StudySettings::read_grid(const Section &section, const std::string &text) const
  {
    Grid grid;
    grid.text = text;
    std::set<unsigned int> named;
    for (const std::string &term : split_texts(text, " x "))
    {
      const std::size_t equals = term.find('=');
      Grid::Axis axis;
      axis.factor = factor_number(section, "Grids", Utilities::trim(term.substr(0, equals)));
      if (!named.insert(axis.factor).second)
        section.fail("Grids",
                     "\"" + text + "\" names the factor " + factors[axis.factor].name + " twice");
      if (equals == std::string::npos)
        for (unsigned int v = 0; v < factors[axis.factor].values.size(); ++v)
          axis.values.push_back(v);
      else
        for (const std::string &label : split_texts(term.substr(equals + 1), " / "))
          axis.values.push_back(value_number(section, "Grids", axis.factor, label));
      grid.axes.push_back(axis);
    }
    return grid;
  }

  void StudySettings::read_error(const Section &section)
  {
    error_name = section.get("Name");
    combination = section.get("Combination");
    const std::vector<QuantityOfInterest> values = quantities(section, "Quantities of interest");
    std::vector<std::string> references = section.get_list("References");
    if (!references.empty() && references.size() != values.size())
      section.fail("References", "there are " + std::to_string(references.size()) +
                                     " references for " + std::to_string(values.size()) +
                                     " quantities");
    references.resize(values.size(), "-");
    for (std::size_t i = 0; i < values.size(); ++i)
    {
      Target target{values[i]};
      target.has_reference = references[i] != "-";
      if (target.has_reference)
      {
        target.reference = number(section, "References", references[i]);
        if (target.reference == 0)
          section.fail("References", "an error relative to zero is undefined; `-` makes the value "
                                     "itself the error");
      }
      targets.push_back(target);
    }
    if (!section.get_list("Reference run").empty())
    {
      reference_run.assign(factors.size(), untouched);
      for (const std::string &choice : section.get_list("Reference run"))
      {
        const std::size_t equals = choice.find('=');
        if (equals == std::string::npos)
          section.fail("Reference run", "\"" + choice + "\" is not `FACTOR = VALUE`");
        const unsigned int factor =
            factor_number(section, "Reference run", Utilities::trim(choice.substr(0, equals)));
        reference_run[factor] = value_number(section, "Reference run", factor,
                                             Utilities::trim(choice.substr(equals + 1)));
      }
      const auto all = choices();
      if (std::find(all.begin(), all.end(), reference_run) == all.end())
        section.fail("Reference run", "no grid has this run");
    }
    cost = quantity(section, "Cost", section.get("Cost"));
    cost_name = section.get("Cost name");
    columns = quantities(section, "Columns");
  }

  void StudySettings::read_search(const Section &section)
  {
    search.entry = section.get("Entry");
    has_search = !search.entry.empty();
    if (!has_search)
    {
      if (targets.empty())
        section.parent().subsection("Error").fail(
            "Quantities of interest",
            "a study measures something: values of its runs here, or the largest value "
            "of an entry by the section Search");
      return;
    }
    if (!section.get("Relative to").empty())
      search.unit = quantity(section, "Relative to", section.get("Relative to"));
    search.from = section.get_double("From");
    search.to = section.get_double("To");
    search.tolerance = section.get_double("Tolerance");
    if (!(search.from < search.to))
      section.fail("To", "the largest value tried is not larger than the smallest");
    const std::vector<std::string> limits = section.get_list("At most");
    for (const QuantityOfInterest &bound : quantities(section, "Quantities of interest"))
      search.bounds.push_back(bound);
    if (limits.size() != search.bounds.size())
      section.fail("At most", "there are " + std::to_string(limits.size()) + " bounds for " +
                                  std::to_string(search.bounds.size()) + " quantities");
    for (const std::string &limit : limits)
      search.limits.push_back(number(section, "At most", limit));
    if (!targets.empty())
      section.parent().subsection("Error").fail(
          "Quantities of interest",
          "with a search the value that was found is what the study measures");
  }

  void StudySettings::read_measurement(const Section &section)
  {
    const std::string entry = "Measurement";
    std::istringstream words(section.get(entry));
    std::string word;
    while (words >> word)
      measurement.push_back(word);
    if (measurement.empty())
      return;
    measurement.front() = resolved(section, entry, measurement.front());
    if (measurement.front().find('/') == std::string::npos)
      measurement.front().insert(0, "./"); // else it is looked for in PATH
    if (access(measurement.front().c_str(), X_OK) != 0)
      section.fail(entry, measurement.front() + " is no program that may be run");
    if (section.get(entry).find(output_mark) == std::string::npos)
      section.fail(entry, std::string("the program is not told where the run is; expected is ") +
                              output_mark + " among its arguments");
    if (!section.subsection("Search").get("Entry").empty())
      section.fail(entry, "a search measures what the runs alone leave behind");
  }

  std::string StudySettings::resolved(const Section &section, const std::string &entry,
                                      const std::string &file) const
  {
    const std::filesystem::path path = std::filesystem::path(directory) / file;
    if (!std::filesystem::is_regular_file(path))
      section.fail(entry, "there is no file " + path.string());
    return path.lexically_normal().string();
  }

  std::vector<std::vector<unsigned int>> StudySettings::choices() const
  {
    std::vector<std::vector<unsigned int>> all;
    std::set<std::vector<unsigned int>> known;
    for (const Grid &grid : grids)
    {
      std::vector<std::vector<unsigned int>> some(
          1, std::vector<unsigned int>(factors.size(), untouched));
      for (const Grid::Axis &axis : grid.axes)
      {
        std::vector<std::vector<unsigned int>> more;
        for (const auto &choice : some)
          for (const unsigned int value : axis.values)
          {
            more.push_back(choice);
            more.back()[axis.factor] = value;
          }
        some = std::move(more);
      }
      for (const auto &choice : some)
        if (known.insert(choice).second)
          all.push_back(choice);
    }
    return all;
  }
} // namespace tombolo
