// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <tombolo/base/on_ranks.h>

#include <mesh_testing.h>
#include <temporary_file.h>

#include <cmath>

namespace tombolo
{
  namespace testing
  {
    inline const std::string meshes = source_directory() + "/tests/meshes/";

    template <int dim>
    std::unique_ptr<Mesh<dim>> mesh_of(const std::string &file, const std::string &entries = "")
    {
      return MeshScene<dim>("file", "set File = " + file + "\n" + entries).create_mesh();
    }

    inline std::string replaced(std::string text, const std::string &old_part,
                                const std::string &new_part)
    {
      const auto position = text.find(old_part);
      EXPECT_NE(position, std::string::npos) << old_part;
      return position == std::string::npos ? text
                                           : text.replace(position, old_part.size(), new_part);
    }

    template <int dim>
    std::string error_of_file(const std::string &text, const std::string &extension)
    {
      const TemporaryFile file(text, extension);
      return input_error([&]() { mesh_of<dim>(file.path); });
    }

    /** Volumes of the cells by material and areas of the boundary by id. Volumes are signed. */
    template <int dim>
    struct Measures
    {
      explicit Measures(const Mesh<dim> &mesh)
      {
        struct Item
        {
          unsigned int id;
          double measure;
        };
        std::vector<Item> cells, faces;
        for (const auto &cell : mesh.triangulation.active_cell_iterators())
          if (cell->is_locally_owned())
          {
            cells.push_back({cell->material_id(), cell->measure()});
            for (const unsigned int f : cell->face_indices())
              if (cell->face(f)->at_boundary())
                faces.push_back({cell->face(f)->boundary_id(), cell->face(f)->measure()});
          }
        for (const Item &cell : from_all_ranks(cells, MPI_COMM_WORLD))
          volume[cell.id] += cell.measure;
        for (const Item &face : from_all_ranks(faces, MPI_COMM_WORLD))
          area[face.id] += face.measure;
      }

      std::map<unsigned int, double> volume;
      std::map<unsigned int, double> area;
    };

    /** The measure of what has a name of its own, or is of several numbers. */
    template <typename Single, typename Joint>
    double measure_of(const std::map<unsigned int, double> &measures, const Single &names,
                      const Joint &joint, const std::string &name)
    {
      const auto single = names.find(name);
      if (single != names.end())
        return measures.at(single->second);
      double sum = 0;
      for (const auto id : joint.at(name))
        sum += measures.at(id);
      return sum;
    }

    inline double volume_of(const Mesh<3> &mesh, const std::string &group)
    {
      return measure_of(Measures<3>(mesh).volume, mesh.group_names, mesh.joint_groups, group);
    }

    inline double area_of(const Mesh<3> &mesh, const std::string &boundary)
    {
      return measure_of(Measures<3>(mesh).area, mesh.boundary_names, mesh.joint_boundaries,
                        boundary);
    }

    inline ::testing::AssertionResult has_remark(const std::vector<std::string> &remarks,
                                                 const std::string &part)
    {
      std::string all;
      for (const auto &remark : remarks)
      {
        if (remark.find(part) != std::string::npos)
          return ::testing::AssertionSuccess();
        all += remark + "\n";
      }
      return ::testing::AssertionFailure() << "\"" << part << "\" is not among\n" << all;
    }
  } // namespace testing
} // namespace tombolo
