// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/mesh/cell_divisions.h>
#include <tombolo/state/records.h>

#include <filesystem>
#include <string>
#include <system_error>

namespace tombolo
{
  /** The description of the model of its run in a checkpoint. */
  struct CheckpointHeader
  {
    std::string entries; ///< text_of_entries()
    /** Divided cells of a mesh that need not be that of the file; none: it is. */
    CellDivisions divisions;
  };

  constexpr const char *divisions_name = "divided cells";

  /** Writes to a checkpoint of which dimension it is, and its header. */
  inline void write_header(StateArchive &archive, unsigned int dimension, CheckpointHeader header)
  {
    archive("dimension", dimension);
    archive("parameters", header.entries);
    if (!header.divisions.empty())
      archive(divisions_name, header.divisions);
  }

  /** Reads what write_header() has written. Throws the InputError of a
   * checkpoint whose model has another dimension. */
  inline CheckpointHeader read_header(StateArchive &archive, const unsigned int dimension,
                                      const Parameters &parameters)
  {
    unsigned int earlier = 0;
    archive("dimension", earlier);
    if (earlier != dimension)
      parameters.fail("Dimension", "the checkpoint " + archive.name() +
                                       " is of a model of dimension " + std::to_string(earlier) +
                                       ".");
    CheckpointHeader result;
    archive("parameters", result.entries);
    if (archive.has(divisions_name))
      archive(divisions_name, result.divisions);
    return result;
  }

  /** Lists the times of a clock. */
  inline void list(Records &records, Clock &clock)
  {
    records.value("step", clock.step);
    records.value("time", clock.time);
    records.value("previous step", clock.previous_step);
    records.value("next step", clock.next_step);
    records.value("stable step", clock.stable_step);
    records.value("start lag", clock.start_lag).optional();
  }

  /** Whether the checkpoint @p file is in the output directory @p directory. Collective. */
  inline bool is_of_directory(const std::string &file, const std::string &directory,
                              const MPI_Comm communicator)
  {
    namespace fs = std::filesystem;
    std::error_code code;
    return from_first_rank(communicator,
                           [&] {
                             return fs::equivalent(fs::absolute(file).parent_path().parent_path(),
                                                   directory, code);
                           });
  }
} // namespace tombolo
