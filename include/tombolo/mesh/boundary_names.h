// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/types.h>

#include <tombolo/base/input/name_hints.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/mesh/mesh.h>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace tombolo
{
  /** The ids of a name among those with one id and those with several. Where it is none of them:
   * no ids, and in @p problem the names of this @p kind, in the plural @p kinds. */
  inline std::set<unsigned int>
  ids_of_name(const std::map<std::string, unsigned int> &single,
              const std::map<std::string, std::set<unsigned int>> &joint, const std::string &name,
              const std::string &kind, const std::string &kinds, std::string &problem)
  {
    if (const auto found = single.find(name); found != single.end())
      return {found->second};
    if (const auto found = joint.find(name); found != joint.end())
      return found->second;
    std::vector<std::string> names;
    for (const auto &single_name : single)
      names.push_back(single_name.first);
    for (const auto &joint_name : joint)
      names.push_back(joint_name.first);
    problem = "The mesh has no " + kind + " " + in_quotes(name) + "." + did_you_mean(name, names) +
              " Its " + kinds + " are " + in_quotes(names) + ".";
    return {};
  }

  /** Splits names into those with one id and those with several. */
  inline void split_names(const std::map<std::string, std::set<unsigned int>> &ids_of_names,
                          std::map<std::string, unsigned int> &single,
                          std::map<std::string, std::set<unsigned int>> &joint)
  {
    for (const auto &[name, ids] : ids_of_names)
      if (ids.size() == 1)
        single.emplace(name, *ids.begin());
      else
        joint.emplace(name, ids);
  }

  /** The ids of the comma-separated boundary names in an entry, for example `x min, struck end`.
   * Throws InputError for a name that the mesh does not have, with the nearest one, all names, and
   * what the source of the mesh has remarked about it. */
  template <int dim>
  std::set<dealii::types::boundary_id> boundary_ids(const Mesh<dim> &mesh, const Section &section,
                                                    const std::string &entry)
  {
    std::set<dealii::types::boundary_id> result;
    for (const std::string &name : section.get_list(entry))
    {
      std::string problem;
      const auto ids = ids_of_name(mesh.boundary_names, mesh.joint_boundaries, name, "boundary",
                                   "boundaries", problem);
      if (mesh.boundary_names.empty() && mesh.joint_boundaries.empty())
        problem = "The mesh has no boundary \"" + name +
                  "\": none of its boundaries has a name. Choose by place, with a predicate.";
      else if (ids.empty())
        for (const auto &remark : mesh.remarks)
          if (remark.find("\"" + name + "\"") != std::string::npos)
            problem += " " + remark;
      if (ids.empty())
        section.fail(entry, problem);
      result.insert(ids.begin(), ids.end());
    }
    return result;
  }
} // namespace tombolo
