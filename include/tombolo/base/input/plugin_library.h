// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <string>

namespace tombolo
{
  /**
   * Loads the shared objects that a list of the parameter file names, so that the plug-ins in them
   * register themselves; to be called after reading and before declaring. A name that is not an
   * absolute path is searched in the directory of the parameter file, then in the working
   * directory, then beside the library of the project. The libraries stay loaded until the process
   * ends; loading one again does nothing. Throws InputError on all ranks if one of them cannot load
   * a library, with the message of the system's loader. Collective.
   */
  void load_plugin_libraries(const Parameters &parameters, MPI_Comm communicator,
                             const std::string &entry = "Plugin libraries");
} // namespace tombolo
