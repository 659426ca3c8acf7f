// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/persistent_cell_ids.h>

#include <tombolo/mesh/cells_of_part.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** A number of a cell that depends on nothing but its coarse cell and its place in it: the path
     * through the children, behind a leading one that tells its length. */
    std::uint64_t persistent_id(const CellId &cell, const unsigned int bits_per_level)
    {
      constexpr unsigned int path_bits = 37;
      std::uint64_t path = 1;
      const auto children = cell.get_child_indices();
      AssertThrow(children.size() * bits_per_level < path_bits, ExcNotImplemented());
      for (const auto child : children)
        path = (path << bits_per_level) | static_cast<std::uint64_t>(child);
      return (static_cast<std::uint64_t>(cell.get_coarse_cell_id()) << path_bits) | path;
    }
  } // namespace

  template <int dim>
  std::vector<std::uint64_t> persistent_ids_of_cells(const Nodes<dim> &nodes,
                                                     const PartCells<dim> &part_cells,
                                                     const unsigned int part)
  {
    std::vector<std::uint64_t> ids;
    for (const auto &cell : cells_of_part(nodes, part_cells, part))
      ids.push_back(persistent_id(cell->id(), dim));
    return ids;
  }

  template std::vector<std::uint64_t> persistent_ids_of_cells(const Nodes<2> &,
                                                              const PartCells<2> &, unsigned int);
  template std::vector<std::uint64_t> persistent_ids_of_cells(const Nodes<3> &,
                                                              const PartCells<3> &, unsigned int);
} // namespace tombolo
