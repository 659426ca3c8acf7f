// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/persistent_cell_ids.h>

#include <tombolo/mesh/cell_divisions.h>
#include <tombolo/mesh/cells_of_part.h>

namespace tombolo
{
  using namespace dealii;

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
