// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace tombolo
{
  /** How a program ended. */
  struct ExitState
  {
    enum class Kind
    {
      exited,
      killed_by_signal,
      timed_out,
      unknown ///< somebody else has taken the status: no success
    } kind = Kind::unknown;
    int code = 0; ///< exit code or number of the signal
  };

  /**
   * A program in a process group of its own, with its output in a file. Its environment is that
   * which this process was started with, since MPI marks the environment of a process that uses
   * it, and a child with these marks would take itself for a part of it.
   */
  class ChildProcess
  {
  public:
    /** Remembers the environment; call it before MPI is initialized. */
    static void remember_environment();

    /** Starts @p command (the program, looked for in PATH, and its arguments). Standard output
     * and standard error go to @p output_file. Zero seconds: no limit. Throws RunError. */
    ChildProcess(const std::vector<std::string> &command, const std::string &output_file,
                 double time_limit_seconds);

    ChildProcess(const ChildProcess &) = delete;
    ChildProcess &operator=(const ChildProcess &) = delete;

    /** Ends the program if it still runs. */
    ~ChildProcess();

    /** Whether it has ended; past its time it is ended. Does not wait. */
    bool has_ended();

    /** After has_ended(). */
    const ExitState &exit_state() const;

  private:
    void terminate();

    pid_t process;
    bool ended = false;
    ExitState state;
    double time_limit;
    std::chrono::steady_clock::time_point start;
  };
} // namespace tombolo
