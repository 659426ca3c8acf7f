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
    std::string factor(const double ratio)
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
        std::string result = what + " " + factor(std::exp(sum / n));
        if (n > 1 && largest > 1.05 * smallest)
          result += " (" + factor(smallest) + " to " + factor(largest) + ")";
        return result;
      }
    };
  } // namespace

  StudyReport::StudyReport(const StudySettings &study, const std::vector<StudyRun> &members)
      : study(study), members(members)
  {
    for (const StudyRun &member : members)
      if (!study.reference_member.empty() && member.choice == study.reference_member)
        reference = &member;
    for (const StudyRun &member : members)
      member_errors.push_back(error_of(member));
    if (!study.has_search)
      find_front();
  }

  const std::vector<double> &StudyReport::errors() const
  {
    return member_errors;
  }

  const std::vector<std::size_t> &StudyReport::front() const
  {
    return best;
  }

  double StudyReport::error_of(const StudyRun &member) const
  {
    if (member.values.empty())
      return no_value;
    if (study.has_search)
      return member.values.front();
    if (!study.reference_member.empty() && (reference == &member || reference->values.empty()))
      return no_value;
    double sum = 0, sum_of_squares = 0, largest = 0;
    for (std::size_t i = 0; i < member.values.size(); ++i)
    {
      const Target &target = study.targets[i];
      double error = std::abs(member.values[i]);
      if (reference != nullptr || target.has_reference)
      {
        const double right = reference != nullptr ? reference->values[i] : target.reference;
        error = std::abs((member.values[i] - right) / right);
      }
      sum += error;
      sum_of_squares += error * error;
      largest = std::max(largest, error);
    }
    const double n = double(member.values.size());
    return study.combination == "mean"      ? sum / n
           : study.combination == "largest" ? largest
                                            : std::sqrt(sum_of_squares / n);
  }

  void StudyReport::find_front()
  {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < members.size(); ++i)
      if (std::isfinite(member_errors[i]))
        order.push_back(i);
    std::sort(order.begin(), order.end(),
              [&](const std::size_t a, const std::size_t b)
              {
                return std::make_pair(members[a].cost, member_errors[a]) <
                       std::make_pair(members[b].cost, member_errors[b]);
              });
    double smallest = std::numeric_limits<double>::infinity();
    for (const std::size_t i : order)
      if (member_errors[i] < smallest)
      {
        best.push_back(i);
        smallest = member_errors[i];
      }
  }

  std::string StudyReport::label_of(const StudyRun &member, const unsigned int knob) const
  {
    const unsigned int value = member.choice[knob];
    return value == StudySettings::untouched ? "" : study.knobs[knob].values[value].label;
  }

  void StudyReport::add_steps(const unsigned int knob, std::vector<std::string> &text) const
  {
    // Members that agree in all other knobs, by the value of this one.
    std::map<std::vector<unsigned int>, std::map<unsigned int, std::size_t>> families;
    for (std::size_t i = 0; i < members.size(); ++i)
    {
      std::vector<unsigned int> others = members[i].choice;
      const unsigned int value = others[knob];
      others[knob] = StudySettings::untouched;
      if (value != StudySettings::untouched && std::isfinite(member_errors[i]))
        families[others][value] = i;
    }
    std::map<std::pair<unsigned int, unsigned int>, std::pair<Ratios, Ratios>> steps;
    for (const auto &[others, family] : families)
      for (auto from = family.begin(), to = family.begin(); from != family.end(); from = to)
      {
        if (++to == family.end())
          break;
        auto &[error, cost] = steps[{from->first, to->first}];
        error.add(member_errors[to->second] / member_errors[from->second]);
        cost.add(members[to->second].cost / members[from->second].cost);
      }
    for (const auto &[step, ratios] : steps)
    {
      const auto &values = study.knobs[knob].values;
      const auto &[error, cost] = ratios;
      std::string sentence = study.knobs[knob].name + " " + values[step.first].label + " → " +
                             values[step.second].label + ": " +
                             error.text(study.has_search ? study.search.entry : "error");
      if (!study.has_search)
        sentence += ", " + cost.text("time");
      if (error.n > 1)
        sentence += ", " + std::to_string(error.n) + " pairs";
      text.push_back(sentence + ".");
    }
  }

  void StudyReport::add_failures(const unsigned int knob, std::vector<std::string> &text) const
  {
    const auto &values = study.knobs[knob].values;
    for (unsigned int v = 0; v < values.size(); ++v)
    {
      unsigned int n = 0, n_failed = 0;
      for (const StudyRun &member : members)
        if (member.choice[knob] == v)
        {
          ++n;
          n_failed += member.state != MemberState::measured;
        }
      if (n_failed > 0)
        text.push_back(study.knobs[knob].name + " " + values[v].label + ": " +
                       std::to_string(n_failed) + " of " + std::to_string(n) +
                       " members without a result.");
    }
  }

  std::vector<std::string> StudyReport::sentences() const
  {
    std::vector<std::string> text;
    for (unsigned int knob = 0; knob < study.knobs.size(); ++knob)
    {
      add_steps(knob, text);
      add_failures(knob, text);
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
      text += "  " + rounded(member_errors[i]) + " at " + rounded(members[i].cost) + ": " +
              members[i].label + "\n";
    text += "Steps of the knobs:\n";
    for (const std::string &sentence : sentences())
      text += "  " + sentence + "\n";
    if (study.at_a_time > 1)
      text += "Members ran " + std::to_string(study.at_a_time) +
              " at a time: what they cost is disturbed.\n";
    return text;
  }

  void StudyReport::write_csv(std::ostream &out) const
  {
    out << "member";
    for (const Factor &knob : study.knobs)
      out << "," << csv_field(knob.name);
    out << ",state," << csv_field(study.has_search ? study.search.entry : study.error_name) << ","
        << csv_field(study.has_search ? "wall time of all runs [s]" : study.cost_name)
        << ",on the front";
    for (const Target &target : study.targets)
      out << "," << csv_field(target.measure.text());
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
    for (std::size_t i = 0; i < members.size(); ++i)
    {
      const StudyRun &member = members[i];
      out << csv_field(member.name);
      for (unsigned int knob = 0; knob < study.knobs.size(); ++knob)
        out << "," << csv_field(label_of(member, knob));
      out << "," << name_of(member.state);
      number(member_errors[i]);
      number(member.n_runs > 0 ? member.cost : no_value);
      out << "," << (std::count(best.begin(), best.end(), i) > 0 ? 1 : 0);
      for (std::size_t v = 0; v < study.targets.size(); ++v)
        number(v < member.values.size() ? member.values[v] : no_value);
      for (const double value : member.columns)
        number(value);
      out << "," << member.n_runs << "," << csv_field(member.message) << "\n";
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
    Json &knobs = root["knobs"] = Json::array();
    for (const Factor &knob : study.knobs)
    {
      Json of = Json::object();
      of["name"] = knob.name;
      Json &labels = of["labels"] = Json::array();
      for (const Factor::Value &value : knob.values)
        labels.push_back(value.label);
      knobs.push_back(of);
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
        one["knob"] = axis.knob;
        one["values"] = Json(axis.values);
        axes.push_back(one);
      }
      grids.push_back(of);
    }
    Json &all = root["members"] = Json::array();
    for (std::size_t i = 0; i < members.size(); ++i)
    {
      Json of = Json::object();
      of["name"] = members[i].name;
      Json &choice = of["choice"] = Json::array();
      for (const unsigned int value : members[i].choice)
        choice.push_back(value == StudySettings::untouched ? Json() : Json(value));
      of["state"] = name_of(members[i].state);
      of["error"] = member_errors[i];
      of["cost"] = members[i].cost;
      of["on_front"] = std::count(best.begin(), best.end(), i) > 0;
      of["message"] = members[i].message;
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
    for (const Factor &knob : study.knobs)
      out << " " << knob.name << " |";
    out << " " << (study.has_search ? study.search.entry : study.error_name) << " | "
        << (study.has_search ? "remark |" : study.cost_name + " | front |");
    for (const QuantityOfInterest &column : study.columns)
      out << " " << column.text() << " |";
    out << "\n|";
    for (std::size_t c = 0; c < study.knobs.size() + study.columns.size() + 2; ++c)
      out << " --- |";
    out << (study.has_search ? "\n" : " --- |\n");
    for (std::size_t i = 0; i < members.size(); ++i)
    {
      const StudyRun &member = members[i];
      out << "|";
      for (unsigned int knob = 0; knob < study.knobs.size(); ++knob)
        out << " " << label_of(member, knob) << " |";
      const bool has_result = member.state == MemberState::measured;
      out << " " << (has_result ? rounded(member_errors[i]) : name_of(member.state)) << " | ";
      if (study.has_search)
        out << member.message << " |";
      else
        out << (has_result ? rounded(member.cost, 3) : member.message) << " | "
            << (std::count(best.begin(), best.end(), i) > 0 ? "yes" : "") << " |";
      for (const double value : member.columns)
        out << " " << rounded(value) << " |";
      out << "\n";
    }
    out << "\n";
    for (const std::string &sentence : sentences())
      out << "- " << sentence << "\n";
  }
} // namespace tombolo
