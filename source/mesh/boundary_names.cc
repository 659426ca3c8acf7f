// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/registry.h>
#include <tombolo/mesh/boundary_names.h>

namespace tombolo
{
  template <int dim>
  std::set<dealii::types::boundary_id> boundary_ids(const Mesh<dim> &mesh, const Section &section,
                                                    const std::string &entry)
  {
    std::set<dealii::types::boundary_id> ids;
    for (const std::string &name : section.get_list(entry))
    {
      const auto found = mesh.boundary_names.find(name);
      if (found != mesh.boundary_names.end())
      {
        ids.insert(found->second);
        continue;
      }
      const auto joint = mesh.joint_boundaries.find(name);
      if (joint != mesh.joint_boundaries.end())
      {
        ids.insert(joint->second.begin(), joint->second.end());
        continue;
      }
      if (mesh.boundary_names.empty() && mesh.joint_boundaries.empty())
        section.fail(entry, "The mesh has no boundary \"" + name +
                                "\": none of its boundaries has a name. Choose by place, with a "
                                "predicate.");
      std::vector<std::string> names;
      std::string list;
      for (const auto &boundary : mesh.boundary_names)
        names.push_back(boundary.first);
      for (const auto &boundary : mesh.joint_boundaries)
        names.push_back(boundary.first);
      for (const auto &known : names)
        list += (list.empty() ? "\"" : ", \"") + known + "\"";
      const std::string nearest = nearest_name(name, names);
      std::string message = "The mesh has no boundary \"" + name + "\".";
      if (!nearest.empty())
        message += " Did you mean \"" + nearest + "\"?";
      message += " Its boundaries are " + list + ".";
      for (const auto &remark : mesh.remarks)
        if (remark.find("\"" + name + "\"") != std::string::npos)
          message += " " + remark;
      section.fail(entry, message);
    }
    return ids;
  }

  template std::set<dealii::types::boundary_id> boundary_ids(const Mesh<2> &, const Section &,
                                                             const std::string &);
  template std::set<dealii::types::boundary_id> boundary_ids(const Mesh<3> &, const Section &,
                                                             const std::string &);
} // namespace tombolo
