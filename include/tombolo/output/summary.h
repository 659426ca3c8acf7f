// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/json.h>
#include <tombolo/base/output_directory.h>

#include <chrono>
#include <memory>
#include <string>

namespace tombolo
{
  class UnitLabels;

  /**
   * `summary.json`: a run in a form for programs, written when all else has been, so
   * that its presence says that the run is complete. Starts with the versions of the program and
   * its libraries, and the ranks; the simulation adds its counts, and each case its own values
   * under `results` (doc/results.md); keys of runs are in simulation/run_summary.h.
   */
  class Summary
  {
  public:
    /** Starts the clock of `wall_seconds`. */
    explicit Summary(MPI_Comm communicator);
    ~Summary();

    /** The value at a key of the document. */
    Json &operator[](const std::string &key);

    /** The whole document, to be filled. */
    Json &document()
    {
      return *root;
    }

    /** The object for the values of a case. */
    Json &results()
    {
      return *case_results;
    }

    /** Adds the labels of units under `units`. */
    void set_units(const UnitLabels &labels);

    /** Adds `wall_seconds`, if it is not set, and `peak_memory_bytes` (the sum over ranks) and
     * writes the file, with the values of rank 0. Throws RunError. Collective. */
    void write(const OutputDirectory &directory);

  private:
    MPI_Comm communicator;
    std::unique_ptr<Json> root;
    std::unique_ptr<Json> case_results;
    std::chrono::steady_clock::time_point start;
  };

  /** Versions of the program and the libraries it uses, by name, for --version too. */
  Json version_information();
} // namespace tombolo
