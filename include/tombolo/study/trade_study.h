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
   * Runs a program on the members of a study, each a choice of values for entries of its parameter
   * file, and compares what they cost with what they bring. Members run in processes of their own,
   * so that one that fails takes nothing with it, and their results are kept: a study that was
   * interrupted, or that was given more members, goes on where it was.
   *
   * Leaves behind `members.csv`, `study.json` (for scripts/study), `report.md` (a table, the front
   * of the best members, and a sentence for each step of each knob) and a directory for each
   * member.
   */
  class TradeStudy
  {
  public:
    /** Reads the study. @p program runs the members where the study names no other. Throws
     * InputError. */
    TradeStudy(const Parameters &parameters, const std::string &program);

    const StudySettings &settings() const;
    std::size_t n_members() const;

    /** Runs what has not run, and writes the results. With @p anew all members run. Throws RunError
     * where the program cannot be started or a file cannot be written. */
    void run(Log &log, const OutputDirectory &directory, bool anew);

    /** Asks run() to end its members and throw StudyInterrupted; may be called by a handler of
     * signals. */
    static void interrupt();

    const std::vector<StudyRun> &members() const;

  private:
    void make_members(const Parameters &parameters);
    void set_keys(const std::string &directory);
    void run_members(Log &log, const std::string &directory,
                     const std::vector<std::size_t> &pending);
    std::string line_of(const StudyRun &member) const;

    StudySettings study;
    std::string program;
    std::vector<StudyRun> all_members;

    static std::atomic<bool> interrupted;
  };
} // namespace tombolo
