// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/readers/gmsh_scanner.h>
#include <tombolo/mesh/readers/mesh_file.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
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
      /** Corners if it is a point, line, quadrilateral or hexahedron of degree one or two; zero for
       * others. The corners are the first nodes. */
      unsigned int n_corners;
    };

    /** gmsh's numbers of element types, from its manual, section "MSH file format". */
    const std::map<long long, ElementType> element_types = {
        {15, {"points", 0, 1, 1}},
        {1, {"lines", 1, 2, 2}},
        {8, {"lines of 3 nodes", 1, 3, 2}},
        {26, {"lines of 4 nodes", 1, 4, 0}},
        {2, {"triangles", 2, 3, 0}},
        {3, {"quadrilaterals", 2, 4, 4}},
        {9, {"triangles of 6 nodes", 2, 6, 0}},
        {10, {"quadrilaterals of 9 nodes", 2, 9, 4}},
        {16, {"quadrilaterals of 8 nodes", 2, 8, 4}},
        {4, {"tetrahedra", 3, 4, 0}},
        {5, {"hexahedra", 3, 8, 8}},
        {6, {"prisms", 3, 6, 0}},
        {7, {"pyramids", 3, 5, 0}},
        {11, {"tetrahedra of 10 nodes", 3, 10, 0}},
        {12, {"hexahedra of 27 nodes", 3, 27, 8}},
        {17, {"hexahedra of 20 nodes", 3, 20, 8}},
        {18, {"prisms of 15 nodes", 3, 15, 0}},
        {13, {"prisms of 18 nodes", 3, 18, 0}},
        {14, {"pyramids of 14 nodes", 3, 14, 0}},
        {19, {"pyramids of 13 nodes", 3, 13, 0}}};

    /** The two corners between which a midside node lies. */
    using MidsideEdge = std::array<unsigned int, 2>;

    /** Corners of the midside nodes of quadrilaterals of 8 or 9 nodes, in all formats. */
    const std::vector<MidsideEdge> quadrilateral_midsides = {
        {{0, 1}}, {{1, 2}}, {{2, 3}}, {{3, 0}}};

    /** Edges of the midside nodes of gmsh's hexahedra of second order. */
    const std::vector<MidsideEdge> gmsh_hexahedron_midsides = {
        {{0, 1}}, {{0, 3}}, {{0, 4}}, {{1, 2}}, {{1, 5}}, {{2, 3}},
        {{2, 6}}, {{3, 7}}, {{4, 5}}, {{4, 7}}, {{5, 6}}, {{6, 7}}};

    class GmshReader
    {
    public:
      GmshReader(std::string_view text, const unsigned int dim) : scanner(text), dim(dim) {}

      MeshFileContent read()
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

        name_physical_groups();
        remark_midside_nodes();
        for (const auto &section : sections_left_out)
          content.remarks.push_back("The section " + section + " of the mesh file is left out.");
        return std::move(content);
      }

    private:
      void read_format()
      {
        std::string_view line;
        if (!scanner.next_line(line) || line != "$MeshFormat")
          scanner.fail("A file of gmsh begins with $MeshFormat. Allowed are versions 2.2 and 4.1.");
        const std::string version(scanner.word("the version of the format"));
        if (version != "2.2" && version != "4.1")
          scanner.fail("This is version " + version.substr(0, 40) +
                       " of gmsh's format. Allowed are 2.2 and 4.1: save it anew with \"gmsh -save "
                       "FILE -format msh41 -o NEW.msh\".");
        is_version_4 = version == "4.1";
        const long long kind = scanner.integer("the kind of file, 0 for text and 1 for binary");
        if (kind != 0 && kind != 1)
          scanner.fail("\"" + std::to_string(kind) +
                       "\" stands where the kind of file should. Allowed are 0 (text) and 1 "
                       "(binary).");
        const long long size = scanner.integer("the size of a number");
        if (kind == 1)
        {
          if (size != 8)
            scanner.fail("Numbers of " + std::to_string(size) +
                         " bytes are not allowed. Allowed in a binary file are 8.");
          content.unit = "element";
          scanner.begin_binary(is_version_4);
          scanner.begin_numbers();
          if (scanner.small_integer("the number 1, in binary") != 1)
            scanner.fail("The number 1 does not stand here: the file is damaged, or written by a "
                         "machine with another order of bytes. Save it anew as text with \"gmsh "
                         "-save FILE -o NEW.msh\".");
        }
        end_section("MeshFormat");
      }

      void read_physical_names()
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

      void read_entities()
      {
        if (has_elements)
          scanner.fail("The section $Entities stands after $Elements, whose groups it has.");
        scanner.begin_numbers();
        std::array<std::size_t, 4> n_entities;
        for (auto &n : n_entities)
          n = scanner.large_count("a number of entities");
        for (unsigned int dimension = 0; dimension < 4; ++dimension)
          for (std::size_t i = 0; i < n_entities[dimension]; ++i)
          {
            const long long tag = scanner.small_integer("the number of an entity");
            for (unsigned int d = 0; d < (dimension == 0 ? 3 : 6); ++d)
              scanner.number("a coordinate of an entity");
            auto &physicals = entity_physicals[{dimension, tag}];
            const std::size_t n_physicals = scanner.large_count("a number of physical groups");
            for (std::size_t k = 0; k < n_physicals; ++k)
              physicals.push_back(as_id(scanner.small_integer("the number of a physical group")));
            if (dimension > 0)
            {
              const std::size_t n_bounding = scanner.large_count("a number of bounding entities");
              for (std::size_t k = 0; k < n_bounding; ++k)
                scanner.small_integer("the number of a bounding entity");
            }
          }
        end_section("Entities");
      }

      void read_nodes()
      {
        has_nodes = true;
        std::size_t n_blocks = 1;
        std::size_t n_nodes = 0;
        if (is_version_4)
        {
          scanner.begin_numbers();
          n_blocks = scanner.large_count("the number of blocks of nodes");
          n_nodes = scanner.large_count("the number of nodes");
          scanner.large_integer("the smallest number of a node");
          scanner.large_integer("the largest number of a node");
        }
        else
        {
          n_nodes = scanner.count("the number of nodes");
          scanner.begin_numbers();
        }
        std::size_t n_read = 0;
        for (std::size_t block = 0; block < n_blocks; ++block)
        {
          std::size_t n_in_block = n_nodes;
          std::size_t n_parameters = 0;
          if (is_version_4)
          {
            const std::size_t dimension = scanner.small_count("the dimension of an entity");
            scanner.small_integer("the number of an entity");
            n_parameters = scanner.small_integer("0 or 1 (parametric)") != 0 ? dimension : 0;
            n_in_block = scanner.large_count("the number of nodes of a block");
            for (std::size_t i = 0; i < n_in_block; ++i)
              add_node(scanner.large_integer("the number of a node"));
          }
          for (std::size_t i = 0; i < n_in_block; ++i)
          {
            if (!is_version_4)
              add_node(scanner.small_integer("the number of a node"));
            for (double &coordinate : content.nodes[n_read])
              coordinate = scanner.number("a coordinate of a node");
            for (std::size_t k = 0; k < n_parameters; ++k)
              scanner.number("a parameter of a node");
            ++n_read;
          }
        }
        end_section("Nodes");
        if (n_read != n_nodes)
          scanner.fail("The section $Nodes announces " + std::to_string(n_nodes) +
                       " nodes and has " + std::to_string(n_read) + ".");
      }

      void read_elements()
      {
        if (!has_nodes)
          scanner.fail("The section $Elements stands before $Nodes.");
        has_elements = true;
        if (is_version_4)
        {
          scanner.begin_numbers();
          const std::size_t n_blocks = scanner.large_count("the number of blocks of elements");
          read_blocks_of_elements(n_blocks, scanner.large_count("the number of elements"));
        }
        else
        {
          const std::size_t n_elements = scanner.count("the number of elements");
          scanner.begin_numbers();
          read_elements_of_version_2(n_elements);
          join_repeated_cells();
        }
        end_section("Elements");
      }

      void skip_section(const std::string &name)
      {
        const unsigned int begin = scanner.line_number();
        const std::string end = "$End" + name;
        std::string_view line;
        while (scanner.next_line(line))
          if (line == end)
            return;
        TextScanner::fail_at(begin, "The section $" + name + " does not end (" + end + ").");
      }

      void end_section(const std::string &name)
      {
        std::string_view line;
        if (!scanner.next_line(line))
          scanner.fail("The file ends where $End" + name + " should stand.");
        if (line != "$End" + name)
          scanner.fail("\"" + std::string(line.substr(0, 40)) + "\" stands where $End" + name +
                       " should.");
      }

      void add_node(const long long tag)
      {
        const auto index = static_cast<unsigned int>(content.nodes.size());
        if (!index_of_node.emplace(tag, index).second)
          scanner.fail("There are two nodes of number " + std::to_string(tag) + ".");
        content.nodes.emplace_back();
        content.node_numbers.push_back(tag);
      }

      void read_blocks_of_elements(const std::size_t n_blocks, const std::size_t n_elements)
      {
        scanner.large_integer("the smallest number of an element");
        scanner.large_integer("the largest number of an element");
        std::size_t n_read = 0;
        for (std::size_t block = 0; block < n_blocks; ++block)
        {
          const std::size_t dimension = scanner.small_count("the dimension of an entity");
          const long long entity = scanner.small_integer("the number of an entity");
          const ElementType &type = element_type(scanner.small_integer("the type of the elements"));
          const auto &physicals = physicals_of_entity(static_cast<unsigned int>(dimension), entity);
          const std::size_t n_in_block = scanner.large_count("the number of elements of a block");
          for (std::size_t i = 0; i < n_in_block; ++i, ++n_read)
          {
            const long long number = scanner.large_integer("the number of an element");
            add_element(type, number, physicals);
          }
        }
        if (n_read != n_elements)
          scanner.fail("The section $Elements announces " + std::to_string(n_elements) +
                       " elements and has " + std::to_string(n_read) + ".");
      }

      void read_elements_of_version_2(const std::size_t n_elements)
      {
        // The binary form has blocks of elements of one type, each with a heading.
        std::size_t n_read = 0;
        while (n_read < n_elements)
        {
          long long number = 0;
          if (!scanner.is_binary())
            number = scanner.integer("the number of an element");
          const ElementType &type = element_type(scanner.small_integer("the type of an element"));
          const std::size_t n_in_block =
              scanner.is_binary() ? scanner.small_count("the number of elements of a block") : 1;
          const std::size_t n_tags = scanner.small_count("the number of tags");
          for (std::size_t i = 0; i < n_in_block; ++i, ++n_read)
          {
            if (scanner.is_binary())
              number = scanner.small_integer("the number of an element");
            std::vector<unsigned int> physicals;
            for (std::size_t k = 0; k < n_tags; ++k)
            {
              const long long tag = scanner.small_integer("a tag");
              if (k == 0)
                physicals.push_back(as_id(tag));
            }
            add_element(type, number, physicals);
          }
          if (n_in_block == 0)
            scanner.fail("A block of elements is empty.");
        }
      }

      /** Version 2.2 repeats cells that are in several physical groups. */
      void join_repeated_cells()
      {
        std::vector<std::pair<std::array<unsigned int, 8>, unsigned int>> order;
        for (const auto &cell : content.cells)
        {
          order.emplace_back(cell.nodes, static_cast<unsigned int>(order.size()));
          std::sort(order.back().first.begin(), order.back().first.end());
        }
        std::sort(order.begin(), order.end());
        // Of each cell the first that has its nodes. The same one in the same group stays, and is
        // refused.
        std::vector<unsigned int> first(order.size());
        std::set<unsigned int> groups;
        for (std::size_t i = 0; i < order.size(); ++i)
        {
          const unsigned int cell = order[i].second;
          const bool is_repeated = i > 0 && order[i].first == order[i - 1].first;
          if (!is_repeated)
            groups.clear();
          const bool is_in_another = groups.insert(content.cells[cell].id).second;
          first[cell] = is_repeated && is_in_another ? first[order[i - 1].second] : cell;
        }
        std::vector<MeshFileElement> cells;
        std::vector<unsigned int> new_index(first.size());
        for (std::size_t c = 0; c < first.size(); ++c)
          if (first[c] == c)
          {
            new_index[c] = static_cast<unsigned int>(cells.size());
            cells.push_back(content.cells[c]);
          }
          else
            further_physicals[content.cells[c].id].push_back(new_index[first[c]]);
        content.cells = std::move(cells);
      }

      /** Reads the nodes of an element of the type and keeps it if its dimension matters. */
      void add_element(const ElementType &type, const long long number,
                       const std::vector<unsigned int> &physicals)
      {
        MeshFileElement element;
        element.line =
            scanner.is_binary() ? static_cast<unsigned int>(number) : scanner.line_number();
        std::array<unsigned int, 27> nodes = {};
        for (unsigned int k = 0; k < type.n_nodes; ++k)
        {
          const long long tag = scanner.large_integer("the number of a node");
          const auto found = index_of_node.find(tag);
          if (found == index_of_node.end())
            scanner.fail("There is no node of number " + std::to_string(tag) + ".");
          nodes[k] = found->second;
        }
        std::copy_n(nodes.begin(), std::min<std::size_t>(type.n_corners, 8), element.nodes.begin());
        if (!physicals.empty())
          element.id = physicals[0];
        if (type.dimension == dim)
        {
          for (std::size_t k = 1; k < physicals.size(); ++k)
            further_physicals[physicals[k]].push_back(
                static_cast<unsigned int>(content.cells.size()));
          content.cells.push_back(element);
          if (type.n_nodes > type.n_corners)
            measure_midside_nodes(nodes, type.n_corners, element.line);
        }
        else if (type.dimension == 0)
          for (const unsigned int physical : physicals)
            physical_points[physical].push_back(nodes[0]);
        else if (type.dimension + 1 == dim)
        {
          content.faces.push_back(element);
          for (std::size_t k = 1; k < physicals.size(); ++k)
          {
            content.faces.push_back(element);
            content.faces.back().id = physicals[k];
          }
        }
      }

      /** Of a cell with these nodes, its corners first. */
      void measure_midside_nodes(const std::array<unsigned int, 27> &nodes,
                                 const unsigned int n_corners, const unsigned int line)
      {
        ++n_of_second_order;
        const auto &edges = dim == 3 ? gmsh_hexahedron_midsides : quadrilateral_midsides;
        for (unsigned int k = 0; k < edges.size(); ++k)
        {
          const std::array<double, 3> &begin = content.nodes[nodes[edges[k][0]]],
                                      &end = content.nodes[nodes[edges[k][1]]],
                                      &middle = content.nodes[nodes[n_corners + k]];
          double distance = 0, length = 0;
          for (unsigned int d = 0; d < 3; ++d)
          {
            distance += std::pow(middle[d] - (begin[d] + end[d]) / 2, 2);
            length += std::pow(end[d] - begin[d], 2);
          }
          const double bend = length > 0 ? std::sqrt(distance / length) : 0;
          if (bend > largest_bend)
          {
            largest_bend = bend;
            line_of_largest = line;
          }
        }
      }

      void remark_midside_nodes()
      {
        if (n_of_second_order == 0)
          return;
        std::ostringstream text;
        text << n_of_second_order
             << " cells of the mesh file are of second order. Their midside nodes are left "
             << "out: cells here have straight edges between their corners. ";
        // Round-off of written coordinates is no bend.
        if (largest_bend > 1e-6)
        {
          text.precision(3);
          text << "A midside node lies off the middle of its edge by up to " << largest_bend
               << " of the length of the edge (" << content.location(line_of_largest)
               << "); smaller cells follow curved surfaces better.";
        }
        else
          text << "All of them are in the middle of their edges, so that the shape is the same.";
        content.remarks.push_back(text.str());
      }

      const ElementType &element_type(const long long number)
      {
        const auto found = element_types.find(number);
        if (found == element_types.end())
          scanner.fail("Elements of gmsh's type " + std::to_string(number) + " are not allowed." +
                       shape_advice(dim));
        const ElementType &type = found->second;
        if (type.dimension > dim)
          scanner.fail(std::string("There are ") + type.name +
                       ", and the scene has two dimensions. "
                       "Allowed are quadrilaterals; or set Dimension = 3.");
        if (type.dimension == dim && type.n_corners == 0)
          scanner.fail(std::string("There are ") + type.name + ". Allowed are " + cell_shape(dim) +
                       " only." + shape_advice(dim));
        if (type.dimension + 1 == dim && type.n_corners == 0)
          scanner.fail(std::string("There are ") + type.name +
                       " on a surface. Allowed are faces of " + cell_shape(dim) + " only." +
                       shape_advice(dim));
        return type;
      }

      const std::vector<unsigned int> &physicals_of_entity(const unsigned int dimension,
                                                           const long long tag) const
      {
        static const std::vector<unsigned int> nothing;
        const auto found = entity_physicals.find({dimension, tag});
        return found == entity_physicals.end() ? nothing : found->second;
      }

      unsigned int as_id(const long long tag) const
      {
        const unsigned long long size = static_cast<unsigned long long>(std::llabs(tag));
        if (size > 2000000000ull)
          scanner.fail("The number " + std::to_string(tag) +
                       " of a physical group is too large; at most 2000000000 is allowed.");
        return static_cast<unsigned int>(size);
      }

      /** Names of groups and boundaries, and remarks. */
      void name_physical_groups()
      {
        std::set<unsigned int> boundaries_in_use;
        for (const auto &face : content.faces)
          boundaries_in_use.insert(face.id);
        for (const auto &[key, name] : physical_names)
        {
          auto &names = key.first == dim ? content.group_names : content.boundary_names;
          if (key.first == 0 && physical_points.count(key.second) > 0)
            content.node_sets.push_back({name, physical_points[key.second]});
          else if (key.first + 1 < dim || key.first > dim)
            content.remarks.push_back("The physical group \"" + name + "\" of dimension " +
                                      std::to_string(key.first) +
                                      " is left out: it is not of cells, of faces or of nodes.");
          else if (!names.emplace(name, key.second).second)
            throw MeshFileError("Two physical groups of dimension " + std::to_string(key.first) +
                                " are called \"" + name + "\".");
        }
        for (const unsigned int boundary : boundaries_in_use)
          if (boundary != 0 && physical_names.count({dim - 1, boundary}) == 0)
            content.boundary_names.emplace(std::to_string(boundary), boundary);
        for (auto &[physical, cells] : further_physicals)
          content.cell_sets.push_back({group_name(physical), std::move(cells)});
      }

      std::string group_name(const unsigned int physical) const
      {
        const auto found = physical_names.find({dim, physical});
        return found != physical_names.end() ? found->second : std::to_string(physical);
      }

      GmshScanner scanner;
      const unsigned int dim;
      bool is_version_4 = false;
      MeshFileContent content;
      std::unordered_map<long long, unsigned int> index_of_node;
      std::map<std::pair<unsigned int, unsigned int>, std::string> physical_names;
      std::map<std::pair<unsigned int, long long>, std::vector<unsigned int>> entity_physicals;
      std::set<std::string> sections_left_out;
      /** Cells of the further physical groups of entities that are in several. */
      std::map<unsigned int, std::vector<unsigned int>> further_physicals;
      /** Nodes by the physical groups of points. */
      std::map<unsigned int, std::vector<unsigned int>> physical_points;
      std::size_t n_of_second_order = 0; ///< cells, of which only the corners are used
      double largest_bend = 0; ///< distance from the middle of an edge by the length of the edge
      unsigned int line_of_largest = 0;
      bool has_nodes = false;
      bool has_elements = false;
    };
  } // namespace

  MeshFileContent read_gmsh(const std::string_view text, const unsigned int dim)
  {
    return GmshReader(text, dim).read();
  }

  const char *cell_shape(const unsigned int dim)
  {
    return dim == 2 ? "quadrilaterals" : "hexahedra";
  }

  std::string shape_advice(const unsigned int dim)
  {
    if (dim == 2)
      return " In gmsh, set Mesh.RecombineAll = 1 and Mesh.SubdivisionAlgorithm = 1 and mesh anew: "
             "the triangles that are left are divided into quadrilaterals.";
    return " In gmsh, set Mesh.SubdivisionAlgorithm = 2 and mesh anew: tetrahedra, prisms and "
           "pyramids are divided into hexahedra. A mesh that is there is divided by a file x.geo "
           "with \"Merge "
           "'OLD.msh'; Mesh.SubdivisionAlgorithm = 2; RefineMesh; Save 'NEW.msh';\" and \"gmsh - "
           "x.geo\".";
  }
} // namespace tombolo
