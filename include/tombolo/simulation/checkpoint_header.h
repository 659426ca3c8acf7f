// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/mesh/cell_divisions.h>
#include <tombolo/state/records.h>

#include <string>

namespace tombolo
{
  /** What a checkpoint says of the model of its run. */
  struct CheckpointHeader
  {
    std::string entries; ///< text_of_entries()
    /** Divided cells of a mesh that need not be that of the file; none: it is. */
    CellDivisions divisions;
  };

  /** Writes to a checkpoint of which dimension it is, and its header. */
  void write_header(StateArchive &archive, unsigned int dimension, CheckpointHeader header);

  /** Reads what write_header() has written. Throws the InputError of a
   * checkpoint whose model has another dimension. */
  CheckpointHeader read_header(StateArchive &archive, unsigned int dimension,
                               const Parameters &parameters);

  /** Lists the times of a clock. */
  void list(Records &records, Clock &clock);

  /** Whether the checkpoint @p file is in the output directory @p directory. Collective. */
  bool is_of_directory(const std::string &file, const std::string &directory,
                       MPI_Comm communicator);
} // namespace tombolo
