// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/boundary/region.h>

#include <tombolo/mesh/boundary_names.h>

namespace tombolo
{
  template <int dim>
  Place<dim>::Place(const Section &section, const bool may_be_everywhere)
  {
    const bool has_where = !section.get("Where").empty();
    const bool has_boundary = !section.get("Boundary").empty();
    if (has_where)
      where.emplace(section, "Where");
    if (!has_where && !has_boundary && !may_be_everywhere)
      section.fail("", "a condition needs `Where`, a predicate such as \"x < 1e-9\", or "
                       "`Boundary`, the name of a boundary.");
  }

  template <int dim>
  void Place<dim>::find_boundaries(const Mesh<dim> &mesh, const Section &section)
  {
    if (section.is_set("Boundary"))
      boundaries = boundary_ids(mesh, section, "Boundary");
  }

  template <int dim>
  void Place<dim>::fail_empty(const Section &section, const std::string &what) const
  {
    section.fail(where ? "Where" : "Boundary",
                 "the condition selects no " + what + "; it would do nothing.");
  }

  template class Place<2>;
  template class Place<3>;
} // namespace tombolo
