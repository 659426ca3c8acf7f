// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/readers/mesh_file.h>

#include <vector>

namespace tombolo
{
  /**
   * Makes the distributed triangulation of what a file holds, its coordinates multiplied by
   * @p scale, with names and remarks. Turns cells that are numbered the wrong way round. Throws
   * MeshFileError for flat or twisted cells, cells that fit together badly, and faces that belong
   * to no cell. All ranks must hold the same content.
   */
  template <int dim>
  void assemble_mesh(const MeshFileContent &content, double scale, Mesh<dim> &mesh);

  /** The numbers in the file of the nodes that cells have as corners: by the vertices of the mesh
   * that assemble_mesh() makes. */
  template <int dim>
  std::vector<long long> numbers_of_vertices(const MeshFileContent &content);
} // namespace tombolo
