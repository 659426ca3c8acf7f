// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/boundary_names.h>

namespace tombolo
{
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

  template std::set<dealii::types::boundary_id> boundary_ids(const Mesh<2> &, const Section &,
                                                             const std::string &);
  template std::set<dealii::types::boundary_id> boundary_ids(const Mesh<3> &, const Section &,
                                                             const std::string &);
} // namespace tombolo
