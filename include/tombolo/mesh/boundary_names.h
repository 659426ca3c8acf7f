// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/types.h>

#include <tombolo/base/input/parameters.h>
#include <tombolo/mesh/mesh.h>

#include <set>
#include <string>

namespace tombolo
{
  /** The ids of the comma-separated boundary names in an entry, for example `x min, struck end`.
   * Throws InputError for a name that the mesh does not have, with the nearest one, all names, and
   * what the source of the mesh has remarked about it. */
  template <int dim>
  std::set<dealii::types::boundary_id> boundary_ids(const Mesh<dim> &mesh, const Section &section,
                                                    const std::string &entry);
} // namespace tombolo
