// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/study_run.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/file_stream.h>
#include <tombolo/base/json.h>
#include <tombolo/study/child_process.h>

#include <boost/algorithm/string/replace.hpp>
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
      RunState state;
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
      Runner(const StudySettings &study, const RunSetting &setting, StudyRun &study_run)
          : study(study), setting(setting), study_run(study_run),
            output(setting.directory + "/" + study_run.name)
      {}

      void measure()
      {
        for (unsigned int repetition = 0; repetition < study.repetitions; ++repetition)
        {
          const RunOutcome outcome = run({});
          study_run.state = outcome.state;
          study_run.message = outcome.message;
          if (outcome.state != RunState::measured || !read_values())
            return;
        }
      }

      void search()
      {
        study_run.state = RunState::measured;
        study_run.cost = 0;
        const Search &of = study.search;
        if (of.unit && !find_unit(*of.unit))
          return;
        if (succeeds(of.to))
        {
          study_run.values = {of.to};
          study_run.message = "succeeds at the largest value tried";
          return;
        }
        const std::string why = last_failure.message;
        double failing = of.to;
        if (!succeeds(of.from))
        {
          study_run.state =
              last_failure.state == RunState::measured ? RunState::no_value : last_failure.state;
          study_run.message = "fails at the smallest value tried: " + last_failure.message;
          return;
        }
        double succeeding = of.from;
        study_run.message = why;
        while (failing > (1. + of.tolerance) * succeeding)
        {
          const double middle = std::sqrt(succeeding * failing);
          if (succeeds(middle))
            succeeding = middle;
          else
          {
            failing = middle;
            study_run.message = last_failure.message;
          }
        }
        study_run.values = {succeeding};
        study_run.message = "beyond: " + study_run.message;
      }

    private:
      RunOutcome run(const std::vector<std::string> &more_settings)
      {
        std::vector<std::string> command;
        if (study.ranks > 1)
          command = {"mpirun", "-n", std::to_string(study.ranks)};
        command.insert(command.end(), {setting.program, study_run.base_file, "--quiet"});
        std::vector<std::string> settings = study_run.settings;
        settings.insert(settings.end(), more_settings.begin(), more_settings.end());
        settings.push_back("Output directory = " + output);
        for (const std::string &assignment : settings)
          command.insert(command.end(), {"--set", assignment});

        std::error_code ignored;
        std::filesystem::remove(output + "/summary.json", ignored);
        const std::string screen = output + ".txt";
        const auto start = std::chrono::steady_clock::now();
        const ExitState end = end_of(command, screen);
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
        ++study_run.n_executions;
        if (study.has_search)
          study_run.cost += elapsed.count();

        if (end.kind == ExitState::Kind::timed_out)
          return {RunState::timed_out, "it took longer than the time limit"};
        if (end.kind == ExitState::Kind::killed_by_signal)
          return {RunState::crashed, "signal " + std::to_string(end.code)};
        if (end.kind == ExitState::Kind::unknown)
          return {RunState::crashed, "nobody knows how the program ended"};
        if (end.code == 0)
          return {RunState::measured, ""};
        const std::string words = words_of(screen);
        if (words.empty() || end.code > 2)
          return {RunState::crashed,
                  "exit code " + std::to_string(end.code) + (words.empty() ? "" : ": " + words)};
        return {end.code == 1 ? RunState::refused : RunState::stopped, words};
      }

      /** Waits for the end of a program whose screen is written to a file. */
      ExitState end_of(const std::vector<std::string> &command, const std::string &screen) const
      {
        ChildProcess process(command, screen, study.time_limit);
        while (!process.has_ended())
        {
          if (setting.is_interrupted())
            throw StudyInterrupted();
          std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        return process.exit_state();
      }

      /** Runs the program that measures. Throws RunError with what it says where it fails. */
      void run_measurement() const
      {
        if (study.measurement.empty())
          return;
        std::vector<std::string> command = study.measurement;
        for (std::string &word : command)
          boost::replace_all(word, StudySettings::output_mark, output);
        const std::string screen = output + ".measurement.txt";
        const ExitState end = end_of(command, screen);
        if (end.kind == ExitState::Kind::exited && end.code == 0)
          return;
        std::ifstream in(screen);
        std::string line, last_line;
        while (std::getline(in, line))
          if (!line.empty())
            last_line = line;
        throw RunError("it could not be measured: " +
                       (last_line.empty() ? "see " + screen : last_line));
      }

      /** Executes the run as it is and takes the unit of the search from it. */
      bool find_unit(const QuantityOfInterest &quantity)
      {
        const RunOutcome outcome = run({});
        study_run.state = outcome.state;
        study_run.message = outcome.message;
        if (outcome.state != RunState::measured)
          return false;
        try
        {
          unit = quantity.value(output);
        }
        catch (const RunError &error)
        {
          study_run.state = RunState::no_value;
          study_run.message = error.what();
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
        if (last_failure.state != RunState::measured)
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
            last_failure = {RunState::no_value, error.what()};
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
          run_measurement();
          study_run.values.clear();
          for (const Target &target : study.targets)
            study_run.values.push_back(target.quantity.value(output));
          const double cost = study.cost.value(output);
          study_run.cost = study_run.n_executions > 1 ? std::min(study_run.cost, cost) : cost;
        }
        catch (const RunError &error)
        {
          study_run.state = RunState::no_value;
          study_run.message = error.what();
          return false;
        }
        study_run.columns.assign(study.columns.size(), no_value);
        for (std::size_t i = 0; i < study.columns.size(); ++i)
          try
          {
            study_run.columns[i] = study.columns[i].value(output);
          }
          catch (const RunError &)
          {} // a run without cells has no time per cell
        return true;
      }

      const StudySettings &study;
      const RunSetting &setting;
      StudyRun &study_run;
      const std::string output;
      double unit = 1;
      RunOutcome last_failure{RunState::measured, ""};
    };

    std::string record_file(const StudyRun &run, const std::string &directory)
    {
      return directory + "/" + run.name + ".json";
    }

    std::vector<double> numbers_of(const Json &values)
    {
      std::vector<double> numbers;
      for (const Json &value : values)
        numbers.push_back(value.is_null() ? no_value : value.get<double>());
      return numbers;
    }
  } // namespace

  std::string name_of(const RunState state)
  {
    return state_names[static_cast<std::size_t>(state)];
  }

  void execute(const StudySettings &study, const RunSetting &setting, StudyRun &run)
  {
    Runner runner(study, setting, run);
    run.n_executions = 0;
    if (study.has_search)
      runner.search();
    else
      runner.measure();
    if (run.state != RunState::measured)
      run.values.clear();
    run.columns.resize(study.columns.size(), no_value);
  }

  void write_record(const StudyRun &run, const std::string &directory)
  {
    Json record = Json::object();
    record["key"] = run.key;
    record["label"] = run.label;
    record["state"] = name_of(run.state);
    record["message"] = run.message;
    record["values"] = Json(run.values);
    record["columns"] = Json(run.columns);
    record["cost"] = run.cost;
    record["runs"] = run.n_executions;
    const std::string file = record_file(run, directory);
    {
      FileStream out(file + ".part", FileStream::Mode::create);
      out << json_text(record);
      if (!out.close().empty())
        throw RunError("The results of a run cannot be written to " + file + ".");
    }
    std::filesystem::rename(file + ".part", file);
  }

  bool read_record(StudyRun &run, const std::string &directory)
  {
    try
    {
      std::ifstream in(record_file(run, directory));
      const Json record = Json::parse(in);
      if (record.at("key") != run.key)
        return false;
      const std::string state = record.at("state");
      const auto found = std::find(state_names.begin(), state_names.end(), state);
      if (found == state_names.end())
        return false;
      run.state = static_cast<RunState>(found - state_names.begin());
      run.message = record.at("message");
      run.values = numbers_of(record.at("values"));
      run.columns = numbers_of(record.at("columns"));
      run.cost = record.at("cost");
      run.n_executions = record.at("runs");
      return true;
    }
    catch (const Json::exception &)
    {
      return false; // none, or one that cannot be read: the run is made again
    }
  }
} // namespace tombolo
