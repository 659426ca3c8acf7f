// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/study/study_run.h>

#include <iosfwd>
#include <string>
#include <vector>

namespace tombolo
{
  /** What a study has found: errors, the front of the best runs, and what each step of each factor
   * does. The runs must outlive it. */
  class StudyReport
  {
  public:
    StudyReport(const StudySettings &study, const std::vector<StudyRun> &runs);

    /** The error of a run: its values against their references, combined; with a search the
     * value itself. NaN where the run has none. */
    const std::vector<double> &errors() const;

    /** Runs that none beats in both cost and error, by rising cost. Empty with a search. */
    const std::vector<std::size_t> &front() const;

    /** A sentence for each step from one value of a factor to the next, from all pairs of runs
     * that differ in nothing else: geometric means of the ratios of error and cost, with their
     * range; and one for each value with which runs fail. */
    std::vector<std::string> sentences() const;

    /** The front and the sentences, for the screen. */
    std::string conclusions() const;

    void write_csv(std::ostream &out) const;
    void write_json(std::ostream &out) const;
    void write_markdown(std::ostream &out) const;

  private:
    double error_of(const StudyRun &run) const;
    void find_front();
    void add_steps(unsigned int factor, std::vector<std::string> &text) const;
    void add_failures(unsigned int factor, std::vector<std::string> &text) const;
    std::string label_of(const StudyRun &run, unsigned int factor) const;

    const StudySettings &study;
    const std::vector<StudyRun> &runs;
    const StudyRun *reference = nullptr;
    std::vector<double> run_errors;
    std::vector<std::size_t> best;
  };
} // namespace tombolo
