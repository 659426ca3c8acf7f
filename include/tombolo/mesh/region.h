// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/expression.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/mesh/boundary_names.h>
#include <tombolo/mesh/mesh.h>

#include <deal.II/base/point.h>

#include <optional>
#include <set>
#include <string>

namespace tombolo
{
  /** Where a condition acts: the entries `Where`, a predicate of the initial position, and
   * `Boundary`, names of boundaries, of its section. If both are given both must hold. */
  template <int dim>
  class Region
  {
  public:
    /** Reads both entries. Throws InputError without one, unless it @p may_be_everywhere. */
    Region(const Section &section, const bool may_be_everywhere)
    {
      const bool has_where = !section.get("Where").empty();
      const bool has_boundary = !section.get("Boundary").empty();
      if (has_where)
        where.emplace(section, "Where");
      if (!has_where && !has_boundary && !may_be_everywhere)
        section.fail("", "a condition needs `Where`, a predicate such as \"x < 1e-9\", or "
                         "`Boundary`, the name of a boundary.");
    }

    /** Finds the boundaries by their names; to be called before all below. Throws InputError. */
    void find_boundaries(const Mesh<dim> &mesh, const Section &section)
    {
      if (section.is_set("Boundary"))
        boundaries = boundary_ids(mesh, section, "Boundary");
    }

    /** Whether there are names of boundaries. */
    bool has_boundaries() const
    {
      return !boundaries.empty();
    }

    /** Whether this is one of the boundaries named. */
    bool has_boundary(const dealii::types::boundary_id id) const
    {
      return boundaries.count(id) > 0;
    }

    /** Whether the predicate holds. Throws InputError, on one rank, where it has no value. */
    bool contains(const dealii::Point<dim> &point) const
    {
      return !where || (*where)(point);
    }

    /** Whether a face of the boundary is one of those named, if there are names, and has its centre
     * where the predicate holds. Throws likewise. */
    bool contains_face(const dealii::types::boundary_id id, const dealii::Point<dim> &centre) const
    {
      return (boundaries.empty() || has_boundary(id)) && contains(centre);
    }

    /** Throws the InputError that nothing is selected; @p what is "node", for example. */
    [[noreturn]] void fail_empty(const Section &section, const std::string &what) const
    {
      section.fail(where ? "Where" : "Boundary",
                   "the condition selects no " + what + "; it would do nothing.");
    }

  private:
    std::optional<Predicate<dim>> where;
    std::set<dealii::types::boundary_id> boundaries;
  };
} // namespace tombolo
