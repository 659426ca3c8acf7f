// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/study_report.h>

#include <tombolo/base/format.h>
#include <tombolo/base/json.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <ostream>
#include <sstream>

namespace tombolo
{
  namespace
  {

    std::string rounded(const double value, const int digits = 4)
    {
      if (!std::isfinite(value))
        return "–";
      std::ostringstream text;
      text.precision(digits);
      text << value;
      return text.str();
    }

    /** "× 1.6", "÷ 1.6" or "unchanged". */
    std::string ratio_text(const double ratio)
    {
      const double size = std::max(ratio, 1. / ratio);
      if (size < 1.005)
        return "unchanged";
      std::ostringstream text;
      text.precision(size < 1.1 || size > 99. ? 3 : 2);
      text << (ratio > 1. ? "× " : "÷ ") << size;
      return text.str();
    }

    /** Geometric mean and range of ratios. */
    struct Ratios
    {
      double sum = 0, smallest = std::numeric_limits<double>::infinity(), largest = 0;
      unsigned int n = 0;

      void add(const double ratio)
      {
        if (!(ratio > 0 && std::isfinite(ratio)))
          return;
        sum += std::log(ratio);
        smallest = std::min(smallest, ratio);
        largest = std::max(largest, ratio);
        ++n;
      }

      std::string text(const std::string &what) const
      {
        if (n == 0)
          return what + " –";
        std::string result = what + " " + ratio_text(std::exp(sum / n));
        if (n > 1 && largest > 1.05 * smallest)
          result += " (" + ratio_text(smallest) + " to " + ratio_text(largest) + ")";
        return result;
      }
    };
  } // namespace

  StudyReport::StudyReport(const StudySettings &study, const std::vector<StudyRun> &runs)
      : study(study), runs(runs)
  {
    for (const StudyRun &run : runs)
      if (!study.reference_run.empty() && run.choice == study.reference_run)
        reference = &run;
    for (const StudyRun &run : runs)
      run_errors.push_back(error_of(run));
    if (!study.has_search)
      find_front();
  }

  const std::vector<double> &StudyReport::errors() const
  {
    return run_errors;
  }

  const std::vector<std::size_t> &StudyReport::front() const
  {
    return best;
  }

  double StudyReport::error_of(const StudyRun &run) const
  {
    if (run.values.empty())
      return no_value;
    if (study.has_search)
      return run.values.front();
    if (!study.reference_run.empty() && (reference == &run || reference->values.empty()))
      return no_value;
    double sum = 0, sum_of_squares = 0, largest = 0;
    for (std::size_t i = 0; i < run.values.size(); ++i)
    {
      const Target &target = study.targets[i];
      double error = std::abs(run.values[i]);
      if (reference != nullptr || target.has_reference)
      {
        const double right = reference != nullptr ? reference->values[i] : target.reference;
        error = std::abs((run.values[i] - right) / right);
      }
      sum += error;
      sum_of_squares += error * error;
      largest = std::max(largest, error);
    }
    const double n = double(run.values.size());
    return study.combination == "mean"      ? sum / n
           : study.combination == "largest" ? largest
                                            : std::sqrt(sum_of_squares / n);
  }

  void StudyReport::find_front()
  {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < runs.size(); ++i)
      if (std::isfinite(run_errors[i]))
        order.push_back(i);
    std::sort(order.begin(), order.end(),
              [&](const std::size_t a, const std::size_t b)
              {
                return std::make_pair(runs[a].cost, run_errors[a]) <
                       std::make_pair(runs[b].cost, run_errors[b]);
              });
    double smallest = std::numeric_limits<double>::infinity();
    for (const std::size_t i : order)
      if (run_errors[i] < smallest)
      {
        best.push_back(i);
        smallest = run_errors[i];
      }
  }

  std::string StudyReport::label_of(const StudyRun &run, const unsigned int factor) const
  {
    const unsigned int value = run.choice[factor];
    return value == StudySettings::untouched ? "" : study.factors[factor].values[value].label;
  }

  void StudyReport::add_steps(const unsigned int factor, std::vector<std::string> &text) const
  {
    // Runs that agree in all other factors, by the value of this one.
    std::map<std::vector<unsigned int>, std::map<unsigned int, std::size_t>> families;
    for (std::size_t i = 0; i < runs.size(); ++i)
    {
      std::vector<unsigned int> others = runs[i].choice;
      const unsigned int value = others[factor];
      others[factor] = StudySettings::untouched;
      if (value != StudySettings::untouched && std::isfinite(run_errors[i]))
        families[others][value] = i;
    }
    std::map<std::pair<unsigned int, unsigned int>, std::pair<Ratios, Ratios>> steps;
    for (const auto &[others, family] : families)
      for (auto from = family.begin(), to = family.begin(); from != family.end(); from = to)
      {
        if (++to == family.end())
          break;
        auto &[error, cost] = steps[{from->first, to->first}];
        error.add(run_errors[to->second] / run_errors[from->second]);
        cost.add(runs[to->second].cost / runs[from->second].cost);
      }
    for (const auto &[step, ratios] : steps)
    {
      const auto &values = study.factors[factor].values;
      const auto &[error, cost] = ratios;
      std::string sentence = study.factors[factor].name + " " + values[step.first].label + " → " +
                             values[step.second].label + ": " +
                             error.text(study.has_search ? study.search.entry : "error");
      if (!study.has_search)
        sentence += ", " + cost.text("time");
      if (error.n > 1)
        sentence += ", " + std::to_string(error.n) + " pairs";
      text.push_back(sentence + ".");
    }
  }

  void StudyReport::add_failures(const unsigned int factor, std::vector<std::string> &text) const
  {
    const auto &values = study.factors[factor].values;
    for (unsigned int v = 0; v < values.size(); ++v)
    {
      unsigned int n = 0, n_failed = 0;
      for (const StudyRun &run : runs)
        if (run.choice[factor] == v)
        {
          ++n;
          n_failed += run.state != RunState::measured;
        }
      if (n_failed > 0)
        text.push_back(study.factors[factor].name + " " + values[v].label + ": " +
                       std::to_string(n_failed) + " of " + std::to_string(n) +
                       " runs without a result.");
    }
  }

  std::vector<std::string> StudyReport::sentences() const
  {
    std::vector<std::string> text;
    for (unsigned int factor = 0; factor < study.factors.size(); ++factor)
    {
      add_steps(factor, text);
      add_failures(factor, text);
    }
    return text;
  }

  std::string StudyReport::conclusions() const
  {
    std::string text;
    if (!best.empty())
      text +=
          "The best for what they cost (" + study.error_name + " at " + study.cost_name + "):\n";
    for (const std::size_t i : best)
      text += "  " + rounded(run_errors[i]) + " at " + rounded(runs[i].cost) + ": " +
              runs[i].label + "\n";
    text += "Steps of the factors:\n";
    for (const std::string &sentence : sentences())
      text += "  " + sentence + "\n";
    if (study.at_a_time > 1)
      text += "Runs were made " + std::to_string(study.at_a_time) +
              " at a time: what they cost is disturbed.\n";
    return text;
  }

  void StudyReport::write_csv(std::ostream &out) const
  {
    out << "member";
    for (const Factor &factor : study.factors)
      out << "," << csv_field(factor.name);
    out << ",state," << csv_field(study.has_search ? study.search.entry : study.error_name) << ","
        << csv_field(study.has_search ? "wall time of all runs [s]" : study.cost_name)
        << ",on the front";
    for (const Target &target : study.targets)
      out << "," << csv_field(target.quantity.text());
    for (const QuantityOfInterest &column : study.columns)
      out << "," << csv_field(column.text());
    out << ",runs,message\n";
    out.precision(10);
    const auto number = [&](const double value)
    {
      out << ",";
      if (std::isfinite(value))
        out << value;
    };
    for (std::size_t i = 0; i < runs.size(); ++i)
    {
      const StudyRun &run = runs[i];
      out << csv_field(run.name);
      for (unsigned int factor = 0; factor < study.factors.size(); ++factor)
        out << "," << csv_field(label_of(run, factor));
      out << "," << name_of(run.state);
      number(run_errors[i]);
      number(run.n_executions > 0 ? run.cost : no_value);
      out << "," << (std::count(best.begin(), best.end(), i) > 0 ? 1 : 0);
      for (std::size_t v = 0; v < study.targets.size(); ++v)
        number(v < run.values.size() ? run.values[v] : no_value);
      for (const double value : run.columns)
        number(value);
      out << "," << run.n_executions << "," << csv_field(run.message) << "\n";
    }
  }

  void StudyReport::write_json(std::ostream &out) const
  {
    Json root = Json::object();
    root["title"] = study.title;
    root["error_name"] = study.has_search ? study.search.entry : study.error_name;
    root["cost_name"] = study.cost_name;
    root["picture"] = study.picture;
    root["logarithmic_values"] = study.logarithmic_values;
    Json &factors = root["knobs"] = Json::array();
    for (const Factor &factor : study.factors)
    {
      Json of = Json::object();
      of["name"] = factor.name;
      Json &labels = of["labels"] = Json::array();
      for (const Factor::Value &value : factor.values)
        labels.push_back(value.label);
      factors.push_back(of);
    }
    Json &grids = root["grids"] = Json::array();
    for (const Grid &grid : study.grids)
    {
      Json of = Json::object();
      of["text"] = grid.text;
      Json &axes = of["axes"] = Json::array();
      for (const Grid::Axis &axis : grid.axes)
      {
        Json one = Json::object();
        one["knob"] = axis.factor;
        one["values"] = Json(axis.values);
        axes.push_back(one);
      }
      grids.push_back(of);
    }
    Json &all = root["members"] = Json::array();
    for (std::size_t i = 0; i < runs.size(); ++i)
    {
      Json of = Json::object();
      of["name"] = runs[i].name;
      Json &choice = of["choice"] = Json::array();
      for (const unsigned int value : runs[i].choice)
        choice.push_back(value == StudySettings::untouched ? Json() : Json(value));
      of["state"] = name_of(runs[i].state);
      of["error"] = run_errors[i];
      of["cost"] = runs[i].cost;
      of["on_front"] = std::count(best.begin(), best.end(), i) > 0;
      of["message"] = runs[i].message;
      all.push_back(of);
    }
    Json &text = root["sentences"] = Json::array();
    for (const std::string &sentence : sentences())
      text.push_back(sentence);
    out << json_text(root);
  }

  void StudyReport::write_markdown(std::ostream &out) const
  {
    out << "# " << study.title << "\n\n|";
    for (const Factor &factor : study.factors)
      out << " " << factor.name << " |";
    out << " " << (study.has_search ? study.search.entry : study.error_name) << " | "
        << (study.has_search ? "remark |" : study.cost_name + " | front |");
    for (const QuantityOfInterest &column : study.columns)
      out << " " << column.text() << " |";
    out << "\n|";
    for (std::size_t c = 0; c < study.factors.size() + study.columns.size() + 2; ++c)
      out << " --- |";
    out << (study.has_search ? "\n" : " --- |\n");
    for (std::size_t i = 0; i < runs.size(); ++i)
    {
      const StudyRun &run = runs[i];
      out << "|";
      for (unsigned int factor = 0; factor < study.factors.size(); ++factor)
        out << " " << label_of(run, factor) << " |";
      const bool has_result = run.state == RunState::measured;
      out << " " << (has_result ? rounded(run_errors[i]) : name_of(run.state)) << " | ";
      if (study.has_search)
        out << run.message << " |";
      else
        out << (has_result ? rounded(run.cost, 3) : run.message) << " | "
            << (std::count(best.begin(), best.end(), i) > 0 ? "yes" : "") << " |";
      for (const double value : run.columns)
        out << " " << rounded(value) << " |";
      out << "\n";
    }
    out << "\n";
    for (const std::string &sentence : sentences())
      out << "- " << sentence << "\n";
  }
} // namespace tombolo
