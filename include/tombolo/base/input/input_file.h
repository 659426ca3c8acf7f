// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <mpi.h>

#include <string>

namespace tombolo
{
  /** The bytes of the file that an entry names, on every rank: rank 0 reads it and sends it to the
   * others. It is searched in the directory of the parameter file that sets the entry, in that of
   * the main parameter file and then in the working directory. Throws InputError on every rank
   * where it cannot be read or is empty. Collective. */
  std::string read_input_file(const Section &section, const std::string &entry,
                              MPI_Comm communicator);

  /** The same of a file that is part of the entry. Collective. */
  std::string read_input_file(const Section &section, const std::string &entry,
                              const std::string &file, MPI_Comm communicator);

  /** How the name of a file ends, in lower case, with the dot: ".stl". */
  std::string extension_of(const std::string &file);
} // namespace tombolo
