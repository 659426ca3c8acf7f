// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/registry.h>

#include <algorithm>
#include <cctype>
#include <numeric>
#include <tuple>

namespace tombolo
{
  namespace
  {
    /** Upper and lower case, and the ways to part words, count as equal. */
    std::string simplified(std::string name)
    {
      for (char &c : name)
        c = c == '_' || c == '-' ? ' '
                                 : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      return name;
    }

    /** The number of characters to insert, remove, replace, or exchange with their neighbour. */
    std::size_t edit_distance(const std::string &a, const std::string &b)
    {
      std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
      std::iota(last.begin(), last.end(), std::size_t(0));
      for (std::size_t i = 1; i <= a.size(); ++i)
      {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j)
        {
          row[j] = std::min({last[j] + 1, row[j - 1] + 1,
                             last[j - 1] + static_cast<std::size_t>(a[i - 1] != b[j - 1])});
          if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
            row[j] = std::min(row[j], before_last[j - 2] + 1);
        }
        before_last.swap(last);
        last.swap(row);
      }
      return last[b.size()];
    }

    /** "implicit" is no mistyped "explicit". */
    bool are_opposites(const std::string &a, const std::string &b)
    {
      const auto begin = [](const std::string &text) { return text.substr(0, 2); };
      return a.size() > 4 && b.size() == a.size() && a.substr(2) == b.substr(2) &&
             ((begin(a) == "im" && begin(b) == "ex") || (begin(a) == "ex" && begin(b) == "im"));
    }

    std::vector<PluginDescription> &all_plugins()
    {
      static std::vector<PluginDescription> plugins;
      return plugins;
    }

    std::string &registration_problems()
    {
      static std::string problems;
      return problems;
    }
  } // namespace

  std::string nearest_name(const std::string &name, const std::vector<std::string> &candidates)
  {
    // Longer texts are no mistyped names.
    constexpr std::size_t longest = 200;
    if (name.size() > longest)
      return "";
    const std::string simplified_name = simplified(name);
    std::string nearest;
    std::size_t smallest = (name.size() + 1) / 2;
    for (const auto &candidate : candidates)
      if (candidate.size() <= longest && !are_opposites(simplified_name, simplified(candidate)))
      {
        const std::size_t distance = edit_distance(simplified_name, simplified(candidate));
        if (distance < smallest)
        {
          smallest = distance;
          nearest = candidate;
        }
      }
    return nearest;
  }

  std::vector<PluginDescription> list_plugins()
  {
    auto plugins = all_plugins();
    std::sort(plugins.begin(), plugins.end(),
              [](const auto &a, const auto &b)
              { return std::tie(a.kind, a.name) < std::tie(b.kind, b.name); });
    return plugins;
  }

  namespace internal
  {
    void note_plugin(const PluginDescription &description)
    {
      auto &plugins = all_plugins();
      const bool is_known =
          std::any_of(plugins.begin(), plugins.end(),
                      [&](const PluginDescription &plugin) {
                        return plugin.kind == description.kind && plugin.name == description.name;
                      });
      if (!is_known)
        plugins.push_back(description);
    }

    void note_registration_problem(const std::string &problem)
    {
      auto &problems = registration_problems();
      problems += (problems.empty() ? "" : " ") + problem;
    }

    std::string release_registration_problems()
    {
      std::string problems;
      problems.swap(registration_problems());
      return problems;
    }
  } // namespace internal
} // namespace tombolo
