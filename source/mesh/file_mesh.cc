#include <deal.II/base/mpi.h>

#include <tombolo/mesh/file_mesh.h>
#include <tombolo/mesh/memory_check.h>
#include <tombolo/mesh/mesh_assembly.h>
#include <tombolo/mesh/mesh_file.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

namespace tombolo
{
  template <int dim>
  void FileMesh<dim>::declare_parameters(dealii::ParameterHandler &handler)
  {
    Parameters::declare_mandatory(
        handler, "File", dealii::Patterns::Anything(),
        "The mesh: a .msh of gmsh (2.2 or 4.1, text; physical groups name groups of cells and "
        "boundaries), an .inp of Abaqus as Cubit writes it (\"*ELEMENT, TYPE=C3D8, ELSET=NAME\"; "
        "`material N` counts the sets from 1 in their order), or a legacy .vtk 3.0 (\"SCALARS "
        "MaterialID int\"). It is looked for in the directory of the parameter file and then in "
        "the working directory.");
    handler.declare_entry("Scale", "1", dealii::Patterns::Double(),
                          "Coordinates are multiplied by this, for example 0.001 for a file in "
                          "millimetres in a scene in metres.");
  }

  template <int dim>
  FileMesh<dim>::FileMesh(const Section &section)
      : section(section), file(section.get("File")), scale(section.get_positive("Scale"))
  {
    if (file.empty())
      section.fail("File", "The name of the mesh file is empty.");
  }

  template <int dim>
  std::string FileMesh<dim>::read_text(MPI_Comm communicator) const
  {
    namespace fs = std::filesystem;
    std::string text;
    std::string error;
    if (dealii::Utilities::MPI::this_mpi_process(communicator) == 0)
    {
      // An entry of an included file means the directory of that file.
      const auto &parameters = section.all();
      std::vector<fs::path> candidates;
      for (const auto &beside :
           {parameters.location(section.path() + "/File").file, parameters.file_name()})
        if (!beside.empty())
          candidates.push_back(fs::path(beside).parent_path() / file);
      candidates.push_back(file);

      std::error_code ignored;
      const auto found =
          std::find_if(candidates.begin(), candidates.end(),
                       [&](const fs::path &path) { return fs::exists(path, ignored); });
      if (found == candidates.end())
      {
        error = "There is no such file, neither in the directory of the parameter file nor in the "
                "working directory.";
      }
      else if (fs::is_directory(*found, ignored))
        error = "This is a directory. The name of a mesh file is needed.";
      else
      {
        std::ifstream stream(*found, std::ios::binary);
        text.assign(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
        if (!stream && !stream.eof())
          error = "The file cannot be read: check its permissions.";
        else if (text.find_first_not_of(" \t\r\n") == text.npos)
          error = "The file is empty.";
      }
    }
    error = dealii::Utilities::MPI::broadcast(communicator, error, 0);
    if (!error.empty())
      section.fail("File", error);

    std::size_t size = dealii::Utilities::MPI::broadcast(communicator, text.size(), 0);
    text.resize(size);
    dealii::Utilities::MPI::broadcast(text.data(), size, 0, communicator);
    return text;
  }

  template <int dim>
  void FileMesh<dim>::create(Mesh<dim> &mesh) const
  {
    std::string extension = std::filesystem::path(file).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](const unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const auto read = extension == ".msh"   ? read_gmsh
                      : extension == ".inp" ? read_abaqus
                      : extension == ".vtk" ? read_vtk
                                            : nullptr;
    if (read == nullptr)
      section.fail("File", "The kind of the file is told from the end of its name. Allowed are "
                           ".msh (gmsh), .inp (Abaqus) and .vtk (VTK, legacy).");

    const std::string text = read_text(mesh.triangulation.get_communicator());
    try
    {
      const MeshFileContent content = read(text, dim);
      const auto n_cells = static_cast<double>(content.cells.size());
      refuse_more_than_memory(section, "File", n_cells, n_cells,
                              mesh.triangulation.get_communicator());
      assemble_mesh<dim>(content, scale, mesh);
    }
    catch (const MeshFileError &error)
    {
      section.fail("File", "In \"" + file + "\", " + error.what());
    }
  }

  template class FileMesh<2>;
  template class FileMesh<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(MeshSource, FileMesh, "file",
                                  "A mesh of gmsh (.msh), Abaqus (.inp) or VTK (.vtk)")
} // namespace tombolo
