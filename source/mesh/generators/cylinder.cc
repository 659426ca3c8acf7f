// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/tria.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/communicator_of.h>
#include <tombolo/mesh/generators/cylinder.h>
#include <tombolo/mesh/image_conditions.h>
#include <tombolo/mesh/memory_check.h>

#include <cmath>

namespace tombolo
{
  namespace
  {
    constexpr dealii::types::boundary_id lower_id = 0, upper_id = 1, side_id = 2, first_cut_id = 3;

    constexpr Cylinder::Words words_of_cylinder = {"cylinder", "Length", "Cells along axis",
                                                   "Foot",     "foot",   "rear"};
  } // namespace

  Cylinder::Cylinder(const Entries &e) : Cylinder(e, words_of_cylinder) {}

  Cylinder::Cylinder(const Entries &e, const Words &words) : words(words), section(e.section())
  {
    const std::string body = words.body;
    const std::string lower = words.lower_boundary;
    if (e.declares())
      declare<RoundSection>(e, std::array<char, 2>(), words.body);
    axis =
        static_cast<unsigned int>(e.choice("Axis", "z", "x|y|z",
                                           "The direction from the " + lower + " of the " + body +
                                               " to its " + words.upper_boundary + ".")[0] -
                                  'x');
    across = {{(axis + 1) % 3, (axis + 2) % 3}};
    const std::vector<double> position = e.numbers(
        words.position, "0, 0, 0", 3, "", "The centre of the " + lower + ". Units: length");
    const double length = e.number(words.length, mandatory, positive(0.), "",
                                   "The extent along the axis. Units: length");
    const std::string text =
        e.text(words.layers, mandatory, "",
               "The layers of cells from the " + lower + " on: " + segments_syntax +
                   ". Places are heights above the " + lower + ".");
    if (e.declares())
      return;
    for (unsigned int d = 0; d < 3; ++d)
      foot[d] = position[d];
    const auto layers =
        parse_segments(section, text,
                       {words.layers, " along the axis", words.body,
                        std::string("The layers are ") + segments_syntax, 0, length, true});
    round_section = std::make_unique<RoundSection>(
        section, std::array<char, 2>{{"xyz"[across[0]], "xyz"[across[1]]}}, words.body);

    const double n_all =
        static_cast<double>(round_section->cells().size()) * static_cast<double>(n_cells(layers));
    refuse_too_many_cells(section, words.layers, words.body, n_all);
    heights = segment_coordinates(layers);
  }

  void Cylinder::create(Mesh<3> &mesh) const
  {
    const double n_all = static_cast<double>(round_section->cells().size()) *
                         static_cast<double>(heights.size() - 1);
    refuse_more_than_memory(section, words.layers, n_all, n_all,
                            communicator_of(mesh.triangulation));
    const auto &section_vertices = round_section->vertices();
    const auto n_in_section = static_cast<unsigned int>(section_vertices.size());
    std::vector<dealii::Point<3>> vertices;
    vertices.reserve(heights.size() * n_in_section);
    for (const double height : heights)
      for (const auto &vertex : section_vertices)
      {
        dealii::Point<3> place = foot;
        for (unsigned int d = 0; d < 2; ++d)
          place[across[d]] += vertex.place[d];
        place[axis] += height;
        vertices.push_back(place);
      }

    const auto last_layer = static_cast<unsigned int>(heights.size() - 1);
    std::vector<dealii::CellData<3>> cells =
        cells_of_layers(round_section->cells(), last_layer, n_in_section);
    // p4est needs the directions of common edges to agree.
    dealii::GridTools::consistently_order_cells(cells);

    dealii::Triangulation<3> coarse;
    coarse.create_triangulation(vertices, cells, dealii::SubCellData());
    for (const auto &cell : coarse.active_cell_iterators())
      for (const unsigned int f : cell->face_indices())
        if (cell->face(f)->at_boundary())
        {
          const auto all = [&](const auto &condition)
          {
            for (unsigned int v = 0; v < 4; ++v)
            {
              const unsigned int vertex = cell->face(f)->vertex_index(v);
              if (!condition(vertex / n_in_section, section_vertices[vertex % n_in_section]))
                return false;
            }
            return true;
          };
          dealii::types::boundary_id id = side_id;
          if (all([](const unsigned int layer, const auto &) { return layer == 0; }))
            id = lower_id;
          else if (all([&](const unsigned int layer, const auto &) { return layer == last_layer; }))
            id = upper_id;
          else if (!all([](unsigned int, const auto &vertex) { return vertex.is_at_rim; }))
            for (unsigned int d = 0; d < 2; ++d)
              if (all([&](unsigned int, const auto &vertex) { return vertex.place[d] == 0; }))
                id = first_cut_id + across[d];
          cell->face(f)->set_boundary_id(id);
        }
    mesh.triangulation.copy_triangulation(coarse);

    mesh.boundary_names[words.lower_boundary] = lower_id;
    mesh.boundary_names[words.upper_boundary] = upper_id;
    mesh.boundary_names["side"] = side_id;
    for (unsigned int d = 0; d < 2; ++d)
      if (round_section->is_cut(d))
        mesh.boundary_names[name_of_cut("xyz"[across[d]])] = first_cut_id + across[d];
  }

  TOMBOLO_REGISTER(MeshSource<3>, Cylinder, "cylinder",
                   "A cylinder along an axis, or its half or quarter: a core and rings of cells")
} // namespace tombolo
