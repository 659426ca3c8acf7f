// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <string>

namespace tombolo
{
  /**
   * What main() of every program does: starts MPI, calls @p run and returns its exit code, and
   * turns exceptions into a message, printed once, and an exit code: 1 for an InputError, 2 for a
   * RunError, which @p stopped introduces and @p afterwards follows. Other exceptions are not
   * agreed among ranks: the rank that meets one aborts all of them with code 3.
   */
  int run_program(int argc, char **argv, const std::function<int()> &run,
                  const std::string &stopped, const std::string &afterwards = "");
} // namespace tombolo
