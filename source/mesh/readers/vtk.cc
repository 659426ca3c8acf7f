// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/readers/mesh_file.h>

#include <boost/algorithm/string/case_conv.hpp>

#include <utility>

namespace tombolo
{
  namespace
  {
    constexpr int hexahedron = 12;
    constexpr int quadrilateral = 9;

    /** Words of VTK do not differ by case. */
    std::string upper_case(const std::string_view word)
    {
      return boost::to_upper_copy(std::string(word));
    }

    const char *const allowed_data = "Allowed is one set of data: CELL_DATA with \"SCALARS "
                                     "MaterialID int\" and \"LOOKUP_TABLE default\".";

    class VtkReader
    {
    public:
      VtkReader(std::string_view text, const unsigned int dim) : scanner(text), dim(dim) {}

      MeshFileContent read()
      {
        read_header();
        while (!scanner.is_at_end())
        {
          const std::string word = upper_case(scanner.word("a section"));
          if (word == "POINTS")
            read_points();
          else if (word == "CELLS")
            read_cells();
          else if (word == "CELL_TYPES")
            read_cell_types();
          else if (word == "CELL_DATA")
            read_cell_data();
          else
            scanner.fail("\"" + word.substr(0, 40) +
                         "\" is not allowed here. Allowed are POINTS, CELLS, CELL_TYPES and "
                         "CELL_DATA. " +
                         allowed_data);
        }
        if (content.nodes.empty())
          throw MeshFileError("There are no POINTS.");
        if (!content.cells.empty() && !has_types)
          throw MeshFileError("There are no CELL_TYPES.");
        if (!has_materials)
          content.remarks.push_back(
              "The mesh file has no MaterialID: all cells are of material 0.");
        return std::move(content);
      }

    private:
      void read_header()
      {
        std::string_view line;
        const std::string signature = "# vtk DataFile Version ";
        if (!scanner.next_line(line) || line.compare(0, signature.size(), signature) != 0)
          scanner.fail("A legacy VTK file begins with \"" + signature + "3.0\".");
        const std::string version(line.substr(signature.size()));
        if (version != "3.0")
          scanner.fail("This is version " + version.substr(0, 40) +
                       " of the legacy VTK format. Allowed is 3.0.");
        scanner.rest_of_line();
        // The title, which may be blank.
        scanner.rest_of_line();
        const std::string kind = upper_case(scanner.word("ASCII"));
        if (kind != "ASCII")
          scanner.fail("\"" + kind.substr(0, 40) +
                       "\" stands where ASCII should: only text is "
                       "allowed.");
        const std::string keyword = upper_case(scanner.word("DATASET"));
        const std::string dataset = upper_case(scanner.word("UNSTRUCTURED_GRID"));
        if (keyword != "DATASET" || dataset != "UNSTRUCTURED_GRID")
          scanner.fail("\"" + keyword.substr(0, 40) + " " + dataset.substr(0, 40) +
                       "\" is not allowed. Allowed is DATASET UNSTRUCTURED_GRID.");
      }

      void read_points()
      {
        const std::size_t n_points = scanner.count("the number of points");
        scanner.word("the type of the coordinates");
        for (std::size_t i = 0; i < n_points; ++i)
        {
          std::array<double, 3> point;
          for (double &coordinate : point)
            coordinate = scanner.real("a coordinate of a point");
          content.node_numbers.push_back(static_cast<long long>(content.nodes.size()));
          content.nodes.push_back(point);
        }
      }

      void read_cells()
      {
        const std::size_t n_cells = scanner.count("the number of cells");
        scanner.count("the size of the list of cells");
        const std::size_t n_nodes = std::size_t(1) << dim;
        for (std::size_t i = 0; i < n_cells; ++i)
        {
          const std::size_t n_of_cell = scanner.count("the number of points of a cell");
          if (n_of_cell != n_nodes)
            scanner.fail("A cell has " + std::to_string(n_of_cell) + " points. Allowed are only " +
                         cell_shape(dim) + ", of " + std::to_string(n_nodes) + ".");
          MeshFileElement cell;
          cell.line = scanner.line_number();
          for (std::size_t k = 0; k < n_nodes; ++k)
          {
            const std::size_t point = scanner.count("the number of a point");
            if (point >= content.nodes.size())
              scanner.fail("There is no point of number " + std::to_string(point) + ": there are " +
                           std::to_string(content.nodes.size()) + ", counted from 0.");
            cell.nodes[k] = static_cast<unsigned int>(point);
          }
          content.cells.push_back(cell);
        }
      }

      void read_cell_types()
      {
        const std::size_t n_types = scanner.count("the number of cell types");
        if (n_types != content.cells.size())
          scanner.fail("There are " + std::to_string(n_types) + " cell types and " +
                       std::to_string(content.cells.size()) + " cells.");
        const int allowed = dim == 3 ? hexahedron : quadrilateral;
        for (std::size_t i = 0; i < n_types; ++i)
        {
          const long long type = scanner.integer("the type of a cell");
          if (type != allowed)
            scanner.fail("A cell is of VTK's type " + std::to_string(type) + ". Allowed are only " +
                         cell_shape(dim) + ", type " + std::to_string(allowed) + ".");
        }
        has_types = true;
      }

      void read_cell_data()
      {
        if (scanner.count("the number of cells") != content.cells.size())
          scanner.fail("The number of CELL_DATA is not that of the cells, " +
                       std::to_string(content.cells.size()) + ".");
        const std::string kind = upper_case(scanner.word("SCALARS"));
        const std::string name(scanner.word("MaterialID"));
        const std::string type(scanner.word("int"));
        if (kind != "SCALARS" || name != "MaterialID" || type != "int")
          scanner.fail("The cell data \"" + (kind + " " + name + " " + type).substr(0, 80) +
                       "\" are not allowed. " + allowed_data);
        std::string word = upper_case(scanner.word("LOOKUP_TABLE"));
        if (word == "1")
          word = upper_case(scanner.word("LOOKUP_TABLE"));
        if (word != "LOOKUP_TABLE")
          scanner.fail("\"" + word.substr(0, 40) + "\" stands where LOOKUP_TABLE should.");
        scanner.word("the name of the lookup table");
        for (auto &cell : content.cells)
        {
          const long long material = scanner.integer("a material number");
          if (material < 0 || material > 2000000000)
            scanner.fail("The material number " + std::to_string(material) +
                         " is outside 0 to 2000000000.");
          cell.id = static_cast<unsigned int>(material);
        }
        has_materials = true;
      }

      TextScanner scanner;
      const unsigned int dim;
      MeshFileContent content;
      bool has_types = false;
      bool has_materials = false;
    };
  } // namespace

  MeshFileContent read_vtk(const std::string_view text, const unsigned int dim)
  {
    return VtkReader(text, dim).read();
  }
} // namespace tombolo
