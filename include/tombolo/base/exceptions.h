// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace tombolo
{
  /**
   * The input cannot be run: the message is complete, says where, what was given, what is allowed
   * and what to do, and is printed once, without a stack trace. Thrown on every rank alike, before
   * the first step. The program exits with code 1.
   */
  class InputError : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };

  /**
   * A run that cannot go on, for a physical or numerical reason (a value that is not finite, an
   * inverted cell). Thrown on every rank alike; the message has the time, the node or cell and its
   * place. The program writes what it has and exits with code 2.
   */
  class RunError : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };
} // namespace tombolo
