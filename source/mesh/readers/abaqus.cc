// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/readers/mesh_file.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <unordered_map>
#include <utility>

namespace tombolo
{
  namespace
  {
    std::string_view trimmed(std::string_view text)
    {
      const std::size_t begin = text.find_first_not_of(" \t");
      if (begin == text.npos)
        return {};
      return text.substr(begin, text.find_last_not_of(" \t") + 1 - begin);
    }

    std::string upper_case(std::string_view text)
    {
      std::string result(text);
      for (char &c : result)
        c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      return result;
    }

    /** The fields of a data or keyword line; a comma at its end opens no further field. */
    std::vector<std::string_view> fields_of(std::string_view line)
    {
      std::vector<std::string_view> fields;
      while (!line.empty())
      {
        const std::size_t comma = std::min(line.find(','), line.size());
        fields.push_back(trimmed(line.substr(0, comma)));
        line = trimmed(line.substr(std::min(comma + 1, line.size())));
      }
      return fields;
    }

    struct Keyword
    {
      std::string name; ///< upper case, without the star
      std::map<std::string, std::string> options;
    };

    Keyword parse_keyword(std::string_view line)
    {
      Keyword keyword;
      const auto fields = fields_of(line.substr(1));
      if (!fields.empty())
        keyword.name = upper_case(fields[0]);
      for (std::size_t i = 1; i < fields.size(); ++i)
      {
        const std::size_t equals = fields[i].find('=');
        const std::string option = upper_case(trimmed(fields[i].substr(0, equals)));
        keyword.options[option] =
            equals == fields[i].npos ? "" : std::string(trimmed(fields[i].substr(equals + 1)));
      }
      return keyword;
    }

    bool is_one_of(const std::string &text, const std::vector<std::string> &list)
    {
      return std::find(list.begin(), list.end(), text) != list.end();
    }

    /** Nodes of the faces S1, S2, ... of C3D8 and of four-node plane elements (Abaqus' manual,
     * "Three-dimensional solid element library" and "Plane element library"). */
    const std::vector<std::vector<unsigned int>> hexahedron_faces = {
        {0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
    const std::vector<std::vector<unsigned int>> quadrilateral_faces = {
        {0, 1}, {1, 2}, {2, 3}, {3, 0}};

    class AbaqusReader
    {
    public:
      AbaqusReader(std::string_view text, const unsigned int dim) : scanner(text), dim(dim) {}

      MeshFileContent read();

    private:
      enum class Data
      {
        none,
        skipped,
        nodes,
        elements,
        surface
      };

      void begin_section(const Keyword &keyword);
      void begin_elements(const Keyword &keyword);
      void begin_surface(const Keyword &keyword);
      void add_node(const std::vector<std::string_view> &fields);
      void add_element_fields(const std::vector<std::string_view> &fields);
      void add_face(const std::vector<std::string_view> &fields);
      void finish_element();
      /** The id of a name, a new one if the name is new. Ids count from 1. */
      static unsigned int id_of(std::map<std::string, unsigned int> &names,
                                const std::string &name);

      TextScanner scanner;
      const unsigned int dim;
      MeshFileContent content;
      std::unordered_map<long long, unsigned int> index_of_node;
      std::unordered_map<long long, std::size_t> cell_of_element;
      std::map<std::string, unsigned int> n_left_out;
      Data data = Data::none;
      unsigned int dimension_of_elements = 0;
      unsigned int id_of_elements = 0;
      unsigned int n_nodes_of_element = 0;
      unsigned int id_of_surface = 0;
      unsigned int element_line = 0;
      std::vector<long long> element_numbers;
      bool has_cells_without_set = false;
    };

    MeshFileContent AbaqusReader::read()
    {
      std::string_view line;
      while (scanner.next_line(line))
      {
        if (line.compare(0, 2, "**") == 0)
          continue;
        if (line[0] == '*')
        {
          finish_element();
          begin_section(parse_keyword(line));
          continue;
        }
        const auto fields = fields_of(line);
        switch (data)
        {
        case Data::nodes:
          add_node(fields);
          break;
        case Data::elements:
          add_element_fields(fields);
          break;
        case Data::surface:
          add_face(fields);
          break;
        case Data::skipped:
          break;
        default:
          scanner.fail("\"" + std::string(line.substr(0, 40)) +
                       "\" stands before the first keyword (*NODE, *ELEMENT, ...).");
        }
      }
      finish_element();
      if (content.nodes.empty())
        throw MeshFileError("There is no section *NODE.");
      if (has_cells_without_set && !content.group_names.empty())
        content.remarks.push_back("Some cells are in no ELSET; they are of material 0.");
      for (const auto &[keyword, count] : n_left_out)
        content.remarks.push_back("*" + keyword + " of the mesh file is left out (" +
                                  std::to_string(count) + (count == 1 ? " time)." : " times)."));
      return std::move(content);
    }

    unsigned int AbaqusReader::id_of(std::map<std::string, unsigned int> &names,
                                     const std::string &name)
    {
      return names.emplace(name, static_cast<unsigned int>(names.size()) + 1).first->second;
    }

    void AbaqusReader::begin_section(const Keyword &keyword)
    {
      if (is_one_of(keyword.name, {"PART", "ASSEMBLY", "INSTANCE", "ELSET"}))
        scanner.fail(
            "*" + keyword.name +
            " is not allowed: sets that are named apart from their elements, as Abaqus/CAE "
            "and gmsh write them, would be lost. Allowed are elements with their set, "
            "\"*ELEMENT, TYPE=C3D8, ELSET=NAME\", as Cubit writes them. From gmsh save "
            ".msh instead.");
      if (keyword.name == "NODE")
        data = Data::nodes;
      else if (keyword.name == "ELEMENT")
        begin_elements(keyword);
      else if (keyword.name == "SURFACE")
        begin_surface(keyword);
      else
      {
        data = Data::skipped;
        if (keyword.name != "HEADING")
          ++n_left_out[keyword.name];
      }
    }

    void AbaqusReader::begin_elements(const Keyword &keyword)
    {
      const auto option = keyword.options.find("TYPE");
      if (option == keyword.options.end())
        scanner.fail("*ELEMENT has no TYPE.");
      const std::string type = upper_case(option->second);
      if (is_one_of(type, {"C3D8", "C3D8R", "C3D8I", "C3D8H", "C3D8T", "C3D8RT"}))
        dimension_of_elements = 3;
      else if (is_one_of(type, {"CPS4", "CPS4R", "CPE4", "CPE4R", "S4", "S4R", "R3D4", "M3D4",
                                "M3D4R", "SFM3D4", "SFM3D4R"}))
        dimension_of_elements = 2;
      else if (is_one_of(type, {"T2D2", "T3D2", "B21", "B31", "R2D2"}))
        dimension_of_elements = 1;
      else
        scanner.fail("Elements of type " + type + " are not allowed. Allowed are " +
                     (dim == 3 ? "hexahedra of first order (C3D8, C3D8R) and faces of them (S4)."
                               : "quadrilaterals of first order (CPS4, CPE4, S4) and edges of them "
                                 "(T2D2, B21)."));
      if (dimension_of_elements > dim)
        scanner.fail("There are hexahedra (" + type +
                     "), and the scene has two dimensions. Allowed are quadrilaterals; or set "
                     "Dimension = 3.");

      data = Data::elements;
      n_nodes_of_element = 1u << dimension_of_elements;
      const auto set = keyword.options.find("ELSET");
      const bool has_set = set != keyword.options.end() && !set->second.empty();
      id_of_elements = 0;
      if (dimension_of_elements == dim)
      {
        if (has_set)
          id_of_elements = id_of(content.group_names, set->second);
        else
          has_cells_without_set = true;
      }
      else if (dimension_of_elements + 1 == dim)
      {
        if (!has_set)
          scanner.fail("*ELEMENT of type " + type +
                       " makes a boundary, and has no ELSET that names it.");
        id_of_elements = id_of(content.boundary_names, set->second);
      }
      else
        ++n_left_out["ELEMENT, TYPE=" + type];
    }

    void AbaqusReader::begin_surface(const Keyword &keyword)
    {
      const auto name = keyword.options.find("NAME");
      const auto type = keyword.options.find("TYPE");
      if (name == keyword.options.end() || name->second.empty())
        scanner.fail("*SURFACE has no NAME.");
      if (type != keyword.options.end() && upper_case(type->second) != "ELEMENT")
        scanner.fail("*SURFACE of TYPE " + type->second + " is not allowed. Allowed is ELEMENT.");
      data = Data::surface;
      id_of_surface = id_of(content.boundary_names, name->second);
    }

    void AbaqusReader::add_node(const std::vector<std::string_view> &fields)
    {
      if (fields.size() < 3 || fields.size() > 4)
        scanner.fail("A node is a number and two or three coordinates, separated by commas.");
      const long long number = scanner.to_integer(fields[0], "the number of a node");
      if (!index_of_node.emplace(number, static_cast<unsigned int>(content.nodes.size())).second)
        scanner.fail("There are two nodes of number " + std::to_string(number) + ".");
      std::array<double, 3> node = {};
      for (std::size_t d = 0; d + 1 < fields.size(); ++d)
        node[d] = scanner.to_real(fields[d + 1], "a coordinate of a node");
      content.nodes.push_back(node);
    }

    void AbaqusReader::add_element_fields(const std::vector<std::string_view> &fields)
    {
      if (element_numbers.empty())
        element_line = scanner.line_number();
      for (const auto &field : fields)
        element_numbers.push_back(scanner.to_integer(
            field, element_numbers.empty() ? "the number of an element" : "the number of a node"));
      if (element_numbers.size() > n_nodes_of_element)
        finish_element();
    }

    void AbaqusReader::finish_element()
    {
      if (element_numbers.empty())
        return;
      if (element_numbers.size() != n_nodes_of_element + 1)
        TextScanner::fail_at(element_line, "An element of this type has " +
                                               std::to_string(n_nodes_of_element) +
                                               " nodes, and this one has " +
                                               std::to_string(element_numbers.size() - 1) + ".");
      MeshFileElement element;
      element.line = element_line;
      element.id = id_of_elements;
      for (unsigned int k = 0; k < n_nodes_of_element; ++k)
      {
        const auto found = index_of_node.find(element_numbers[k + 1]);
        if (found == index_of_node.end())
          TextScanner::fail_at(element_line, "There is no node of number " +
                                                 std::to_string(element_numbers[k + 1]) + ".");
        element.nodes[k] = found->second;
      }
      if (dimension_of_elements == dim)
      {
        if (!cell_of_element.emplace(element_numbers[0], content.cells.size()).second)
          TextScanner::fail_at(element_line, "There are two elements of number " +
                                                 std::to_string(element_numbers[0]) + ".");
        content.cells.push_back(element);
      }
      else if (dimension_of_elements + 1 == dim)
        content.faces.push_back(element);
      element_numbers.clear();
    }

    void AbaqusReader::add_face(const std::vector<std::string_view> &fields)
    {
      const auto &faces = dim == 3 ? hexahedron_faces : quadrilateral_faces;
      const bool has_face = fields.size() == 2 && fields[1].size() == 2 &&
                            (upper_case(fields[1])[0] == 'S' || upper_case(fields[1])[0] == 'E') &&
                            fields[1][1] >= '1' &&
                            fields[1][1] < static_cast<char>('1' + faces.size());
      if (!has_face || fields[0].find_first_not_of("0123456789") != std::string_view::npos)
        scanner.fail("A line of *SURFACE is the number of an element and the name of its face, S1 "
                     "to S" +
                     std::to_string(faces.size()) + ". Sets of elements are not allowed.");
      const long long number = scanner.to_integer(fields[0], "the number of an element");
      const auto cell = cell_of_element.find(number);
      if (cell == cell_of_element.end())
        scanner.fail("There is no element of number " + std::to_string(number) +
                     " before this line.");
      MeshFileElement face;
      face.line = scanner.line_number();
      face.id = id_of_surface;
      const auto &places = faces[static_cast<std::size_t>(fields[1][1] - '1')];
      for (std::size_t k = 0; k < places.size(); ++k)
        face.nodes[k] = content.cells[cell->second].nodes[places[k]];
      content.faces.push_back(face);
    }
  } // namespace

  MeshFileContent read_abaqus(std::string_view text, const unsigned int dim)
  {
    return AbaqusReader(text, dim).read();
  }
} // namespace tombolo
