// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The arguments of a program: options that begin with a dash, `--set "Section/Entry = value"`
   * (repeatable), and at most one parameter file. Throws InputError with the nearest known name
   * where an option is unknown.
   */
  class CommandLine
  {
  public:
    /** @p flags are options without a value. Those of @p valued may have one, as `--name=VALUE`. */
    CommandLine(int argc, char **argv, const std::vector<std::string> &flags,
                const std::vector<std::string> &valued = {});

    /** How the program was called. */
    const std::string &program() const
    {
      return program_name;
    }

    bool has(const std::string &option) const
    {
      return options.count(option) > 0;
    }

    /** The value of an option that was given; empty where it was given without one. Throws
     * InputError, with @p what an empty value ought to be, for `--name=`. */
    std::string value(const std::string &option, const std::string &what) const;

    bool has_file() const
    {
      return !file_name.empty();
    }

    /** The parameter file. Throws InputError where none was given. */
    const std::string &file() const;

    /** What --set was given. */
    const std::vector<std::string> &overrides() const
    {
      return assignments;
    }

  private:
    std::string program_name;
    std::string file_name;
    std::vector<std::string> assignments;
    std::map<std::string, std::string> options; ///< with "=VALUE" as it was written
  };

  /**
   * What main() of every program does: starts MPI, calls @p run and returns its exit code, and
   * turns exceptions into a message, printed once, and an exit code: 1 for an InputError, 2 for a
   * RunError, which @p stopped introduces and @p afterwards follows. Other exceptions are not
   * agreed among ranks: the rank that catches one aborts all of them with code 3.
   */
  int run_program(int argc, char **argv, const std::function<int()> &run,
                  const std::string &stopped, const std::string &afterwards = "");
} // namespace tombolo
