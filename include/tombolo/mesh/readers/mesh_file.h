// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/readers/text_scanner.h>

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace tombolo
{
  /** A cell or a face of a mesh file. */
  struct MeshFileElement
  {
    /** Indices into MeshFileContent::nodes, counted round the bottom face and then round the top
     * face, as gmsh and VTK do. Unused ones are zero. */
    std::array<unsigned int, 8> nodes = {};
    unsigned int id = 0;   ///< material or boundary id
    unsigned int line = 0; ///< in the file
  };

  /** A named set of a mesh file. */
  struct MeshFileSet
  {
    std::string name;
    std::vector<unsigned int> members; ///< indices of cells or of nodes
  };

  /** What a mesh file holds, for a scene of two or three dimensions: cells are hexahedra and faces
   * quadrilaterals, or cells are quadrilaterals and faces lines. */
  struct MeshFileContent
  {
    std::vector<std::array<double, 3>> nodes;
    std::vector<long long> node_numbers; ///< in the file
    std::vector<MeshFileElement> cells;
    /** A face may be listed several times, with several ids. */
    std::vector<MeshFileElement> faces;
    std::map<std::string, unsigned int> group_names;    ///< of cells
    std::map<std::string, unsigned int> boundary_names; ///< of faces
    /** Groups by indices of cells. They may overlap each other and the groups above. */
    std::vector<MeshFileSet> cell_sets;
    /** Boundaries by indices of nodes: the boundary faces all of whose nodes are in the set. */
    std::vector<MeshFileSet> node_sets;
    std::vector<std::string> remarks; ///< what was left out
    /** What MeshFileElement::line counts: elements where a binary file has no lines. */
    std::string unit = "line";

    /** "line 5". */
    std::string location(unsigned int line) const
    {
      return unit + " " + std::to_string(line);
    }
  };

  /** gmsh's .msh, version 2.2 or 4.1, in text or binary. Physical groups become ids and names; one
   * that has no name is called by its number. Named groups of points are sets of nodes. Throws
   * MeshFileError, as all of these. */
  MeshFileContent read_gmsh(std::string_view text, unsigned int dim);

  /** VTK's legacy format 3.0, an unstructured grid in text with `SCALARS MaterialID int`. */
  MeshFileContent read_vtk(std::string_view text, unsigned int dim);

  /** "hexahedra" or "quadrilaterals": what the cells must be. */
  const char *cell_shape(unsigned int dim);

  /** The end of a message about other cells or faces: how to get those that are allowed. */
  std::string shape_advice(unsigned int dim);

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
