// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/mesh/cell_divisions.h>
#include <tombolo/state/state_archive.h>

#include <string>

namespace tombolo
{
  /** Writes to a checkpoint of which dimension it is, and text_of_entries() of its run. */
  void write_header(StateArchive &archive, unsigned int dimension, std::string entries);

  /** Reads what write_header() has written and returns the entries. Throws the InputError of a
   * checkpoint whose model has another dimension. */
  std::string read_header(StateArchive &archive, unsigned int dimension,
                          const Parameters &parameters);

  /** Writes or reads a clock. */
  void serialize_clock(Clock &clock, StateArchive &archive);

  /** The divided cells of a mesh that is not that of the file; none otherwise. Collective. */
  void serialize_divisions(CellDivisions &divisions, StateArchive &archive);

  /** Whether the checkpoint @p file is in the output directory @p directory. Collective. */
  bool is_of_directory(const std::string &file, const std::string &directory,
                       MPI_Comm communicator);
} // namespace tombolo
