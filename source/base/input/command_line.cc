// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/command_line.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/registry.h>

#include <algorithm>

namespace tombolo
{
  CommandLine::CommandLine(const int argc, char **argv, const std::vector<std::string> &flags,
                           const std::vector<std::string> &valued)
      : program_name(argc > 0 ? argv[0] : "")
  {
    std::vector<std::string> known = flags;
    known.insert(known.end(), valued.begin(), valued.end());
    known.emplace_back("--set");
    for (int i = 1; i < argc; ++i)
    {
      const std::string argument = argv[i];
      const std::string name = argument.substr(0, argument.find('='));
      if (argument == "--set")
      {
        if (i + 1 == argc)
          throw InputError("--set needs an argument: --set \"Section/Entry = value\".");
        assignments.emplace_back(argv[++i]);
      }
      else if (std::count(flags.begin(), flags.end(), argument) > 0 ||
               std::count(valued.begin(), valued.end(), name) > 0)
        options[name] = argument.substr(name.size());
      else if (!argument.empty() && argument[0] == '-')
      {
        const std::string nearest = nearest_name(name, known);
        throw InputError("Unknown option " + argument + "." +
                         (nearest.empty() ? "" : " Did you mean " + nearest + "?") +
                         " See --help.");
      }
      else if (file_name.empty())
        file_name = argument;
      else
        throw InputError("Two parameter files: " + file_name + " and " + argument +
                         ". One run takes one.");
    }
  }

  const std::string &CommandLine::program() const
  {
    return program_name;
  }

  bool CommandLine::has(const std::string &option) const
  {
    return options.count(option) > 0;
  }

  std::string CommandLine::value(const std::string &option, const std::string &what) const
  {
    const std::string &text = options.at(option);
    if (text == "=")
      throw InputError(option + "= needs " + what + ".");
    return text.empty() ? text : text.substr(1);
  }

  bool CommandLine::has_file() const
  {
    return !file_name.empty();
  }

  const std::string &CommandLine::file() const
  {
    if (file_name.empty())
      throw InputError("No parameter file given. See --help.");
    return file_name;
  }

  const std::vector<std::string> &CommandLine::overrides() const
  {
    return assignments;
  }
} // namespace tombolo
