// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/mistakes.h>

#include <tombolo/base/input/parameter_scanner.h>

#include <deal.II/base/patterns.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace tombolo
{
  namespace
  {
    /** The position of the file and the line that a message begins with; those without a position
     * come last. */
    std::pair<std::size_t, unsigned long> position_of(const std::string &message,
                                                      const std::vector<std::string> &files)
    {
      for (std::size_t file = 0; file < files.size(); ++file)
      {
        const std::string beginning = files[file] + ":";
        if (message.compare(0, beginning.size(), beginning) != 0)
          continue;
        char *end = nullptr;
        const unsigned long line = std::strtoul(message.c_str() + beginning.size(), &end, 10);
        if (line > 0 && *end == ':')
          return {file, line};
      }
      return {files.size(), 0};
    }
    /** The beginning of a message about the value of an entry; empty for other messages. */
    std::string entry_of(const std::string &message)
    {
      const std::size_t entry = message.find(": entry \"");
      const std::size_t end = message.find("\": ", entry);
      return entry == std::string::npos || end == std::string::npos ? ""
                                                                    : message.substr(0, end + 2);
    }
  } // namespace

  void Mistakes::add(const std::string &message)
  {
    if (!is_collecting)
      throw InputError(message);
    if (std::find(messages.begin(), messages.end(), message) == messages.end())
      messages.push_back(message);
  }

  bool Mistakes::attempt(const std::function<void()> &read)
  {
    if (!is_collecting)
    {
      read();
      return true;
    }
    const bool outer_has_stand_in = std::exchange(has_stand_in, false);
    const std::size_t n_before = messages.size();
    bool is_right = true;
    const auto note = [&](const std::string &message)
    {
      is_right = false;
      // One message about a value is enough.
      const std::string entry = entry_of(message);
      const bool is_known =
          !entry.empty() && std::any_of(messages.begin(), messages.end(),
                                        [&](const std::string &other)
                                        { return other.compare(0, entry.size(), entry) == 0; });
      if (!has_stand_in && !is_known)
        add(message);
    };
    try
    {
      read();
    }
    catch (const KnownMistake &)
    {
      is_right = false;
    }
    catch (const InputError &error)
    {
      note(error.what());
    }
    catch (const RunError &error)
    {
      note(error.what()); // nothing has run yet
    }
    is_right = is_right && !has_stand_in && messages.size() == n_before;
    has_stand_in = outer_has_stand_in || !is_right;
    return is_right;
  }

  bool Mistakes::is_meant(const std::string &path) const
  {
    return std::any_of(meant.begin(), meant.end(),
                       [&](const std::string &other)
                       {
                         return other == path ||
                                path.compare(0, other.size() + 1, other + "/") == 0 ||
                                other.compare(0, path.size() + 1, path + " ") == 0;
                       });
  }

  std::string Mistakes::stand_in(const ParameterDeclaration &entry)
  {
    has_stand_in = true;
    if (!entry.is_mandatory)
      return entry.default_value;
    if (!pattern_alternatives(entry.pattern).empty())
      throw KnownMistake("No plug-in can stand in for that of \"" + entry.path + "\".");
    const auto pattern = dealii::Patterns::pattern_factory(entry.pattern);
    for (const char *const value : {"1", "0", "0.5", "true", "1, 1", "1, 1, 1"})
      if (pattern->match(value))
        return value;
    throw KnownMistake("No value can stand in for that of \"" + entry.path + "\".");
  }

  void Mistakes::refuse(const std::vector<std::string> &files)
  {
    is_collecting = false;
    if (messages.empty())
      return;
    if (messages.size() == 1)
      throw InputError(messages.front());
    std::stable_sort(messages.begin(), messages.end(),
                     [&](const std::string &a, const std::string &b)
                     { return position_of(a, files) < position_of(b, files); });
    const std::size_t n_shown = std::min<std::size_t>(messages.size(), most_shown);
    std::string text =
        std::to_string(messages.size()) + " mistakes were found" +
        (n_shown < messages.size() ? ", of which these are the first " + std::to_string(n_shown)
                                   : "") +
        ":";
    for (std::size_t i = 0; i < n_shown; ++i)
      text += "\n" + std::string(i < 9 ? " " : "") + std::to_string(i + 1) + ". " + messages[i];
    throw InputError(text);
  }
} // namespace tombolo
