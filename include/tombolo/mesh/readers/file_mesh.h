// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/mesh_source.h>

#include <string>

namespace tombolo
{
  /**
   * A mesh from a file of gmsh (.msh), Abaqus (.inp), LS-DYNA (.k) or VTK (.vtk), of hexahedra
   * (quadrilaterals in 2-D). Named groups of cells and named boundaries keep their names. Cells
   * that are numbered the wrong way round are turned, and named surfaces inside the body are no
   * boundaries; both are remarked. Rank 0 reads the file and sends it to the others.
   */
  template <int dim>
  class FileMesh : public MeshSource<dim>
  {
  public:
    explicit FileMesh(const Entries &e);

    /** Throws InputError on every rank where the file cannot be read or makes no mesh. */
    void create(Mesh<dim> &mesh) const override;

  private:
    Section section;
    std::string file;
    double scale;
  };
} // namespace tombolo
