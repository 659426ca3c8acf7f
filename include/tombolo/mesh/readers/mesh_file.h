// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/readers/text_scanner.h>

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace tombolo
{
  /** A cell or a face as it stands in a mesh file. */
  struct MeshFileElement
  {
    /** Indices into MeshFileContent::nodes, counted round the bottom face and then round the top
     * face, as gmsh, Abaqus and VTK do. Unused ones are zero. */
    std::array<unsigned int, 8> nodes = {};
    unsigned int id = 0;   ///< material or boundary id
    unsigned int line = 0; ///< in the file
  };

  /** What a mesh file holds, for a scene of two or three dimensions: cells are hexahedra and faces
   * quadrilaterals, or cells are quadrilaterals and faces lines. */
  struct MeshFileContent
  {
    std::vector<std::array<double, 3>> nodes;
    std::vector<MeshFileElement> cells;
    std::vector<MeshFileElement> faces;
    std::map<std::string, unsigned int> group_names;    ///< of cells
    std::map<std::string, unsigned int> boundary_names; ///< of faces
    std::vector<std::string> remarks;                   ///< what was left out
  };

  /** gmsh's .msh, version 2.2 or 4.1, in text. Physical groups become ids and names; one that has
   * no name is called by its number. Throws MeshFileError, as all of these. */
  MeshFileContent read_gmsh(std::string_view text, unsigned int dim);

  /** Abaqus' .inp with all elements in `*ELEMENT, TYPE=..., ELSET=NAME`, as Cubit writes it. Each
   * ELSET is a group of cells or a boundary; `*SURFACE` with faces of elements is a boundary. */
  MeshFileContent read_abaqus(std::string_view text, unsigned int dim);

  /** VTK's legacy format 3.0 in text, an unstructured grid, with material ids in the cell data
   * `SCALARS MaterialID int`. */
  MeshFileContent read_vtk(std::string_view text, unsigned int dim);

  /** "hexahedra" or "quadrilaterals": what the cells must be. */
  const char *cell_shape(unsigned int dim);
} // namespace tombolo
