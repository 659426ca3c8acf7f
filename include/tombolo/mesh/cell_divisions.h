// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/mesh.h>

#include <deal.II/grid/cell_id.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace tombolo
{
  /** Cells, by persistent_id(), ascending; the same on all ranks. */
  using CellDivisions = std::vector<std::uint64_t>;

  /** The lowest bits of a persistent_id(): those of the path. */
  constexpr unsigned int path_bits = 37;
  constexpr std::uint64_t path_mask = (std::uint64_t(1) << path_bits) - 1;

  /** A number of a cell that depends on nothing but its coarse cell and its position in it: the
   * path through the children, behind a leading one that marks its length. */
  std::uint64_t persistent_id(const dealii::CellId &cell, unsigned int bits_per_level);

  /** The persistent_id() of the parent, of a child, and which child of its parent a cell is. */
  template <int dim>
  std::uint64_t parent_of(const std::uint64_t id)
  {
    return (id & ~path_mask) | ((id & path_mask) >> dim);
  }
  template <int dim>
  std::uint64_t child_of(const std::uint64_t id, const unsigned int child)
  {
    return (id & ~path_mask) | (((id & path_mask) << dim) | child);
  }
  template <int dim>
  unsigned int index_in_parent(const std::uint64_t id)
  {
    return static_cast<unsigned int>(id & ((1u << dim) - 1u));
  }

  /** A mesh whose cells can be divided further than those of the file. */
  template <int dim>
  struct DividedMesh : Mesh<dim>
  {
    using Mesh<dim>::Mesh;

    /** divided_cells() of the mesh of the file; none: it is this one. */
    std::optional<CellDivisions> of_file;
  };

  /** The divided cells of all ranks, all above active ones, by ascending number. Collective. */
  template <int dim>
  CellDivisions divided_cells(const Mesh<dim> &mesh);

  /** Divides cells of a mesh of the file that are among @p divisions, as often as they are;
   * neighbours that would then differ by more than one level are divided for it. Collective. */
  template <int dim>
  void divide(DividedMesh<dim> &mesh, const CellDivisions &divisions);
} // namespace tombolo
