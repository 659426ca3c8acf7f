// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <deal.II/base/config.h>
#include <deal.II/distributed/tria.h>

#include <map>
#include <mpi.h>
#include <set>
#include <string>
#include <vector>

namespace tombolo
{
  /** A p4est-distributed triangulation with the names that its source has for its parts. */
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

  /** The communicator of a triangulation or a DoFHandler, in all versions of deal.II. */
  template <class Mesh>
  MPI_Comm communicator_of(const Mesh &mesh)
  {
#if DEAL_II_VERSION_GTE(9, 7, 0)
    return mesh.get_mpi_communicator();
#else
    return mesh.get_communicator();
#endif
  }

  /**
   * Refuses, at an entry of a mesh source, a mesh that this machine cannot hold, before anything of
   * it is built: coarse cells take about 2 kB on every rank, and each cell with its nodes and
   * material points about 1 kB on one, which is less than any model needs. Throws InputError.
   * Collective.
   */
  void refuse_more_than_memory(const Section &section, const std::string &entry,
                               double n_coarse_cells, double n_cells, MPI_Comm communicator);

  extern template struct Mesh<2>;
  extern template struct Mesh<3>;
} // namespace tombolo
