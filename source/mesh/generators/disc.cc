// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/tria.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/communicator_of.h>
#include <tombolo/mesh/generators/disc.h>
#include <tombolo/mesh/image_conditions.h>
#include <tombolo/mesh/memory_check.h>

#include <cmath>

namespace tombolo
{
  namespace
  {
    constexpr Cylinder::Words words_of_disc = {"disc",     "Thickness",  "Cells through thickness",
                                               "Position", "lower face", "upper face"};
  }

  Disc<2>::Disc(const Entries &e) : section(e.section()), round_section(e, {{'x', 'y'}}, "disc")
  {
    const std::vector<double> position =
        e.numbers("Position", "0, 0", 2, "", "The centre of the disc. Units: length");
    for (unsigned int d = 0; d < 2; ++d)
      centre[d] = position[d];
  }

  void Disc<2>::create(Mesh<2> &mesh) const
  {
    const auto n_all = static_cast<double>(round_section.cells().size());
    refuse_more_than_memory(section, "Core cells", n_all, n_all,
                            communicator_of(mesh.triangulation));
    std::vector<dealii::Point<2>> vertices;
    for (const auto &vertex : round_section.vertices())
      vertices.push_back(centre + vertex.place);
    std::vector<dealii::CellData<2>> cells;
    for (const auto &quadrilateral : round_section.cells())
    {
      dealii::CellData<2> cell;
      cell.vertices.assign(quadrilateral.begin(), quadrilateral.end());
      cell.material_id = 0;
      cells.push_back(cell);
    }
    // Nodes on a common edge have one order only if both cells see it in the same direction.
    dealii::GridTools::consistently_order_cells(cells);

    dealii::Triangulation<2> coarse;
    coarse.create_triangulation(vertices, cells, dealii::SubCellData());
    for (const auto &cell : coarse.active_cell_iterators())
      for (const unsigned int f : cell->face_indices())
        if (cell->face(f)->at_boundary())
        {
          const auto &first = round_section.vertices()[cell->face(f)->vertex_index(0)];
          const auto &second = round_section.vertices()[cell->face(f)->vertex_index(1)];
          dealii::types::boundary_id id = 0;
          if (!first.is_at_rim || !second.is_at_rim)
            id = first.place[0] == 0 && second.place[0] == 0 ? 1 : 2;
          cell->face(f)->set_boundary_id(id);
        }
    mesh.triangulation.copy_triangulation(coarse);

    mesh.boundary_names["side"] = 0;
    for (unsigned int d = 0; d < 2; ++d)
      if (round_section.is_cut(d))
        mesh.boundary_names[name_of_cut("xy"[d])] = d + 1;
  }

  Disc<3>::Disc(const Entries &e) : Cylinder(e, words_of_disc) {}

  TOMBOLO_REGISTER_FOR_DIMENSIONS(MeshSource, Disc, "disc",
                                  "A disc, or its half or quarter: a core and rings of cells")
} // namespace tombolo
