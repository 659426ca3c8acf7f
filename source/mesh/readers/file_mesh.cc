// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/input_file.h>
#include <tombolo/mesh/communicator_of.h>
#include <tombolo/mesh/memory_check.h>
#include <tombolo/mesh/mesh_source.h>
#include <tombolo/mesh/readers/mesh_assembly.h>
#include <tombolo/mesh/readers/mesh_file.h>

#include <string>

namespace tombolo
{
  /**
   * A mesh from a file of gmsh (.msh) or VTK (.vtk), of hexahedra (quadrilaterals in 2-D). Named
   * groups of cells and named boundaries keep their names. Cells that are numbered the wrong way
   * round are turned, and named surfaces inside the body are no boundaries; both are remarked.
   * Rank 0 reads the file and sends it to the others.
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
          "of cells, boundaries and sets of nodes), or a legacy .vtk 3.0 (\"SCALARS MaterialID "
          "int\"). scripts/import makes one of a deck of Abaqus or LS-DYNA. It is looked for in "
          "the directory of the parameter file and then in the working directory.");
      e.refuse(file.empty(), "File", "The name of the mesh file is empty.");
      const std::string kind = extension_of(file);
      e.refuse(kind == ".inp" || kind == ".k" || kind == ".key" || kind == ".dyn", "File",
               "This is a deck. scripts/import " + file +
                   " makes a mesh of it (.msh), and a parameter file.");
      is_of_gmsh = kind == ".msh";
      e.refuse(!is_of_gmsh && kind != ".vtk", "File",
               "The kind of the file is told from the end of its name. Allowed are .msh (gmsh) and "
               ".vtk (VTK, legacy).");
      scale = e.number("Scale", "1", positive(), "",
                       "Coordinates are multiplied by this, for example 0.001 for a file in "
                       "millimetres in a scene in metres.");
    }

    /** Throws InputError on every rank where the file cannot be read or makes no mesh. */
    void create(Mesh<dim> &mesh) const override
    {
      const MPI_Comm communicator = communicator_of(mesh.triangulation);
      try
      {
        const MeshFileContent content = read(communicator);
        const auto n_cells = static_cast<double>(content.cells.size());
        refuse_more_than_memory(section, "File", n_cells, n_cells, communicator);
        assemble_mesh<dim>(content, scale, mesh);
      }
      catch (const MeshFileError &error)
      {
        section.fail("File", "In \"" + file + "\", " + error.what());
      }
    }

    /** The same. */
    std::vector<long long> node_numbers() const override
    {
      try
      {
        return numbers_of_vertices<dim>(read(section.all().communicator()));
      }
      catch (const MeshFileError &error)
      {
        section.fail("File", "In \"" + file + "\", " + error.what());
      }
    }

  private:
    MeshFileContent read(const MPI_Comm communicator) const
    {
      const std::string text = decoded_text(read_input_file(section, "File", communicator));
      return is_of_gmsh ? read_gmsh(text, dim) : read_vtk(text, dim);
    }

    Section section;
    std::string file;
    bool is_of_gmsh;
    double scale;
  };

  template class FileMesh<2>;

  template class FileMesh<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(MeshSource, FileMesh, "file",
                                  "A mesh of gmsh (.msh) or VTK (.vtk)")
} // namespace tombolo
