// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/state/state_archive.h>

#include <string>

namespace tombolo
{
  /** Writes to a checkpoint of which dimension it is, and text_of_entries() of its run. */
  void write_header(StateArchive &archive, unsigned int dimension, std::string entries);

  /** Throws the InputError of a checkpoint that is of another dimension, or whose run had other
   * entries that matter; @p file is its name. Collective. */
  void check_header(StateArchive &archive, unsigned int dimension, const Parameters &parameters,
                    const std::string &file);

  /** Writes or reads a clock. */
  void serialize_clock(Clock &clock, StateArchive &archive);

  /** Whether the checkpoint @p file is in the output directory @p directory. Collective. */
  bool is_of_directory(const std::string &file, const std::string &directory,
                       MPI_Comm communicator);
} // namespace tombolo
