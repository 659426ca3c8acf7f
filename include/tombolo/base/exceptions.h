// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <mpi.h>
#include <stdexcept>
#include <string>
#include <vector>

namespace dealii
{
}

namespace tombolo
{
  using namespace dealii; // the names of deal.II need no prefix in this namespace

  /** The text of each rank, on all of them. Collective. */
  std::vector<std::string> texts_of_ranks(MPI_Comm communicator, const std::string &text);

  /** The text of the lowest rank that has one, on all of them; empty where none has. Collective. */
  inline std::string first_text(const MPI_Comm communicator, const std::string &text)
  {
    for (const std::string &rank_text : texts_of_ranks(communicator, text))
      if (!rank_text.empty())
        return rank_text;
    return "";
  }

  /** Throws the same @p Error on every rank if any rank has a message: that of the lowest such
   * rank. For failures that only one rank can detect: if it threw alone, the others would wait for
   * it in their next exchange. Collective. */
  template <typename Error>
  void throw_on_all_ranks(const std::string &message, const MPI_Comm communicator)
  {
    if (const std::string text = first_text(communicator, message); !text.empty())
      throw Error(text);
  }

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
   * position. The program writes what it has and exits with code 2.
   */
  class RunError : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };
} // namespace tombolo
