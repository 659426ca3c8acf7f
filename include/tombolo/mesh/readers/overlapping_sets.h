// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * Ids of items that may be in several named sets, where an item can have one id only: every
   * combination of sets that occurs has an id, and a set has the ids of all combinations with it.
   * A set that overlaps no other keeps its own id.
   */
  class OverlappingSets
  {
  public:
    /** The combination without sets. Its id is zero. */
    static constexpr unsigned int none = 0;

    /** @p names and ids as the mesh file has them. */
    explicit OverlappingSets(const std::map<std::string, unsigned int> &names)
    {
      members.emplace_back();
      combination_of_members[{}] = none;
      for (const auto &[name, id] : names)
        set_of_names[name] = set_of_id(id);
    }

    /** The set of an id of the file, with or without a name. */
    unsigned int set_of_id(const unsigned int id)
    {
      const auto found = set_of_known.find(id);
      return found != set_of_known.end() ? found->second : add_set(id);
    }

    /** The set of a name. A new one has the smallest id above those that are known. */
    unsigned int set_of_name(const std::string &name)
    {
      const auto found = set_of_names.find(name);
      if (found != set_of_names.end())
        return found->second;
      const unsigned int id = set_of_known.empty() ? 1 : set_of_known.rbegin()->first + 1;
      return set_of_names[name] = add_set(id);
    }

    /** The combination that has @p set in addition to those of @p combination. */
    unsigned int extended(const unsigned int combination, const unsigned int set)
    {
      const auto entry = extensions.emplace(std::make_pair(combination, set), combination);
      if (entry.second)
      {
        std::vector<unsigned int> sets = members[combination];
        const auto position = std::lower_bound(sets.begin(), sets.end(), set);
        if (position == sets.end() || *position != set)
          sets.insert(position, set);
        const auto known =
            combination_of_members.emplace(sets, static_cast<unsigned int>(members.size()));
        if (known.second)
          members.push_back(std::move(sets));
        entry.first->second = known.first->second;
      }
      return entry.first->second;
    }

    /** Assigns ids to the combinations of all items. A combination of one set has the id of the
     * set, another one that of its first set if no other combination has it. */
    void assign_ids(const std::vector<unsigned int> &combinations)
    {
      const std::set<unsigned int> in_use(combinations.begin(), combinations.end());
      std::vector<unsigned int> order(in_use.begin(), in_use.end());
      std::sort(order.begin(), order.end(),
                [this](const unsigned int a, const unsigned int b)
                {
                  return members[a].size() != members[b].size()
                             ? members[a].size() < members[b].size()
                             : members[a] < members[b];
                });
      unsigned int next = set_of_known.empty() ? 1 : set_of_known.rbegin()->first + 1;
      std::set<unsigned int> used_ids;
      ids[none] = 0;
      for (const unsigned int combination : order)
        if (combination != none)
        {
          const unsigned int preferred = preferred_ids[members[combination].front()];
          ids[combination] = used_ids.insert(preferred).second ? preferred : next++;
        }
    }

    unsigned int id_of(const unsigned int combination) const
    {
      return ids.at(combination);
    }

    /** Names of the sets that have items, each with its ids. */
    std::map<std::string, std::set<unsigned int>> ids_of_names() const
    {
      std::map<std::string, std::set<unsigned int>> result;
      for (const auto &[combination, id] : ids)
        for (const auto &[name, set] : set_of_names)
          if (std::binary_search(members[combination].begin(), members[combination].end(), set))
            result[name].insert(id);
      return result;
    }

  private:
    unsigned int add_set(const unsigned int id)
    {
      const auto set = static_cast<unsigned int>(preferred_ids.size());
      preferred_ids.push_back(id);
      set_of_known[id] = set;
      return set;
    }

    std::vector<unsigned int> preferred_ids;           ///< of the sets
    std::map<unsigned int, unsigned int> set_of_known; ///< by preferred id
    std::map<std::string, unsigned int> set_of_names;
    std::vector<std::vector<unsigned int>> members; ///< sets of each combination, sorted
    std::map<std::vector<unsigned int>, unsigned int> combination_of_members;
    std::map<std::pair<unsigned int, unsigned int>, unsigned int> extensions;
    std::map<unsigned int, unsigned int> ids; ///< of combinations that items have
  };
} // namespace tombolo
