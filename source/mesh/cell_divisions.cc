// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/cell_divisions.h>

#include <tombolo/base/on_ranks.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  std::uint64_t persistent_id(const CellId &cell, const unsigned int bits_per_level)
  {
    std::uint64_t path = 1;
    const auto children = cell.get_child_indices();
    AssertThrow(children.size() * bits_per_level < path_bits, ExcNotImplemented());
    for (const auto child : children)
      path = (path << bits_per_level) | static_cast<std::uint64_t>(child);
    return (static_cast<std::uint64_t>(cell.get_coarse_cell_id()) << path_bits) | path;
  }

  template <int dim>
  CellDivisions divided_cells(const Mesh<dim> &mesh)
  {
    CellDivisions own;
    for (const auto &cell : mesh.triangulation.active_cell_iterators())
    {
      if (!cell->is_locally_owned())
        continue;
      // Each divided cell is counted by the one below it that is the first child throughout.
      std::uint64_t id = persistent_id(cell->id(), dim);
      for (int level = cell->level(); level > 0 && index_in_parent<dim>(id) == 0; --level)
        own.push_back(id = parent_of<dim>(id));
    }
    CellDivisions result = from_all_ranks(own, communicator_of(mesh.triangulation));
    std::sort(result.begin(), result.end());
    return result;
  }

  template <int dim>
  void divide(DividedMesh<dim> &mesh, const CellDivisions &divisions)
  {
    if (!divisions.empty())
      mesh.of_file = divided_cells(mesh);
    auto &triangulation = mesh.triangulation;
    while (!divisions.empty())
    {
      unsigned int n_flags = 0;
      for (const auto &cell : triangulation.active_cell_iterators())
        if (cell->is_locally_owned() &&
            std::binary_search(divisions.begin(), divisions.end(), persistent_id(cell->id(), dim)))
        {
          cell->set_refine_flag();
          ++n_flags;
        }
      if (Utilities::MPI::sum(n_flags, communicator_of(triangulation)) == 0)
        return;
      triangulation.execute_coarsening_and_refinement();
    }
  }

  template CellDivisions divided_cells(const Mesh<2> &);
  template CellDivisions divided_cells(const Mesh<3> &);
  template void divide(DividedMesh<2> &, const CellDivisions &);
  template void divide(DividedMesh<3> &, const CellDivisions &);
} // namespace tombolo
