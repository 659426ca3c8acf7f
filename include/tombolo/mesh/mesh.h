// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace tombolo
{
  /** A p4est-distributed triangulation with the names that its source gave to its parts. */
  template <int dim>
  struct Mesh
  {
    explicit Mesh(MPI_Comm communicator);

    dealii::parallel::distributed::Triangulation<dim> triangulation;
    /** Names of boundaries, for `set Boundary = ...` of a condition. */
    std::map<std::string, dealii::types::boundary_id> boundary_names;
    /** Names of groups of cells, for `set Cells = group NAME`. `material N` works always. */
    std::map<std::string, dealii::types::material_id> group_names;
    /** Names of boundaries that overlap others, each with all its ids. */
    std::map<std::string, std::set<dealii::types::boundary_id>> joint_boundaries;
    /** Names of groups of cells that overlap others, each with all its ids. */
    std::map<std::string, std::set<dealii::types::material_id>> joint_groups;
    /** What the source repaired or left out, for the audit ("3 cells turned round"). */
    std::vector<std::string> remarks;
  };
} // namespace tombolo
