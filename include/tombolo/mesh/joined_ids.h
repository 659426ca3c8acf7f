// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace tombolo
{
  using NamedIds = std::map<std::string, std::set<unsigned int>>;

  /** The ids that faces or cells of all meshes have, and their names. */
  class JoinedIds
  {
  public:
    void begin_mesh(const std::string &name)
    {
      mesh = name;
      of_mesh.clear();
    }

    /** The id here of an id of the present mesh: the same where no earlier mesh has it. */
    unsigned int id(const unsigned int own)
    {
      const auto [found, is_new] = of_mesh.emplace(own, own);
      if (is_new && !taken.insert(own).second)
        taken.insert(found->second = *taken.rbegin() + 1);
      return found->second;
    }

    /** By ids of the present mesh that are known so far. */
    const std::map<unsigned int, unsigned int> &known() const
    {
      return of_mesh;
    }

    void add_names(const std::map<std::string, unsigned int> &single, const NamedIds &joint)
    {
      NamedIds names = joint;
      for (const auto &[name, own] : single)
        names[name].insert(own);
      for (const auto &[name, of_name] : names)
      {
        std::set<unsigned int> here;
        for (const unsigned int own : of_name)
          here.insert(id(own));
        add_name(mesh + "." + name, here);
        unqualified[name].push_back(here);
      }
    }

    void add_name(const std::string &name, const std::set<unsigned int> &here)
    {
      all[name].insert(here.begin(), here.end());
    }

    /** The names of all meshes, those with one id and those with several. */
    void give_names(std::map<std::string, unsigned int> &single, NamedIds &joint) const
    {
      NamedIds names = all;
      for (const auto &[name, of_meshes] : unqualified)
        if (of_meshes.size() == 1)
          names.emplace(name, of_meshes.front());
      for (const auto &[name, here] : names)
        if (here.size() == 1)
          single.emplace(name, *here.begin());
        else
          joint.emplace(name, here);
    }

  private:
    std::string mesh;
    std::map<unsigned int, unsigned int> of_mesh; ///< here, by ids of the present mesh
    std::set<unsigned int> taken;
    NamedIds all;
    std::map<std::string, std::vector<std::set<unsigned int>>> unqualified; ///< of each mesh
  };
} // namespace tombolo
