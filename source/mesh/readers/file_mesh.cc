// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/input_file.h>
#include <tombolo/mesh/communicator_of.h>
#include <tombolo/mesh/memory_check.h>
#include <tombolo/mesh/mesh_source.h>
#include <tombolo/mesh/readers/mesh_assembly.h>
#include <tombolo/mesh/readers/mesh_file.h>

#include <string>
#include <utility>

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
    explicit FileMesh(const Entries &e) : section(e.section())
    {
      file = e.text(
          "File", mandatory, "",
          "The mesh: a .msh of gmsh (2.2 or 4.1, text or binary; physical groups name groups "
          "of cells and boundaries), an .inp of Abaqus (sets of elements, parts and instances "
          "are groups; surfaces and sets of nodes are boundaries; `material N` counts the "
          "sets of cells from 1 in their order), a .k or .key of LS-DYNA (parts and sets of "
          "solids are groups; sets of segments and nodes are boundaries; `material N` is part "
          "N), or a legacy .vtk 3.0 (\"SCALARS MaterialID int\"). It is looked for in the "
          "directory of the parameter file and then in the working directory.");
      e.refuse(file.empty(), "File", "The name of the mesh file is empty.");
      scale = e.number("Scale", "1", positive(), "",
                       "Coordinates are multiplied by this, for example 0.001 for a file in "
                       "millimetres in a scene in metres.");
    }

    /** Throws InputError on every rank where the file cannot be read or makes no mesh. */
    void create(Mesh<dim> &mesh) const override
    {
      const std::string extension = extension_of(file);
      const auto read = extension == ".msh"   ? read_gmsh
                        : extension == ".inp" ? read_abaqus
                        : extension == ".vtk" ? read_vtk
                        : extension == ".k" || extension == ".key" || extension == ".dyn"
                            ? read_keyword
                            : nullptr;
      if (read == nullptr)
        section.fail("File",
                     "The kind of the file is told from the end of its name. Allowed are "
                     ".msh (gmsh), .inp (Abaqus), .k, .key or .dyn (LS-DYNA) and .vtk (VTK, "
                     "legacy).");

      const MPI_Comm communicator = communicator_of(mesh.triangulation);
      std::string text = read_input_file(section, "File", communicator);
      const auto read_included = [&](const std::string &path)
      {
        std::string included;
        const std::string error = load_input_file(section, "File", path, communicator, included);
        if (!error.empty())
          throw MeshFileError(error);
        return decoded_text(std::move(included));
      };
      try
      {
        text = decoded_text(std::move(text));
        const MeshFileContent content = read({text, file, read_included}, dim);
        const auto n_cells = static_cast<double>(content.cells.size());
        refuse_more_than_memory(section, "File", n_cells, n_cells, communicator);
        assemble_mesh<dim>(content, scale, mesh);
      }
      catch (const MeshFileError &error)
      {
        section.fail("File", "In \"" + file + "\", " + error.what());
      }
    }

  private:
    Section section;
    std::string file;
    double scale;
  };

  template class FileMesh<2>;

  template class FileMesh<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      MeshSource, FileMesh, "file",
      "A mesh of gmsh (.msh), Abaqus (.inp), LS-DYNA (.k) or VTK (.vtk)")
} // namespace tombolo
