// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/trade_study.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/parameter_scanner.h>
#include <tombolo/study/child_process.h>
#include <tombolo/study/study_report.h>

#include <fnmatch.h>

#include <cctype>
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

namespace tombolo
{
  namespace
  {
    /** The text without what file names should not have. */
    std::string as_file_name(const std::string &text)
    {
      std::string name;
      for (const char c : text)
        if (std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '=')
          name += c;
        else if (c != ' ' && c != ',')
          name += '_';
        else if (c == ',')
          name += '+';
      return name.substr(0, 150);
    }

    /** Parameter files as they are written, each read once. */
    class BaseFiles
    {
    public:
      const ParameterScanner &operator[](const std::string &file)
      {
        const auto known = scanners.find(file);
        if (known != scanners.end())
          return known->second;
        ParameterScanner scanner(MPI_COMM_SELF);
        scanner.read_file(file);
        return scanners.emplace(file, std::move(scanner)).first->second;
      }

      /** The entries that one with `*` for names stands for: those of all sections of the file that
       * match. */
      std::vector<std::string> entries(const std::string &file, const std::string &pattern)
      {
        if (pattern.find('*') == std::string::npos)
          return {pattern};
        const std::size_t slash = pattern.rfind('/');
        const std::string section_pattern = pattern.substr(0, slash);
        std::set<std::string> found;
        if (slash != std::string::npos)
          for (const ParameterScanner::Item &item : (*this)[file].items())
            if (item.is_section &&
                fnmatch(section_pattern.c_str(), item.path.c_str(), FNM_PATHNAME) == 0)
              found.insert(item.path + pattern.substr(slash));
        return {found.begin(), found.end()};
      }

    private:
      std::map<std::string, ParameterScanner> scanners;
    };
  } // namespace

  std::atomic<bool> TradeStudy::interrupted{false};

  TradeStudy::TradeStudy(const Parameters &parameters, const std::string &program)
      : study(parameters), program(study.program.empty() ? program : study.program)
  {
    make_runs(parameters);
  }

  const StudySettings &TradeStudy::settings() const
  {
    return study;
  }

  std::size_t TradeStudy::n_runs() const
  {
    return all_runs.size();
  }

  const std::vector<StudyRun> &TradeStudy::runs() const
  {
    return all_runs;
  }

  void TradeStudy::interrupt()
  {
    interrupted = true;
  }

  void TradeStudy::make_runs(const Parameters &parameters)
  {
    BaseFiles base_files;
    std::set<std::string> names;
    for (const auto &choice : study.choices())
    {
      StudyRun study_run;
      study_run.choice = choice;
      study_run.base_file = study.base_file;
      for (std::size_t k = 0; k < study.factors.size(); ++k)
        for (std::size_t e = 0; e < study.factors[k].entries.size(); ++e)
          if (choice[k] != StudySettings::untouched &&
              study.factors[k].entries[e] == Factor::base_file)
            study_run.base_file = study.factors[k].values[choice[k]].texts[e];
      study_run.settings = study.common_settings;
      for (std::size_t k = 0; k < study.factors.size(); ++k)
      {
        if (choice[k] == StudySettings::untouched)
          continue;
        const Factor &factor = study.factors[k];
        const Factor::Value &value = factor.values[choice[k]];
        study_run.label +=
            (study_run.label.empty() ? "" : ", ") + factor.name + " = " + value.label;
        for (std::size_t e = 0; e < factor.entries.size(); ++e)
        {
          if (factor.entries[e] == Factor::base_file || value.texts[e].empty())
            continue;
          const auto entries = base_files.entries(study_run.base_file, factor.entries[e]);
          if (entries.empty())
            parameters.fail(factor.section_path + "/Entries",
                            "no section of " + study_run.base_file + " matches \"" +
                                factor.entries[e] + "\"");
          for (const std::string &entry : entries)
            study_run.settings.push_back(entry + " = " + value.texts[e]);
        }
      }
      study_run.input_text = base_files[study_run.base_file].text();
      study_run.name = as_file_name(study_run.label);
      while (!names.insert(study_run.name).second)
        study_run.name += "_";
      all_runs.push_back(study_run);
    }
  }

  void TradeStudy::set_keys(const std::string &directory)
  {
    const std::string version_file = directory + "/program.txt";
    {
      ChildProcess process({program, "--version"}, version_file, 60.);
      while (!process.has_ended())
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      const ExitState &end = process.exit_state();
      if (end.kind != ExitState::Kind::exited || end.code != 0)
        throw RunError("The program " + program + " does not tell its version: see " +
                       version_file + ".");
    }
    std::ifstream in(version_file);
    const std::string version((std::istreambuf_iterator<char>(in)), {});
    for (StudyRun &study_run : all_runs)
    {
      std::string arguments;
      for (const std::string &setting : study_run.settings)
        arguments += setting + "\n";
      std::ostringstream what;
      what << "ranks " << study.ranks << ", repetitions " << study.repetitions << ", search "
           << study.search.entry << " " << study.search.from << " " << study.search.to << " "
           << study.search.tolerance;
      if (study.search.unit)
        what << " " << study.search.unit->text();
      for (std::size_t i = 0; i < study.search.bounds.size(); ++i)
        what << ", " << study.search.bounds[i].text() << " " << study.search.limits[i];
      for (const Target &target : study.targets)
        what << ", " << target.quantity.text();
      what << "; columns";
      for (const QuantityOfInterest &column : study.columns)
        what << ", " << column.text();
      for (const std::string &word : study.measurement)
        what << ", " << word;
      what << ", " << study.cost.text() << ", input " << std::hex
           << std::hash<std::string>()(version + study_run.input_text + arguments);
      study_run.key = what.str();
    }
  }

  void TradeStudy::run(Log &log, const OutputDirectory &directory, const bool anew)
  {
    directory.create_subdirectory("members");
    const std::string run_directory = directory.file("members");
    set_keys(run_directory);

    std::vector<std::size_t> pending;
    for (std::size_t i = 0; i < all_runs.size(); ++i)
      if (anew || !read_record(all_runs[i], run_directory))
        pending.push_back(i);
    log.print(std::to_string(all_runs.size()) + " runs, " +
              std::to_string(all_runs.size() - pending.size()) + " of which have run before");
    execute_runs(log, run_directory, pending);

    const StudyReport report(study, all_runs);
    directory.write("members.csv", [&](std::ostream &out) { report.write_csv(out); });
    directory.write("study.json", [&](std::ostream &out) { report.write_json(out); });
    directory.write("report.md", [&](std::ostream &out) { report.write_markdown(out); });
    log.print("\n" + report.conclusions());
    log.print("Tables: " + directory.file("members.csv") + ", " + directory.file("report.md"));
  }

  void TradeStudy::execute_runs(Log &log, const std::string &directory,
                                const std::vector<std::size_t> &pending)
  {
    std::mutex mutex;
    std::size_t n_taken = 0, n_done = 0;
    std::exception_ptr failure;
    std::atomic<bool> has_failed{false};
    const RunSetting setting{program, directory,
                             [&]() { return interrupted.load() || has_failed.load(); }};

    const auto work = [&]()
    {
      for (;;)
      {
        std::size_t number = 0;
        {
          const std::lock_guard<std::mutex> lock(mutex);
          if (n_taken == pending.size() || setting.is_interrupted())
            return;
          number = pending[n_taken++];
        }
        StudyRun &study_run = all_runs[number];
        try
        {
          execute(study, setting, study_run);
          write_record(study_run, directory);
        }
        catch (...)
        {
          const std::lock_guard<std::mutex> lock(mutex);
          if (!has_failed.exchange(true))
            failure = std::current_exception();
          return;
        }
        const std::lock_guard<std::mutex> lock(mutex);
        log.print("[" + std::to_string(++n_done) + "/" + std::to_string(pending.size()) + "] " +
                  line_of(study_run));
      }
    };
    std::vector<std::thread> threads;
    for (unsigned int t = 1; t < study.at_a_time; ++t)
      threads.emplace_back(work);
    work();
    for (std::thread &thread : threads)
      thread.join();
    if (failure)
      std::rethrow_exception(failure);
    if (interrupted)
      throw StudyInterrupted();
  }

  std::string TradeStudy::line_of(const StudyRun &study_run) const
  {
    std::ostringstream line;
    line.precision(4);
    line << study_run.label << ": ";
    if (study_run.state == RunState::measured)
    {
      for (std::size_t i = 0; i < study_run.values.size(); ++i)
        line << (i == 0 ? "" : ", ") << study_run.values[i];
      line << " at a cost of " << study_run.cost;
      if (!study_run.message.empty())
        line << " (" << study_run.message << ")";
    }
    else
      line << name_of(study_run.state) << ": " << study_run.message;
    return line.str();
  }
} // namespace tombolo
