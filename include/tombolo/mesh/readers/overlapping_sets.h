// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * Ids of things that may be in several named sets, where a thing can have one id only: every
   * combination of sets that occurs has an id, and a set has the ids of all combinations with it.
   * A set that overlaps no other one keeps its own id.
   */
  class OverlappingSets
  {
  public:
    /** The combination without sets. Its id is zero. */
    static constexpr unsigned int none = 0;

    /** @p names and ids as the mesh file has them. */
    explicit OverlappingSets(const std::map<std::string, unsigned int> &names);

    /** The set of an id of the file, with or without a name. */
    unsigned int set_of_id(unsigned int id);
    /** The set of a name. A new one has the smallest id above those that are known. */
    unsigned int set_of_name(const std::string &name);

    /** The combination that has @p set beside those of @p combination. */
    unsigned int extended(unsigned int combination, unsigned int set);
    /** Gives ids to the combinations of all things. A combination of one set has the id of the set,
     * another one that of its first set if no other combination has it. */
    void assign_ids(const std::vector<unsigned int> &combinations);
    unsigned int id_of(unsigned int combination) const;
    /** Names of the sets that have things, each with its ids. */
    std::map<std::string, std::set<unsigned int>> ids_of_names() const;

  private:
    unsigned int add_set(unsigned int id);

    std::vector<unsigned int> preferred_ids;           ///< of the sets
    std::map<unsigned int, unsigned int> set_of_known; ///< by preferred id
    std::map<std::string, unsigned int> set_of_names;
    std::vector<std::vector<unsigned int>> members; ///< sets of each combination, sorted
    std::map<std::vector<unsigned int>, unsigned int> combination_of_members;
    std::map<std::pair<unsigned int, unsigned int>, unsigned int> extensions;
    std::map<unsigned int, unsigned int> ids; ///< of combinations that things have
  };
} // namespace tombolo
