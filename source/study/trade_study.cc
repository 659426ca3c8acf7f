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
    make_members(parameters);
  }

  const StudySettings &TradeStudy::settings() const
  {
    return study;
  }

  std::size_t TradeStudy::n_members() const
  {
    return all_members.size();
  }

  const std::vector<StudyRun> &TradeStudy::members() const
  {
    return all_members;
  }

  void TradeStudy::interrupt()
  {
    interrupted = true;
  }

  void TradeStudy::make_members(const Parameters &parameters)
  {
    BaseFiles base_files;
    std::set<std::string> names;
    for (const auto &choice : study.members())
    {
      StudyRun member;
      member.choice = choice;
      member.base_file = study.base_file;
      for (std::size_t k = 0; k < study.knobs.size(); ++k)
        for (std::size_t e = 0; e < study.knobs[k].entries.size(); ++e)
          if (choice[k] != StudySettings::untouched &&
              study.knobs[k].entries[e] == Factor::base_file)
            member.base_file = study.knobs[k].values[choice[k]].texts[e];
      member.settings = study.common_settings;
      for (std::size_t k = 0; k < study.knobs.size(); ++k)
      {
        if (choice[k] == StudySettings::untouched)
          continue;
        const Factor &knob = study.knobs[k];
        const Factor::Value &value = knob.values[choice[k]];
        member.label += (member.label.empty() ? "" : ", ") + knob.name + " = " + value.label;
        for (std::size_t e = 0; e < knob.entries.size(); ++e)
        {
          if (knob.entries[e] == Factor::base_file || value.texts[e].empty())
            continue;
          const auto entries = base_files.entries(member.base_file, knob.entries[e]);
          if (entries.empty())
            parameters.fail("Factor: " + knob.name + "/Entries",
                            "no section of " + member.base_file + " matches \"" + knob.entries[e] +
                                "\"");
          for (const std::string &entry : entries)
            member.settings.push_back(entry + " = " + value.texts[e]);
        }
      }
      member.input_text = base_files[member.base_file].text();
      member.name = as_file_name(member.label);
      while (!names.insert(member.name).second)
        member.name += "_";
      all_members.push_back(member);
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
    for (StudyRun &member : all_members)
    {
      std::string arguments;
      for (const std::string &setting : member.settings)
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
        what << ", " << target.measure.text();
      what << "; columns";
      for (const QuantityOfInterest &column : study.columns)
        what << ", " << column.text();
      what << ", " << study.cost.text() << ", input " << std::hex
           << std::hash<std::string>()(version + member.input_text + arguments);
      member.key = what.str();
    }
  }

  void TradeStudy::run(Log &log, const OutputDirectory &directory, const bool anew)
  {
    directory.create_subdirectory("members");
    const std::string member_directory = directory.file("members");
    set_keys(member_directory);

    std::vector<std::size_t> pending;
    for (std::size_t i = 0; i < all_members.size(); ++i)
      if (anew || !read_record(all_members[i], member_directory))
        pending.push_back(i);
    log.print(std::to_string(all_members.size()) + " members, " +
              std::to_string(all_members.size() - pending.size()) + " of which have run before");
    run_members(log, member_directory, pending);

    const StudyReport report(study, all_members);
    directory.write("members.csv", [&](std::ostream &out) { report.write_csv(out); });
    directory.write("study.json", [&](std::ostream &out) { report.write_json(out); });
    directory.write("report.md", [&](std::ostream &out) { report.write_markdown(out); });
    log.print("\n" + report.conclusions());
    log.print("Tables: " + directory.file("members.csv") + ", " + directory.file("report.md"));
  }

  void TradeStudy::run_members(Log &log, const std::string &directory,
                               const std::vector<std::size_t> &pending)
  {
    std::mutex mutex;
    std::size_t n_taken = 0, n_done = 0;
    std::exception_ptr failure;
    std::atomic<bool> has_failed{false};
    const MemberSetting setting{program, directory,
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
        StudyRun &member = all_members[number];
        try
        {
          run_member(study, setting, member);
          write_record(member, directory);
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
                  line_of(member));
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

  std::string TradeStudy::line_of(const StudyRun &member) const
  {
    std::ostringstream line;
    line.precision(4);
    line << member.label << ": ";
    if (member.state == MemberState::measured)
    {
      for (std::size_t i = 0; i < member.values.size(); ++i)
        line << (i == 0 ? "" : ", ") << member.values[i];
      line << " at a cost of " << member.cost;
      if (!member.message.empty())
        line << " (" << member.message << ")";
    }
    else
      line << name_of(member.state) << ": " << member.message;
    return line.str();
  }
} // namespace tombolo
