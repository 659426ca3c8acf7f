// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/readers/mesh_file.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

namespace tombolo
{
  namespace
  {
    struct ElementType
    {
      const char *name; ///< plural
      unsigned int dimension;
      unsigned int n_nodes;
      bool is_linear_cube; ///< line, quadrilateral, hexahedron or point of degree one
    };

    /** gmsh's numbers of element types, from its manual, section "MSH file format". */
    const std::map<long long, ElementType> element_types = {
        {15, {"points", 0, 1, true}},
        {1, {"lines", 1, 2, true}},
        {8, {"lines of 3 nodes", 1, 3, false}},
        {26, {"lines of 4 nodes", 1, 4, false}},
        {2, {"triangles", 2, 3, false}},
        {3, {"quadrilaterals", 2, 4, true}},
        {9, {"triangles of 6 nodes", 2, 6, false}},
        {10, {"quadrilaterals of 9 nodes", 2, 9, false}},
        {16, {"quadrilaterals of 8 nodes", 2, 8, false}},
        {4, {"tetrahedra", 3, 4, false}},
        {5, {"hexahedra", 3, 8, true}},
        {6, {"prisms", 3, 6, false}},
        {7, {"pyramids", 3, 5, false}},
        {11, {"tetrahedra of 10 nodes", 3, 10, false}},
        {12, {"hexahedra of 27 nodes", 3, 27, false}},
        {17, {"hexahedra of 20 nodes", 3, 20, false}},
        {18, {"prisms of 15 nodes", 3, 15, false}},
        {13, {"prisms of 18 nodes", 3, 18, false}},
        {14, {"pyramids of 14 nodes", 3, 14, false}},
        {19, {"pyramids of 13 nodes", 3, 13, false}}};

    const char *const remedy =
        " Recombine the mesh into hexahedra (quadrilaterals in 2-D) of first "
        "order and save it anew.";

    class GmshReader
    {
    public:
      GmshReader(std::string_view text, const unsigned int dim) : scanner(text), dim(dim) {}

      MeshFileContent read();

    private:
      void read_format();
      void read_physical_names();
      void read_entities();
      void read_nodes();
      void read_elements();
      void skip_section(const std::string &name);
      void end_section(const std::string &name);

      void add_node(long long tag);
      /** Reads the nodes of an element of the type and keeps it if its dimension matters. */
      void add_element(const ElementType &type, unsigned int physical);
      const ElementType &element_type(long long number);
      unsigned int physical_of_entity(unsigned int dimension, long long tag);
      unsigned int as_id(long long tag) const;
      std::string group_name(unsigned int dimension, unsigned int physical) const;

      TextScanner scanner;
      const unsigned int dim;
      bool is_version_4 = false;
      MeshFileContent content;
      std::unordered_map<long long, unsigned int> index_of_node;
      std::map<std::pair<unsigned int, unsigned int>, std::string> physical_names;
      std::map<std::pair<unsigned int, long long>, std::vector<unsigned int>> entity_physicals;
      std::set<std::string> sections_left_out;
      bool has_nodes = false;
      bool has_elements = false;
    };

    MeshFileContent GmshReader::read()
    {
      read_format();
      std::string_view line;
      while (scanner.next_line(line))
      {
        const std::string section(line);
        if (section == "$PhysicalNames")
          read_physical_names();
        else if (section == "$Entities")
          read_entities();
        else if (section == "$Nodes")
          read_nodes();
        else if (section == "$Elements")
          read_elements();
        else if (section == "$PartitionedEntities" || section == "$GhostElements")
          scanner.fail("The mesh is partitioned (" + section +
                       "). Save it whole: the program distributes it itself.");
        else if (section.size() > 1 && section[0] == '$' && section.compare(0, 4, "$End") != 0)
        {
          skip_section(section.substr(1));
          if (section != "$Comments")
            sections_left_out.insert(section);
        }
        else
          scanner.fail("\"" + section.substr(0, 40) +
                       "\" stands where a section ($Nodes, $Elements, ...) should begin.");
      }
      if (!has_nodes || !has_elements)
        throw MeshFileError(std::string("There is no section ") +
                            (has_nodes ? "$Elements" : "$Nodes") + ".");

      std::set<unsigned int> boundaries_in_use;
      for (const auto &face : content.faces)
        boundaries_in_use.insert(face.id);
      for (const auto &[key, name] : physical_names)
      {
        auto &names = key.first == dim ? content.group_names : content.boundary_names;
        if (key.first + 1 < dim || key.first > dim)
          content.remarks.push_back("The physical group \"" + name + "\" of dimension " +
                                    std::to_string(key.first) +
                                    " is left out: it is neither of cells nor of faces.");
        else if (!names.emplace(name, key.second).second)
          throw MeshFileError("Two physical groups of dimension " + std::to_string(key.first) +
                              " are called \"" + name + "\".");
      }
      for (const unsigned int boundary : boundaries_in_use)
        if (boundary != 0 && physical_names.count({dim - 1, boundary}) == 0)
          content.boundary_names.emplace(std::to_string(boundary), boundary);
      for (const auto &section : sections_left_out)
        content.remarks.push_back("The section " + section + " of the mesh file is left out.");
      return std::move(content);
    }

    void GmshReader::read_format()
    {
      std::string_view line;
      if (!scanner.next_line(line) || line != "$MeshFormat")
        scanner.fail("A file of gmsh begins with $MeshFormat. Allowed are versions 2.2 and 4.1 in "
                     "text.");
      const std::string version(scanner.word("the version of the format"));
      if (version != "2.2" && version != "4.1")
        scanner.fail("This is version " + version +
                     " of gmsh's format. Allowed are 2.2 and 4.1: save it anew with \"gmsh -save "
                     "-format msh41\".");
      is_version_4 = version == "4.1";
      if (scanner.integer("the kind of file, 0 for text") != 0)
        scanner.fail("This is a binary file of gmsh. Allowed is text: save it anew with \"gmsh "
                     "-save -bin 0\".");
      scanner.integer("the size of a number");
      end_section("MeshFormat");
    }

    void GmshReader::end_section(const std::string &name)
    {
      std::string_view line;
      if (!scanner.next_line(line))
        scanner.fail("The file ends where $End" + name + " should stand.");
      if (line != "$End" + name)
        scanner.fail("\"" + std::string(line.substr(0, 40)) + "\" stands where $End" + name +
                     " should.");
    }

    void GmshReader::skip_section(const std::string &name)
    {
      const unsigned int begin = scanner.line_number();
      const std::string end = "$End" + name;
      std::string_view line;
      while (scanner.next_line(line))
        if (line == end)
          return;
      TextScanner::fail_at(begin, "The section $" + name + " does not end (" + end + ").");
    }

    unsigned int GmshReader::as_id(const long long tag) const
    {
      const unsigned long long size = static_cast<unsigned long long>(std::llabs(tag));
      if (size > 2000000000ull)
        scanner.fail("The number " + std::to_string(tag) +
                     " of a physical group is too large; at most 2000000000 is allowed.");
      return static_cast<unsigned int>(size);
    }

    std::string GmshReader::group_name(const unsigned int dimension,
                                       const unsigned int physical) const
    {
      const auto found = physical_names.find({dimension, physical});
      return found != physical_names.end() ? "\"" + found->second + "\"" : std::to_string(physical);
    }

    void GmshReader::read_physical_names()
    {
      const std::size_t n_names = scanner.count("the number of physical names");
      for (std::size_t i = 0; i < n_names; ++i)
      {
        const std::size_t dimension = scanner.count("the dimension of a physical group");
        if (dimension > 3)
          scanner.fail("The dimension of a physical group is at most 3.");
        const unsigned int tag = as_id(scanner.integer("the number of a physical group"));
        physical_names[{static_cast<unsigned int>(dimension), tag}] =
            scanner.quoted("the name of a physical group");
      }
      end_section("PhysicalNames");
    }

    void GmshReader::read_entities()
    {
      std::array<std::size_t, 4> n_entities;
      for (auto &n : n_entities)
        n = scanner.count("a number of entities");
      for (unsigned int dimension = 0; dimension < 4; ++dimension)
        for (std::size_t i = 0; i < n_entities[dimension]; ++i)
        {
          const long long tag = scanner.integer("the number of an entity");
          for (unsigned int d = 0; d < (dimension == 0 ? 3 : 6); ++d)
            scanner.real("a coordinate of an entity");
          auto &physicals = entity_physicals[{dimension, tag}];
          const std::size_t n_physicals = scanner.count("a number of physical groups");
          for (std::size_t k = 0; k < n_physicals; ++k)
            physicals.push_back(as_id(scanner.integer("the number of a physical group")));
          if (dimension > 0)
          {
            const std::size_t n_bounding = scanner.count("a number of bounding entities");
            for (std::size_t k = 0; k < n_bounding; ++k)
              scanner.integer("the number of a bounding entity");
          }
        }
      end_section("Entities");
    }

    void GmshReader::add_node(const long long tag)
    {
      const auto index = static_cast<unsigned int>(content.nodes.size());
      if (!index_of_node.emplace(tag, index).second)
        scanner.fail("There are two nodes of number " + std::to_string(tag) + ".");
      content.nodes.emplace_back();
    }

    void GmshReader::read_nodes()
    {
      has_nodes = true;
      const std::size_t n_blocks =
          is_version_4 ? scanner.count("the number of blocks of nodes") : 1;
      const std::size_t n_nodes = scanner.count("the number of nodes");
      if (is_version_4)
      {
        scanner.integer("the smallest number of a node");
        scanner.integer("the largest number of a node");
      }
      std::size_t n_read = 0;
      for (std::size_t block = 0; block < n_blocks; ++block)
      {
        std::size_t n_in_block = n_nodes;
        std::size_t n_parameters = 0;
        if (is_version_4)
        {
          const std::size_t dimension = scanner.count("the dimension of an entity");
          scanner.integer("the number of an entity");
          n_parameters = scanner.integer("0 or 1 (parametric)") != 0 ? dimension : 0;
          n_in_block = scanner.count("the number of nodes of a block");
          for (std::size_t i = 0; i < n_in_block; ++i)
            add_node(scanner.integer("the number of a node"));
        }
        for (std::size_t i = 0; i < n_in_block; ++i)
        {
          if (!is_version_4)
            add_node(scanner.integer("the number of a node"));
          for (double &coordinate : content.nodes[n_read])
            coordinate = scanner.real("a coordinate of a node");
          for (std::size_t k = 0; k < n_parameters; ++k)
            scanner.real("a parameter of a node");
          ++n_read;
        }
      }
      end_section("Nodes");
      if (n_read != n_nodes)
        scanner.fail("The section $Nodes announces " + std::to_string(n_nodes) + " nodes and has " +
                     std::to_string(n_read) + ".");
    }

    const ElementType &GmshReader::element_type(const long long number)
    {
      const auto found = element_types.find(number);
      if (found == element_types.end())
        scanner.fail("Elements of gmsh's type " + std::to_string(number) + " are not allowed." +
                     remedy);
      const ElementType &type = found->second;
      if (type.dimension > dim)
        scanner.fail(std::string("There are ") + type.name +
                     ", and the scene has two dimensions. "
                     "Allowed are quadrilaterals; or set Dimension = 3.");
      if (type.dimension == dim && !type.is_linear_cube)
        scanner.fail(std::string("There are ") + type.name + ". Allowed are " + cell_shape(dim) +
                     " only." + remedy);
      if (type.dimension + 1 == dim && !type.is_linear_cube)
        scanner.fail(std::string("There are ") + type.name +
                     " on a surface. Allowed are faces of " + cell_shape(dim) + " only." + remedy);
      return type;
    }

    unsigned int GmshReader::physical_of_entity(const unsigned int dimension, const long long tag)
    {
      const auto found = entity_physicals.find({dimension, tag});
      if (found == entity_physicals.end() || found->second.empty())
        return 0;
      const auto &physicals = found->second;
      if (physicals.size() > 1 && dimension + 1 >= dim)
        scanner.fail("The entity " + std::to_string(tag) + " of dimension " +
                     std::to_string(dimension) + " is in the physical groups " +
                     group_name(dimension, physicals[0]) + " and " +
                     group_name(dimension, physicals[1]) + ". It can be in one only.");
      return physicals[0];
    }

    void GmshReader::add_element(const ElementType &type, const unsigned int physical)
    {
      MeshFileElement element;
      element.line = scanner.line_number();
      element.id = physical;
      for (unsigned int k = 0; k < type.n_nodes; ++k)
      {
        const long long tag = scanner.integer("the number of a node");
        const auto found = index_of_node.find(tag);
        if (found == index_of_node.end())
          scanner.fail("There is no node of number " + std::to_string(tag) + ".");
        if (k < element.nodes.size())
          element.nodes[k] = found->second;
      }
      if (type.dimension == dim)
        content.cells.push_back(element);
      else if (type.dimension + 1 == dim)
        content.faces.push_back(element);
    }

    void GmshReader::read_elements()
    {
      if (!has_nodes)
        scanner.fail("The section $Elements stands before $Nodes.");
      has_elements = true;
      const std::size_t n_blocks =
          is_version_4 ? scanner.count("the number of blocks of elements") : 1;
      const std::size_t n_elements = scanner.count("the number of elements");
      if (is_version_4)
      {
        scanner.integer("the smallest number of an element");
        scanner.integer("the largest number of an element");
        std::size_t n_read = 0;
        for (std::size_t block = 0; block < n_blocks; ++block)
        {
          const std::size_t dimension = scanner.count("the dimension of an entity");
          const long long entity = scanner.integer("the number of an entity");
          const ElementType &type = element_type(scanner.integer("the type of the elements"));
          const unsigned int physical =
              physical_of_entity(static_cast<unsigned int>(dimension), entity);
          const std::size_t n_in_block = scanner.count("the number of elements of a block");
          for (std::size_t i = 0; i < n_in_block; ++i, ++n_read)
          {
            scanner.integer("the number of an element");
            add_element(type, physical);
          }
        }
        if (n_read != n_elements)
          scanner.fail("The section $Elements announces " + std::to_string(n_elements) +
                       " elements and has " + std::to_string(n_read) + ".");
      }
      else
        for (std::size_t i = 0; i < n_elements; ++i)
        {
          scanner.integer("the number of an element");
          const ElementType &type = element_type(scanner.integer("the type of an element"));
          const std::size_t n_tags = scanner.count("the number of tags");
          unsigned int physical = 0;
          for (std::size_t k = 0; k < n_tags; ++k)
          {
            const long long tag = scanner.integer("a tag");
            if (k == 0)
              physical = as_id(tag);
          }
          add_element(type, physical);
        }
      end_section("Elements");
    }
  } // namespace

  MeshFileContent read_gmsh(std::string_view text, const unsigned int dim)
  {
    return GmshReader(text, dim).read();
  }

  const char *cell_shape(const unsigned int dim)
  {
    return dim == 2 ? "quadrilaterals" : "hexahedra";
  }
} // namespace tombolo
