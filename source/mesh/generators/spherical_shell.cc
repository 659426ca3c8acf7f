// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/numbers.h>
#include <deal.II/grid/tria.h>
#include <deal.II/grid/tria_description.h>

#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/generators/axis_segments.h>
#include <tombolo/mesh/image_conditions.h>
#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/mesh_source.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace tombolo
{
  namespace
  {
    constexpr dealii::types::boundary_id inner_sphere_id = 0, outer_sphere_id = 1,
                                         first_plane_id = 2;
  } // namespace

  /**
   * The octant x, y, z >= 0 of a spherical shell about the origin, in hexahedra: three blocks of
   * the cubed sphere with equal angles between their lines, which meet on the diagonal, in layers.
   * Boundaries are called "inner", "outer", "symmetry x", "symmetry y" and "symmetry z", the planes
   * by their normals; vertices on a plane have the coordinate zero. All cells are coarse.
   */
  class SphericalShell : public MeshSource<3>
  {
  public:
    explicit SphericalShell(const Entries &e) : section(e.section())
    {
      const double inner = e.number("Inner radius", mandatory, positive(0.), "", "Units: length");
      const double outer = e.number("Outer radius", mandatory, positive(0.), "", "Units: length");
      e.refuse(!(outer > inner), "Outer radius",
               as_text("It must be larger than the inner radius, ", inner, "."));
      const unsigned int n_edge_cells =
          e.integer("Cells along edge", mandatory, at_least(2),
                    "The number of cells along each of the three edges of the octant's inner and "
                    "outer surface, quarters of a circle. It must be even.");
      e.refuse(n_edge_cells % 2 != 0, "Cells along edge",
               "Each edge belongs to two blocks: the number must be even, and at least 2.");
      const std::string text = e.text("Cells through thickness", mandatory, "",
                                      std::string("The layers from the inner surface on: ") +
                                          segments_syntax + ". Places are radii.");
      if (e.declares())
        return;
      n_block_cells = n_edge_cells / 2;
      const auto layers =
          parse_segments(section, text,
                         {"Cells through thickness", " through the thickness", "shell",
                          std::string("The layers are ") + segments_syntax, inner, outer, true});
      const double n_all =
          3. * n_block_cells * n_block_cells * static_cast<double>(n_cells(layers));
      refuse_too_many_cells(section, "Cells along edge", "shell", n_all);
      radii = segment_coordinates(layers);
    }

    void create(Mesh<3> &mesh) const override
    {
      const double n_all =
          3. * n_block_cells * n_block_cells * static_cast<double>(radii.size() - 1);
      refuse_more_than_memory(section, "Cells along edge", n_all, n_all,
                              communicator_of(mesh.triangulation));
      // The lattice of the three faces of a cube that contain its far corner.
      const unsigned int n = n_block_cells;
      using LatticeIndex = std::array<unsigned int, 3>;
      std::map<LatticeIndex, unsigned int> number_of;
      std::vector<dealii::Point<3>> directions;
      std::vector<LatticeIndex> lattice_indices;
      const auto number = [&](const LatticeIndex &index)
      {
        const auto [entry, is_new] =
            number_of.emplace(index, static_cast<unsigned int>(lattice_indices.size()));
        if (is_new)
        {
          dealii::Point<3> direction;
          for (unsigned int d = 0; d < 3; ++d)
            direction[d] = index[d] == n ? 1. : std::tan(numbers::PI / 4 * index[d] / n);
          directions.emplace_back(direction / direction.norm());
          lattice_indices.push_back(index);
        }
        return entry->second;
      };
      std::vector<std::array<unsigned int, 4>> quadrilaterals;
      for (unsigned int axis = 0; axis < 3; ++axis)
        for (unsigned int j = 0; j < n; ++j)
          for (unsigned int i = 0; i < n; ++i)
          {
            std::array<unsigned int, 4> quadrilateral;
            for (unsigned int corner = 0; corner < 4; ++corner)
            {
              LatticeIndex index;
              index[axis] = n;
              index[(axis + 1) % 3] = i + corner % 2;
              index[(axis + 2) % 3] = j + corner / 2;
              quadrilateral[corner] = number(index);
            }
            quadrilaterals.push_back(quadrilateral);
          }

      const auto n_in_layer = static_cast<unsigned int>(directions.size());
      std::vector<dealii::Point<3>> vertices;
      for (const double radius : radii)
        for (const auto &direction : directions)
          vertices.emplace_back(radius * direction);
      const std::vector<dealii::CellData<3>> cells =
          cells_of_layers(quadrilaterals, static_cast<unsigned int>(radii.size() - 1), n_in_layer);

      const auto id_of = [&](const auto &cell, const unsigned int f)
      {
        std::array<unsigned int, 4> face_vertices;
        for (unsigned int v = 0; v < 4; ++v)
          face_vertices[v] = cell->face(f)->vertex_index(v);
        const auto all = [&](const auto &condition)
        { return std::all_of(face_vertices.begin(), face_vertices.end(), condition); };
        dealii::types::boundary_id id = outer_sphere_id;
        if (all([&](const unsigned int v) { return v < n_in_layer; }))
          id = inner_sphere_id;
        else
          for (unsigned int d = 0; d < 3; ++d)
            if (all([&](const unsigned int v) { return lattice_indices[v % n_in_layer][d] == 0; }))
              id = first_plane_id + d;
        return id;
      };
      create_coarse_mesh(vertices, cells, id_of, mesh.triangulation);

      mesh.boundary_names["inner"] = inner_sphere_id;
      mesh.boundary_names["outer"] = outer_sphere_id;
      for (unsigned int d = 0; d < 3; ++d)
        mesh.boundary_names[name_of_cut("xyz"[d])] = first_plane_id + d;
    }

  private:
    Section section;
    unsigned int n_block_cells = 0; ///< along each edge of a block, half of those of the octant
    std::vector<double> radii;      ///< of the vertices, from the inner surface on
  };

  TOMBOLO_REGISTER(MeshSource<3>, SphericalShell, "spherical shell",
                   "The octant of a spherical shell: three blocks of cells in layers")
} // namespace tombolo
