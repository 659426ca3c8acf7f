// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/grid/tria.h>
#include <deal.II/grid/tria_description.h>

#include <algorithm>
#include <vector>

namespace tombolo
{
  /** Cells of one level of a triangulation, with what makes a triangulation of them. */
  template <int dim>
  struct LevelCells
  {
    LevelCells() = default;

    LevelCells(const dealii::Triangulation<dim> &triangulation, const unsigned int level)
    {
      unsigned int n_vertices = 0;
      for (const auto &cell : triangulation.cell_iterators_on_level(level))
      {
        dealii::CellData<dim> data(cell->n_vertices());
        for (const unsigned int v : cell->vertex_indices())
        {
          data.vertices[v] = cell->vertex_index(v);
          n_vertices = std::max(n_vertices, cell->vertex_index(v) + 1);
        }
        data.material_id = cell->material_id();
        for (const unsigned int f : cell->face_indices())
          if (cell->face(f)->at_boundary())
            faces.push_back({cells.size(), f, cell->face(f)->boundary_id()});
        cells.push_back(data);
      }
      const auto &of_all = triangulation.get_vertices();
      vertices.assign(of_all.begin(), of_all.begin() + n_vertices);
    }

    void fill(dealii::Triangulation<dim> &triangulation) const
    {
      triangulation.create_triangulation(vertices, cells, dealii::SubCellData());
      for (const Face &face : faces)
        typename dealii::Triangulation<dim>::cell_iterator(&triangulation, 0,
                                                           static_cast<int>(face.cell))
            ->face(face.number)
            ->set_boundary_id(face.id);
    }

    /** Each cell divided n times along each axis. */
    LevelCells refined(const unsigned int n) const
    {
      dealii::Triangulation<dim> triangulation;
      fill(triangulation);
      triangulation.refine_global(n);
      return LevelCells(triangulation, n);
    }

    struct Face
    {
      std::size_t cell;
      unsigned int number; ///< in the cell
      dealii::types::boundary_id id;
    };

    std::vector<dealii::Point<dim>> vertices;
    std::vector<dealii::CellData<dim>> cells;
    std::vector<Face> faces; ///< on the boundary
  };
} // namespace tombolo
