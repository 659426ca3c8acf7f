// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/study/study_run.h>

#include <iosfwd>
#include <string>
#include <vector>

namespace tombolo
{
  /** What a study has found: errors, the front of the best members, and what each step of each knob
   * does. The members must outlive it. */
  class StudyReport
  {
  public:
    StudyReport(const StudySettings &study, const std::vector<StudyRun> &members);

    /** The error of a member: its values against their references, combined; with a search the
     * value itself. NaN where the member has none. */
    const std::vector<double> &errors() const;

    /** Members that none beats in both cost and error, by rising cost. Empty with a search. */
    const std::vector<std::size_t> &front() const;

    /** A sentence for each step from one value of a knob to the next, from all pairs of members
     * that differ in nothing else: geometric means of the ratios of error and cost, with their
     * range; and one for each value with which members fail. */
    std::vector<std::string> sentences() const;

    /** The front and the sentences, for the screen. */
    std::string conclusions() const;

    void write_csv(std::ostream &out) const;
    void write_json(std::ostream &out) const;
    void write_markdown(std::ostream &out) const;

  private:
    double error_of(const StudyRun &member) const;
    void find_front();
    void add_steps(unsigned int knob, std::vector<std::string> &text) const;
    void add_failures(unsigned int knob, std::vector<std::string> &text) const;
    std::string label_of(const StudyRun &member, unsigned int knob) const;

    const StudySettings &study;
    const std::vector<StudyRun> &members;
    const StudyRun *reference = nullptr;
    std::vector<double> member_errors;
    std::vector<std::size_t> best;
  };
} // namespace tombolo
