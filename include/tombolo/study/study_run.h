// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/study/study_settings.h>

#include <functional>
#include <string>
#include <vector>

namespace tombolo
{
  /** How a run ended, from good to bad. */
  enum class RunState
  {
    measured,  ///< all its values are there
    refused,   ///< the program said why it does not start
    stopped,   ///< the program said why it did not finish
    no_value,  ///< it finished without a value that is asked for
    timed_out, ///< it was ended
    crashed    ///< a signal, or an exit code without words
  };

  /** The state in words. */
  std::string name_of(RunState state);

  /** One choice of a value for each factor, and what came of it. */
  struct StudyRun
  {
    std::vector<unsigned int> choice; ///< see StudySettings::choices()
    std::string label;                ///< "spacing = 0.1, model = particles"
    std::string name;                 ///< of its directory
    std::string base_file;
    std::string input_text;            ///< of the base file with all that it includes
    std::vector<std::string> settings; ///< "Section/Entry = value"
    /** All that the numbers depend on: the program, its arguments, the text of the input. */
    std::string key;

    RunState state = RunState::crashed;
    std::string message;         ///< why there are no values; or a remark on them
    std::vector<double> values;  ///< of the targets, or what the search found
    std::vector<double> columns; ///< NaN where there is none
    double cost = 0;
    unsigned int n_executions = 0;
  };

  /** Where runs are made, and by which program. */
  struct RunSetting
  {
    std::string program;
    std::string directory;                ///< of the runs' outputs
    std::function<bool()> is_interrupted; ///< asked often
  };

  /** Thrown where is_interrupted() says so. */
  struct StudyInterrupted
  {};

  /** Executes the program for a run as often as the study says and sets the results of the run.
   * Runs are executed in threads of their own. Throws RunError if the program cannot be started at
   * all. */
  void execute(const StudySettings &study, const RunSetting &setting, StudyRun &run);

  /** Writes the results of a run beside its output. Throws RunError. */
  void write_record(const StudyRun &run, const std::string &directory);

  /** Reads them; false if there are none, or if they depend on something else than @p run's
   * key. */
  bool read_record(StudyRun &run, const std::string &directory);
} // namespace tombolo
