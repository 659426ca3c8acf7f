// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/study_run.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/json.h>
#include <tombolo/study/child_process.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <thread>

namespace tombolo
{
  namespace
  {
    constexpr std::array<const char *, 6> state_names = {
        {"measured", "refused", "stopped", "no value", "timed out", "crashed"}};

    struct RunOutcome
    {
      MemberState state;
      std::string message;
    };

    /** What the program says after "Error: " or "The run stopped: ", on one line. */
    std::string words_of(const std::string &screen_file)
    {
      std::ifstream in(screen_file);
      const std::string screen((std::istreambuf_iterator<char>(in)), {});
      for (const std::string mark : {"\nError: ", "\nThe run stopped: "})
      {
        const std::size_t found = screen.rfind(mark);
        if (found == std::string::npos)
          continue;
        const std::size_t begin = found + mark.size();
        std::size_t end = screen.find("\nThe outputs written before", begin);
        end = std::min(end, screen.find("\n\n", begin));
        std::istringstream words(screen.substr(begin, end - begin));
        std::string text, word;
        while (words >> word)
          text += (text.empty() ? "" : " ") + word;
        return text;
      }
      return {};
    }

    class Runner
    {
    public:
      Runner(const StudySettings &study, const MemberSetting &setting, StudyRun &member)
          : study(study), setting(setting), member(member),
            output(setting.directory + "/" + member.name)
      {}

      void measure()
      {
        for (unsigned int repetition = 0; repetition < study.repetitions; ++repetition)
        {
          const RunOutcome outcome = run({});
          member.state = outcome.state;
          member.message = outcome.message;
          if (outcome.state != MemberState::measured || !read_values())
            return;
        }
      }

      void search()
      {
        member.state = MemberState::measured;
        member.cost = 0;
        const Search &of = study.search;
        if (of.unit && !find_unit(*of.unit))
          return;
        if (succeeds(of.to))
        {
          member.values = {of.to};
          member.message = "succeeds at the largest value tried";
          return;
        }
        const std::string why = last_failure.message;
        double failing = of.to;
        if (!succeeds(of.from))
        {
          member.state = last_failure.state == MemberState::measured ? MemberState::no_value
                                                                     : last_failure.state;
          member.message = "fails at the smallest value tried: " + last_failure.message;
          return;
        }
        double succeeding = of.from;
        member.message = why;
        while (failing > (1. + of.tolerance) * succeeding)
        {
          const double middle = std::sqrt(succeeding * failing);
          if (succeeds(middle))
            succeeding = middle;
          else
          {
            failing = middle;
            member.message = last_failure.message;
          }
        }
        member.values = {succeeding};
        member.message = "beyond: " + member.message;
      }

    private:
      RunOutcome run(const std::vector<std::string> &more_settings)
      {
        std::vector<std::string> command;
        if (study.ranks > 1)
          command = {"mpirun", "-n", std::to_string(study.ranks)};
        command.insert(command.end(), {setting.program, member.base_file, "--quiet"});
        std::vector<std::string> settings = member.settings;
        settings.insert(settings.end(), more_settings.begin(), more_settings.end());
        settings.push_back("Output directory = " + output);
        for (const std::string &assignment : settings)
          command.insert(command.end(), {"--set", assignment});

        std::error_code ignored;
        std::filesystem::remove(output + "/summary.json", ignored);
        const std::string screen = output + ".txt";
        const auto start = std::chrono::steady_clock::now();
        ChildProcess process(command, screen, study.time_limit);
        while (!process.has_ended())
        {
          if (setting.is_interrupted())
            throw StudyInterrupted();
          std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
        ++member.n_runs;
        if (study.has_search)
          member.cost += elapsed.count();

        const ExitState &end = process.exit_state();
        if (end.kind == ExitState::Kind::timed_out)
          return {MemberState::timed_out, "it took longer than the time limit"};
        if (end.kind == ExitState::Kind::killed_by_signal)
          return {MemberState::crashed, "signal " + std::to_string(end.code)};
        if (end.code == 0)
          return {MemberState::measured, ""};
        const std::string words = words_of(screen);
        if (words.empty() || end.code > 2)
          return {MemberState::crashed,
                  "exit code " + std::to_string(end.code) + (words.empty() ? "" : ": " + words)};
        return {end.code == 1 ? MemberState::refused : MemberState::stopped, words};
      }

      /** Runs the member as it is and takes the unit of the search from it. */
      bool find_unit(const QuantityOfInterest &measure)
      {
        const RunOutcome outcome = run({});
        member.state = outcome.state;
        member.message = outcome.message;
        if (outcome.state != MemberState::measured)
          return false;
        try
        {
          unit = measure.value(output);
        }
        catch (const RunError &error)
        {
          member.state = MemberState::no_value;
          member.message = error.what();
          return false;
        }
        return true;
      }

      bool succeeds(const double value)
      {
        std::ostringstream text;
        text.precision(12);
        text << study.search.entry << " = " << value * unit;
        last_failure = run({text.str()});
        if (last_failure.state != MemberState::measured)
          return false;
        for (std::size_t i = 0; i < study.search.bounds.size(); ++i)
        {
          double found = 0;
          try
          {
            found = study.search.bounds[i].value(output);
          }
          catch (const RunError &error)
          {
            last_failure = {MemberState::no_value, error.what()};
            return false;
          }
          if (!(std::abs(found) <= study.search.limits[i]))
          {
            std::ostringstream message;
            message << study.search.bounds[i].text() << " is " << found;
            last_failure.message = message.str();
            return false;
          }
        }
        return true;
      }

      bool read_values()
      {
        try
        {
          member.values.clear();
          for (const Target &target : study.targets)
            member.values.push_back(target.measure.value(output));
          const double cost = study.cost.value(output);
          member.cost = member.n_runs > 1 ? std::min(member.cost, cost) : cost;
        }
        catch (const RunError &error)
        {
          member.state = MemberState::no_value;
          member.message = error.what();
          return false;
        }
        member.columns.assign(study.columns.size(), no_value);
        for (std::size_t i = 0; i < study.columns.size(); ++i)
          try
          {
            member.columns[i] = study.columns[i].value(output);
          }
          catch (const RunError &)
          {} // a member without cells has no time per cell
        return true;
      }

      const StudySettings &study;
      const MemberSetting &setting;
      StudyRun &member;
      const std::string output;
      double unit = 1;
      RunOutcome last_failure{MemberState::measured, ""};
    };

    std::string record_file(const StudyRun &member, const std::string &directory)
    {
      return directory + "/" + member.name + ".json";
    }

    std::vector<double> numbers_of(const Json &values)
    {
      std::vector<double> numbers;
      for (const Json &value : values)
        numbers.push_back(value.is_null() ? no_value : value.get<double>());
      return numbers;
    }
  } // namespace

  std::string name_of(const MemberState state)
  {
    return state_names[static_cast<std::size_t>(state)];
  }

  void run_member(const StudySettings &study, const MemberSetting &setting, StudyRun &member)
  {
    Runner runner(study, setting, member);
    member.n_runs = 0;
    if (study.has_search)
      runner.search();
    else
      runner.measure();
    if (member.state != MemberState::measured)
      member.values.clear();
    member.columns.resize(study.columns.size(), no_value);
  }

  void write_record(const StudyRun &member, const std::string &directory)
  {
    Json record = Json::object();
    record["key"] = member.key;
    record["label"] = member.label;
    record["state"] = name_of(member.state);
    record["message"] = member.message;
    record["values"] = Json(member.values);
    record["columns"] = Json(member.columns);
    record["cost"] = member.cost;
    record["runs"] = member.n_runs;
    const std::string file = record_file(member, directory);
    {
      std::ofstream out(file + ".part");
      out << json_text(record);
      if (!out.flush())
        throw RunError("The results of a member cannot be written to " + file + ".");
    }
    std::filesystem::rename(file + ".part", file);
  }

  bool read_record(StudyRun &member, const std::string &directory)
  {
    try
    {
      std::ifstream in(record_file(member, directory));
      const Json record = Json::parse(in);
      if (record.at("key") != member.key)
        return false;
      const std::string state = record.at("state");
      const auto found = std::find(state_names.begin(), state_names.end(), state);
      if (found == state_names.end())
        return false;
      member.state = static_cast<MemberState>(found - state_names.begin());
      member.message = record.at("message");
      member.values = numbers_of(record.at("values"));
      member.columns = numbers_of(record.at("columns"));
      member.cost = record.at("cost");
      member.n_runs = record.at("runs");
      return true;
    }
    catch (const Json::exception &)
    {
      return false; // none, or one that cannot be read: the member runs again
    }
  }
} // namespace tombolo
