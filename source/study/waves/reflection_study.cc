// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/waves/reflection_study.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/base/input/section_names.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/output/summary.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/numbers.h>

#include <nlohmann/json.hpp>

#include <boost/serialization/vector.hpp>

#include <chrono>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    double number(const Section &section, const std::string &entry, const std::string &text)
    {
      try
      {
        std::size_t length = 0;
        const double value = std::stod(text, &length);
        if (length == text.size() && std::isfinite(value))
          return value;
      }
      catch (const std::exception &)
      {}
      section.fail(entry, "\"" + text + "\" is not a number");
    }

    /** The numbers of a list, each within [lowest, highest]. */
    std::vector<double> numbers_within(const Section &section, const std::string &entry,
                                       const double lowest, const double highest)
    {
      std::vector<double> values;
      for (const std::string &text : section.get_list(entry))
      {
        values.push_back(number(section, entry, text));
        if (!(values.back() >= lowest && values.back() <= highest))
        {
          std::ostringstream message;
          message << text << " is outside of what is allowed, " << lowest << " to " << highest;
          section.fail(entry, message.str());
        }
      }
      if (values.empty())
        section.fail(entry, "the list is empty: the group has no cases");
      return values;
    }

    /** "1/3" or "0.5". */
    double ratio(const Section &section, const std::string &entry, const std::string &text)
    {
      const std::size_t slash = text.find('/');
      double value = number(section, entry, text.substr(0, slash));
      if (slash != std::string::npos)
        value /= number(section, entry, text.substr(slash + 1));
      if (!(value >= 0.1 && value <= 10.))
        section.fail(entry, text + " is outside of what is allowed, 1/10 to 10");
      return value;
    }

    SideKind side_kind(const std::string &name)
    {
      return name != "FE" ? SideKind::particles : SideKind::elements;
    }

    std::string name_of(const SideKind kind)
    {
      return kind == SideKind::particles ? "particles" : "FE";
    }

    std::string name_of_right(const ReflectionCase &of)
    {
      return (of.is_one_part ? "same " : "") + name_of(of.right);
    }

    constexpr const char *wave_names = "PS";

    char name_of(const WaveType wave)
    {
      return wave_names[static_cast<unsigned int>(wave)];
    }

    constexpr double percent = 100.;
  } // namespace

  void ReflectionStudy::declare_parameters(Parameters &parameters)
  {
    const Entries run(parameters.handler());
    run.text("Title", "", "", "A title for tables and pictures.");
    run.text("Output directory", "output/reflection_study", "",
             "Where the study leaves its results; made if it does not exist.");
    run.text("Groups", mandatory, "",
             "Names of the groups of cases, each with a section `Group: NAME`. The cases of a "
             "group are the product of its lists.");
    run.text("Plugin libraries", "", "",
             "Shared objects with further elements, loaded before all else is read.");
    for (const std::string &name : section_names(parameters, "Groups"))
    {
      const Entries e = run.subsection("Group: " + name);
      const Patterns::List list_of_texts(Patterns::Anything(), 1);
      e.text("Title", "", "", "What the group shows.");
      e.entry(
          "Pairs", mandatory,
          Patterns::List(
              Patterns::Selection(
                  "FE-FE|FE-particles|particles-FE|particles-particles|particles-same particles"),
              1),
          "",
          "What the wave comes from and what it meets. Particles and particles are two parts that "
          "share nodes; `same particles` are of the same part, and all see each other.");
      e.entry(
          "Elements", "fully integrated hexahedron",
          Patterns::List(Patterns::Selection(Registry<Formulation<2>>::instance().selection()), 1),
          "", "Formulations of the sides called FE, of degree 1.");
      e.entry("Spacing ratios", "1", list_of_texts, "",
              "Spacing of the right side over that of the left, numbers or fractions such as 1/3.");
      e.number("Spacing along the interface", "1", between(0.1, 10.), "",
               "Of both sides, over the coarser one across the interface.");
      e.entry("Dilations", "1.8", list_of_texts, "",
              "Support half width of the particles over their spacing.");
      e.text("Kernel", "", "", "The particles' kernel; empty is their default.");
      e.entry("Smoothings", "paper", list_of_texts, "",
              "The particles' smoothing, as in a part's section.");
      e.entry("Bridges", "paper", Patterns::List(Patterns::Selection("paper|trace"), 1), "",
              "How elements and particles share nodes.");
      e.entry("Filter powers", "0", list_of_texts, "", "p of the lattice filter; 0 is no filter.");
      e.entry("Filter strengths", "0.5", list_of_texts, "", "beta of the lattice filter.");
      e.integer("Filter interval", "3", between(1, 1000),
                "The filter is applied every so many steps.");
      e.entry("Poisson's ratios", "0", list_of_texts, "", "Of the material on both sides.");
      e.entry("Waves", "P", Patterns::List(Patterns::Selection("P|S"), 1), "",
              "Types of the incident wave.");
      e.entry("Angles", "0", list_of_texts, "degrees",
              "Between the direction of the wave and the normal.");
      e.entry("Wavelengths", "20", list_of_texts, "",
              "Of the incident wave, over the coarser spacing.");
      e.number("Cycles", "8", between(8., 100.), "",
               "Wavelengths in the Hann burst, counted along the normal.");
      e.number("Step factor", "0.9", between(0.01, 1.), "",
               "The time step is this fraction of the stable one.");
      e.text("Reference", "", "%",
             "Reflections to print beside those computed, in the order of the cases: the lists "
             "from the first in this section, Pairs, to the last, Wavelengths, which changes "
             "fastest; `-` where there is none.");
    }
  }

  ReflectionStudy::ReflectionStudy(const Parameters &parameters, MPI_Comm communicator)
      : parameters(parameters), communicator(communicator)
  {
    const std::vector<std::string> names = section_names(parameters, "Groups");
    if (names.empty())
      parameters.section("").fail("Groups", "a study needs at least one group of cases");
    for (const std::string &name : names)
      all_groups.push_back(read_group(parameters.section("Group: " + name)));
  }

  ReflectionStudy::Group ReflectionStudy::read_group(const Section &section) const
  {
    Group group;
    group.name = section.name();
    group.title = section.get("Title");
    Row row;
    ReflectionCase &settings = row.settings;
    settings.kernel = section.get("Kernel");
    settings.row_spacing = section.get_double("Spacing along the interface");
    settings.cycles = section.get_double("Cycles");
    settings.step_factor = section.get_double("Step factor");
    settings.filter.interval = section.get_unsigned("Filter interval");
    const auto wavelengths = numbers_within(section, "Wavelengths", 4., 1000.);
    const auto angles = numbers_within(section, "Angles", 0., 80.);
    const auto poissons_ratios = numbers_within(section, "Poisson's ratios", -0.9, 0.499);
    const auto strengths = numbers_within(section, "Filter strengths", 0., 10.);
    const auto powers = numbers_within(section, "Filter powers", 0., 16.);
    const auto dilations = numbers_within(section, "Dilations", 1., 4.);

    for (const std::string &pair : section.get_list("Pairs"))
      for (const std::string &element : section.get_list("Elements"))
        for (const std::string &ratio_text : section.get_list("Spacing ratios"))
          for (const double dilation : dilations)
            for (const std::string &smoothing : section.get_list("Smoothings"))
              for (const std::string &bridge : section.get_list("Bridges"))
                for (const double power : powers)
                  for (const double strength : strengths)
                    for (const double poissons_ratio : poissons_ratios)
                    {
                      const std::size_t dash = pair.find('-');
                      settings.left = side_kind(pair.substr(0, dash));
                      settings.right = side_kind(pair.substr(dash + 1));
                      settings.is_one_part = pair == "particles-same particles";
                      settings.element = element;
                      row.ratio = ratio_text;
                      settings.spacing_ratio = ratio(section, "Spacing ratios", ratio_text);
                      settings.dilation = dilation;
                      settings.smoothing = smoothing;
                      settings.bridge = bridge;
                      if (power != std::floor(power))
                        section.fail("Filter powers", "a power is a whole number");
                      settings.filter.power = static_cast<unsigned int>(power);
                      settings.filter.strength = strength;
                      settings.poissons_ratio = poissons_ratio;
                      for (const std::string &wave : section.get_list("Waves"))
                        for (const double angle : angles)
                          for (const double wavelength : wavelengths)
                          {
                            settings.wave = wave == "P" ? WaveType::P : WaveType::S;
                            row.degrees = angle;
                            settings.angle = angle * numbers::PI / 180.;
                            settings.wavelength = wavelength;
                            group.rows.push_back(row);
                          }
                    }

    const std::vector<std::string> references = section.get_list("Reference");
    if (!references.empty() && references.size() != group.rows.size())
      section.fail("Reference", "there are " + std::to_string(references.size()) +
                                    " values for the " + std::to_string(group.rows.size()) +
                                    " cases of the group");
    for (std::size_t i = 0; i < references.size(); ++i)
      if (references[i] != "-")
        group.rows[i].reference = number(section, "Reference", references[i]);
    return group;
  }

  unsigned int ReflectionStudy::n_cases() const
  {
    std::size_t n = 0;
    for (const Group &group : all_groups)
      n += group.rows.size();
    return static_cast<unsigned int>(n);
  }

  void ReflectionStudy::compute(Group &group) const
  {
    const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(communicator);
    const unsigned int rank = Utilities::MPI::this_mpi_process(communicator);
    std::string failure;
    bool is_input_error = false;
    std::unique_ptr<ReflectionModel> model;
    std::vector<std::pair<ReflectionResult, double>> mine;
    for (std::size_t i = rank; i < group.rows.size() && failure.empty(); i += n_ranks)
    {
      const auto start = std::chrono::steady_clock::now();
      const ReflectionCase &settings = group.rows[i].settings;
      try
      {
        if (!model || !model->fits(settings))
          model = std::make_unique<ReflectionModel>(settings);
        const ReflectionResult result = model->run(settings);
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
        mine.emplace_back(result, elapsed.count());
      }
      catch (const InputError &error)
      {
        is_input_error = true;
        failure = error.what();
      }
      catch (const std::exception &error)
      {
        failure = error.what();
      }
      if (!failure.empty())
        failure = "case " + std::to_string(i + 1) + " of the group cannot be computed: " + failure;
    }

    // One rank alone may have failed; all leave together.
    for (const auto &[text, is_input] :
         Utilities::MPI::all_gather(communicator, std::make_pair(failure, is_input_error)))
      if (!text.empty())
      {
        const Section section = parameters.section("Group: " + group.name);
        if (is_input)
          section.fail("", text);
        throw RunError(section.describe("") + ": " + text);
      }
    const auto results = Utilities::MPI::all_gather(communicator, mine);
    for (std::size_t i = 0; i < group.rows.size(); ++i)
      std::tie(group.rows[i].result, group.rows[i].seconds) = results[i % n_ranks][i / n_ranks];
  }

  std::string ReflectionStudy::table_of(const Group &group) const
  {
    std::ostringstream out;
    out << "\n" << group.name << (group.title.empty() ? "" : ": " + group.title) << "\n";
    out << "pair                      ratio  dilation smoothing   bridge filter    nu    wave "
           "angle  "
           "lambda/h"
           "   |R| %  conv. %  total %     v %  v_hat %";
    const bool has_exact =
        std::any_of(group.rows.begin(), group.rows.end(),
                    [](const Row &row) { return std::isfinite(row.result.exact); });
    const bool has_reference =
        std::any_of(group.rows.begin(), group.rows.end(),
                    [](const Row &row) { return std::isfinite(row.reference); });
    out << (has_exact ? "  exact %" : "") << (has_reference ? "  reference %" : "") << "\n";
    const auto print_percent = [&](const int width, const double value)
    {
      out << std::setw(width);
      if (std::isfinite(value))
        out << std::fixed << std::setprecision(3) << percent * value << std::defaultfloat;
      else
        out << "-";
    };
    for (const Row &row : group.rows)
    {
      const ReflectionCase &of = row.settings;
      std::ostringstream filter;
      if (of.filter.power > 0)
        filter << of.filter.power << ", " << of.filter.strength;
      else
        filter << "-";
      out << std::left << std::setw(26) << name_of(of.left) + "-" + name_of_right(of)
          << std::setw(7) << row.ratio << std::setw(9) << of.dilation << std::setw(12)
          << of.smoothing << std::setw(7) << of.bridge << std::setw(10) << filter.str()
          << std::setw(6) << of.poissons_ratio << std::setw(5) << name_of(of.wave) << std::right
          << std::setw(5) << row.degrees << std::setw(10) << of.wavelength;
      print_percent(8, row.result.reflection);
      print_percent(9, row.result.converted);
      print_percent(9, row.result.total);
      print_percent(8, row.result.smoothed);
      print_percent(9, row.result.unsmoothed);
      if (has_exact)
        print_percent(9, row.result.exact);
      if (has_reference)
        print_percent(13, row.reference / percent);
      out << "\n";
    }
    return out.str();
  }

  void ReflectionStudy::write_csv(std::ostream &out) const
  {
    out << "group,left,right,element,spacing_ratio,spacing_along "
           "[h],dilation,smoothing,bridge,filter_power,"
           "filter_strength,filter_interval,poissons_ratio,wave,angle [degrees],wavelength [h],"
           "reflection [%],converted [%],total [%],smoothed [%],unsmoothed [%],"
           "transmitted_energy [%],exact [%],reference [%],phase_error [%],fit_error [%],"
           "remaining [%],frequency [c/h],group_velocity [c],time_step [h/c],steps,columns,"
           "wall_time [s]\n";
    out.precision(8);
    const auto print = [&](const double value)
    {
      out << ',';
      if (std::isfinite(value))
        out << value;
    };
    for (const Group &group : all_groups)
      for (const Row &row : group.rows)
      {
        const ReflectionCase &of = row.settings;
        const ReflectionResult &result = row.result;
        out << group.name << ',' << name_of(of.left) << ',' << name_of_right(of) << ','
            << of.element << ',' << row.ratio << ',' << of.row_spacing << ',' << of.dilation << ','
            << of.smoothing << ',' << of.bridge << ',' << of.filter.power << ','
            << of.filter.strength << ',' << of.filter.interval << ',' << of.poissons_ratio << ','
            << name_of(of.wave) << ',' << row.degrees << ',' << of.wavelength;
        for (const double value :
             {result.reflection, result.converted, result.total, result.smoothed, result.unsmoothed,
              result.transmitted_energy, result.exact, row.reference / percent, result.phase_error,
              result.fit_error, result.remaining})
          print(percent * value);
        for (const double value : {result.frequency, result.group_velocity, result.time_step,
                                   result.n_steps, result.n_columns, row.seconds})
          print(value);
        out << '\n';
      }
  }

  void ReflectionStudy::run(Log &log, const OutputDirectory &directory)
  {
    Summary summary(communicator);
    double largest_calibration_error = 0;
    unsigned int n_calibrations = 0;
    for (Group &group : all_groups)
    {
      compute(group);
      log.print(table_of(group));
      for (const Row &row : group.rows)
        if (row.result.exact > 0.)
        {
          ++n_calibrations;
          largest_calibration_error = std::max(
              largest_calibration_error, std::abs(row.result.reflection / row.result.exact - 1.));
        }
    }
    directory.write("reflection.csv", [&](std::ostream &out) { write_csv(out); });
    summary.results()["cases"] = n_cases();
    if (n_calibrations > 0)
    {
      summary.results()["cases_with_exact_reflection"] = n_calibrations;
      summary.results()["largest_relative_error_against_exact_reflection"] =
          largest_calibration_error;
    }
    summary.write(directory);
    log.print("\n" + std::to_string(n_cases()) + " cases, written to " +
              directory.file("reflection.csv"));
  }
} // namespace tombolo
