// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/log.h>
#include <tombolo/base/output_directory.h>
#include <tombolo/study/study_run.h>

#include <atomic>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * Makes the runs of a study by a program, each with a choice of values for entries of its
   * parameter file, and compares what they cost with what they bring. Runs are processes of their
   * own, so that one that fails takes nothing with it, and their results are kept: a study that was
   * interrupted, or that was given more runs, goes on where it was.
   *
   * Leaves behind `members.csv`, `study.json` (for scripts/study), `report.md` (a table, the front
   * of the best runs, and a sentence for each step of each factor) and a directory for each
   * run.
   */
  class TradeStudy
  {
  public:
    /** Reads the study. @p program makes the runs where the study names no other. Throws
     * InputError. */
    TradeStudy(const Parameters &parameters, const std::string &program);

    const StudySettings &settings() const;
    std::size_t n_runs() const;

    /** Makes the runs that are missing, or all with @p anew, and writes the results. Throws
     * RunError where the program cannot be started or a file cannot be written. */
    void run(Log &log, const OutputDirectory &directory, bool anew);

    /** Asks run() to end its runs and throw StudyInterrupted; may be called by a handler of
     * signals. */
    static void interrupt();

    const std::vector<StudyRun> &runs() const;

  private:
    void make_runs(const Parameters &parameters);
    void set_keys(const std::string &directory);
    void execute_runs(Log &log, const std::string &directory,
                      const std::vector<std::size_t> &pending);
    std::string line_of(const StudyRun &run) const;

    StudySettings study;
    std::string program;
    std::vector<StudyRun> all_runs;

    static std::atomic<bool> interrupted;
  };
} // namespace tombolo
