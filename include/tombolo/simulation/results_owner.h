// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/base/output_directory.h>

#include <string>

namespace tombolo
{
  /** Throws an InputError about `Output directory` where it has results of another parameter file:
   * another path, which `run.json` in it has, and another text than `original.prm`. A parameter
   * file in the directory itself is none of others. Collective. */
  void refuse_results_of_another_file(const Parameters &parameters);

  /** Throws an InputError about `Output directory` where a run with checkpoints has not reached its
   * end there: what would be removed can be resumed. Collective. */
  void refuse_unfinished_run(const Parameters &parameters);

  /** Throws an InputError about `Output directory` where another process writes there now: its
   * rank 0 holds a lock of `run.json`. Collective. */
  void refuse_running_run(const Parameters &parameters);

  /** Locks `run.json` until this process ends; does nothing where the file system has no locks.
   * Collective. */
  void hold_results(const OutputDirectory &directory);

  /** Writes `run.json`: to which parameter file the results in @p directory belong. Collective. */
  void write_owner_of_results(const Parameters &parameters, const OutputDirectory &directory);

  /** Whether a checkpoint that --resume names, or the newest one where it names none, is one of an
   * output directory. Collective. */
  bool is_checkpoint_of(const std::string &checkpoint, const std::string &output_directory,
                        MPI_Comm communicator);
} // namespace tombolo
