// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/readers/keyword_sets.h>
#include <tombolo/mesh/readers/midside_nodes.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <unordered_map>
#include <utility>

namespace tombolo
{
  namespace
  {
    bool is_blank(const std::string_view text)
    {
      return text.find_first_not_of(" \t") == text.npos;
    }

    std::string title_of(const std::string_view card)
    {
      if (is_blank(card))
        return {};
      const std::size_t begin = card.find_first_not_of(" \t");
      return std::string(card.substr(begin, card.find_last_not_of(" \t") + 1 - begin));
    }

    bool ends_with(const std::string &text, const std::string &end)
    {
      return text.size() >= end.size() &&
             text.compare(text.size() - end.size(), end.size(), end) == 0;
    }

    bool begins_with(const std::string &text, const std::string &begin)
    {
      return text.compare(0, begin.size(), begin) == 0;
    }

    class KeywordReader
    {
    public:
      KeywordReader(const SourceFile &file, const unsigned int dim)
          : scanner(file), dim(dim), sets(scanner, dim)
      {}

      MeshFileContent read()
      {
        scanner.places().name_lines_of([this]() { make_content(); });
        content.places = scanner.places();
        return std::move(content);
      }

    private:
      void make_content();
      void read_lines();

      enum class Data
      {
        skipped,
        nodes,
        elements,
        part,
        set,
        include
      };

      /** How wide the fields of a file are. */
      struct Format
      {
        bool is_long = false; ///< fields of 20 columns
        bool has_wide_integers = false;
      };

      /** Columns of the fields in the section. */
      struct Widths
      {
        std::size_t integer = 8; ///< of nodes and elements
        std::size_t real = 16;
        std::size_t set = 10; ///< of sets and parts
      };

      struct PartHead
      {
        std::string title;
        bool has_title = false;
        bool is_only_one = false; ///< whether the section has one part, and further cards about it
        bool has_contact = false; ///< whether a card about contact follows
        bool skips_card = false;
      };

      void begin_section(std::string_view line);
      void begin_elements(const std::string &options);
      void skip(const std::string &keyword);

      void add_card(std::string_view card);
      void add_node(std::string_view card);
      void add_element_card(std::string_view card);
      void finish_element();
      /** Fails for tetrahedra, wedges and pyramids, which are hexahedra with equal nodes. */
      void check_shape() const;
      void add_part_card(std::string_view card);
      void include(std::string_view card);
      /** Puts a node of second order between its corners. */
      void add_midside_nodes();
      /** Boundaries of the nodes that TC holds along an axis. */
      void name_held_nodes();

      std::vector<std::string_view>
      fields(std::string_view card, const std::vector<std::size_t> &widths, std::size_t n_fields)
      {
        return keyword_fields(scanner, card, widths, n_fields, expanded);
      }
      std::vector<long long> integers(std::string_view card, std::size_t width, const char *what);
      /** Keeps a shell of a scene in three dimensions: a face, if it is no triangle. */
      void add_shell(const std::vector<unsigned int> &nodes);
      void name_parts();
      void name_shells();
      void remark_left_out();

      TextScanner scanner;
      const unsigned int dim;
      MeshFileContent content;
      KeywordNumbers known;
      /** Faces whose ids are those of their parts. */
      std::vector<MeshFileElement> shells;
      KeywordSets sets;
      std::map<std::string, std::pair<unsigned int, unsigned int>> left_out;
      KeywordNames groups, boundaries;
      MidsideNodes midside_nodes;
      /** Nodes of cells of second order, each with its line. */
      std::vector<std::pair<unsigned int, std::vector<unsigned int>>> cells_of_second_order;
      std::array<std::vector<unsigned int>, 3> held; ///< nodes that TC holds along each axis
      unsigned int first_held_line = 0;

      Data data = Data::skipped;
      std::vector<Format> formats = {{}}; ///< of the file, and of those that include it before
      std::string expanded;               ///< a card without its tabs
      std::string included;               ///< the name of a file so far
      Widths widths;
      unsigned int n_nodes_of_element = 8;
      std::vector<long long> element; ///< its number, part and nodes so far
      unsigned int element_line = 0;
      PartHead part_head;
    };

    void KeywordReader::read_lines()
    {
      std::string_view line;
      bool has_keyword = false;
      while (scanner.raw_line(line))
      {
        // A file has the format of that which includes it, unless its *KEYWORD says more.
        formats.resize(scanner.depth() + 1, formats.back());
        if (line.empty() || line[0] == '$')
          continue;
        if (line[0] == '*')
        {
          finish_element();
          has_keyword = true;
          begin_section(line);
        }
        else if (has_keyword)
          add_card(line);
        else if (!is_blank(line))
          scanner.fail("\"" + std::string(line.substr(0, 40)) +
                       "\" stands before the first keyword (*KEYWORD, *NODE, ...).");
      }
      finish_element();
    }

    void KeywordReader::make_content()
    {
      read_lines();
      if (content.nodes.empty() || known.awaited_nodes.size() == content.nodes.size())
        throw MeshFileError("There is no section *NODE.");
      if (!known.awaited_nodes.empty())
      {
        const auto first =
            std::min_element(known.awaited_nodes.begin(), known.awaited_nodes.end(),
                             [](const auto &a, const auto &b) { return a.second < b.second; });
        TextScanner::fail_at(first->second,
                             "There is no node of number " + std::to_string(first->first) + ".");
      }
      add_midside_nodes();
      sets.resolve(known, groups, boundaries, content);
      name_held_nodes();
      name_parts();
      name_shells();
      remark_left_out();
    }

    void KeywordReader::skip(const std::string &keyword)
    {
      data = Data::skipped;
      ++left_out.emplace(keyword, std::make_pair(0u, scanner.line_number())).first->second.first;
    }

    void KeywordReader::begin_section(const std::string_view line)
    {
      std::string text = title_of(line.substr(1));
      std::transform(text.begin(), text.end(), text.begin(),
                     [](const unsigned char c) { return static_cast<char>(std::toupper(c)); });
      std::string keyword = text.substr(0, text.find_first_of(" \t"));
      // A plus sign asks for wide fields in one section, a minus sign for the usual ones.
      const bool has_plus = ends_with(text, "+"), has_minus = ends_with(text, "-");
      while (ends_with(keyword, "+") || ends_with(keyword, "-") || ends_with(keyword, "%"))
        keyword.pop_back();
      const bool is_wide = (formats.back().is_long || has_plus) && !has_minus;
      widths.integer = is_wide ? 20 : formats.back().has_wide_integers ? 10 : 8;
      widths.real = is_wide ? 20 : 16;
      widths.set = is_wide ? 20 : 10;

      if (begins_with(keyword, "INCLUDE_") && !begins_with(keyword, "INCLUDE_PATH"))
        scanner.fail("*" + keyword +
                     " is not allowed: the mesh could be in the file that it names. Write all into "
                     "one file, name the file by *INCLUDE, or make the lines comments ($) if that "
                     "file has nothing of the mesh.");
      if (begins_with(keyword, "NODE_TRANSFORM") || begins_with(keyword, "ELEMENT_GENERATE") ||
          begins_with(keyword, "ELEMENT_SOLID_NURBS"))
        scanner.fail("*" + keyword +
                     " is not allowed: it makes or moves nodes or elements. Write the mesh with "
                     "*NODE and *ELEMENT_SOLID alone.");
      if (keyword == "END")
      {
        scanner.end_file();
        data = Data::skipped;
      }
      else if (keyword == "INCLUDE")
        data = Data::include;
      else if (keyword == "KEYWORD")
      {
        formats.back().is_long = text.find("LONG=Y") != text.npos;
        formats.back().has_wide_integers = text.find("I10=Y") != text.npos;
        data = Data::skipped;
      }
      else if (keyword == "NODE")
        data = Data::nodes;
      else if (begins_with(keyword, "ELEMENT_SOLID"))
        begin_elements(keyword.substr(13));
      else if (keyword == "ELEMENT_SHELL")
      {
        data = Data::elements;
        n_nodes_of_element = 4;
      }
      else if (keyword == "PART" || begins_with(keyword, "PART_CONTACT") ||
               begins_with(keyword, "PART_INERTIA"))
      {
        data = Data::part;
        part_head.has_title = false;
        part_head.has_contact = keyword == "PART_CONTACT";
        part_head.is_only_one = keyword != "PART" && !part_head.has_contact;
        part_head.skips_card = false;
      }
      else if (sets.begin(keyword))
        data = Data::set;
      else if (keyword == "TITLE")
        data = Data::skipped;
      else
        skip(keyword);
    }

    void KeywordReader::begin_elements(const std::string &options)
    {
      if (dim == 2)
        scanner.fail("There are solid elements, and the scene has two dimensions. Allowed are "
                     "quadrilaterals (*ELEMENT_SHELL); or set Dimension = 3.");
      data = Data::elements;
      n_nodes_of_element = options == "_H20" ? 20 : options == "_H27" ? 27 : 8;
      if (begins_with(options, "_T") || begins_with(options, "_P"))
        scanner.fail("*ELEMENT_SOLID" + options +
                     " has elements that are no hexahedra. Allowed are *ELEMENT_SOLID, "
                     "*ELEMENT_SOLID_H20 and *ELEMENT_SOLID_H27." +
                     shape_advice(dim));
      if (n_nodes_of_element == 8 && !options.empty())
        scanner.fail("*ELEMENT_SOLID" + options +
                     " is not allowed. Allowed are *ELEMENT_SOLID, *ELEMENT_SOLID_H20 and "
                     "*ELEMENT_SOLID_H27.");
    }

    void KeywordReader::add_card(const std::string_view card)
    {
      if (data == Data::skipped)
        return;
      // A title may be blank.
      const bool is_title =
          (data == Data::part && !part_head.has_title) || (data == Data::set && sets.is_at_title());
      if (is_blank(card) && !is_title)
        return;
      switch (data)
      {
      case Data::nodes:
        add_node(card);
        break;
      case Data::elements:
        add_element_card(card);
        break;
      case Data::part:
        add_part_card(card);
        break;
      case Data::include:
        include(card);
        break;
      default:
        sets.add_card(card, widths.set);
      }
    }

    std::vector<long long> KeywordReader::integers(const std::string_view card,
                                                   const std::size_t width, const char *what)
    {
      std::vector<long long> numbers;
      for (const auto &field : fields(card, {width}, 10))
        numbers.push_back(field.empty() ? 0 : scanner.to_integer(field, what));
      return numbers;
    }

    void KeywordReader::include(const std::string_view card)
    {
      // A plus sign at the end continues the name.
      const std::string line = title_of(card);
      const bool continues = ends_with(line, " +");
      included += continues ? title_of(line.substr(0, line.size() - 2)) : line;
      if (!continues)
        scanner.include(std::exchange(included, ""));
    }

    void KeywordReader::add_node(const std::string_view card)
    {
      const auto node_fields =
          fields(card, {widths.integer, widths.real, widths.real, widths.real, widths.integer}, 6);
      if (node_fields.empty())
        return;
      const long long number = scanner.to_integer(node_fields[0], "the number of a node");
      const unsigned int index = known.node_so_far(number, 0);
      if (known.awaited_nodes.erase(number) == 0)
        scanner.fail("There are two nodes of number " + std::to_string(number) + ".");
      content.nodes.resize(known.index_of_node.size());
      for (std::size_t d = 0; d < 3 && d + 1 < node_fields.size(); ++d)
        if (!node_fields[d + 1].empty())
          content.nodes[index][d] = scanner.to_real(node_fields[d + 1], "a coordinate of a node");
      if (node_fields.size() < 5 || node_fields[4].empty())
        return;
      // x, y, z, xy, yz, zx, xyz
      constexpr std::array<unsigned int, 8> axes_of_code = {{0, 1, 2, 4, 3, 6, 5, 7}};
      const double code = scanner.to_real(node_fields[4], "the constraint (TC) of a node");
      if (code < 0 || code > 7)
        scanner.fail("TC of a node is a number from 0 to 7.");
      for (std::size_t d = 0; d < 3; ++d)
        if ((axes_of_code[static_cast<std::size_t>(code)] >> d & 1u) != 0)
        {
          held[d].push_back(index);
          first_held_line = first_held_line == 0 ? scanner.line_number() : first_held_line;
        }
    }

    void KeywordReader::name_held_nodes()
    {
      std::string list;
      for (std::size_t d = 0; d < dim; ++d)
        if (!held[d].empty())
        {
          const std::string axis(1, static_cast<char>('x' + d));
          const std::string name = boundaries.usable("", "held along " + axis, content.remarks);
          list += (list.empty() ? "\"" : ", \"") + name + "\" (" + std::to_string(held[d].size()) +
                  " nodes)";
          std::sort(held[d].begin(), held[d].end());
          content.node_sets.push_back({name, std::move(held[d])});
        }
      if (!list.empty())
        content.remarks.push_back(
            "TC of *NODE (first on " + scanner.places().name(first_held_line) +
            ") holds nodes. They are the boundaries " + list + ", for conditions of the scene.");
    }

    void KeywordReader::add_midside_nodes()
    {
      for (const auto &[line, nodes] : cells_of_second_order)
        midside_nodes.add([&nodes = nodes, this](const unsigned int k)
                          { return content.nodes[nodes[k]]; },
                          hexahedron_midsides, 8, line);
    }

    void KeywordReader::add_element_card(const std::string_view card)
    {
      const auto numbers = integers(card, widths.integer, "a number of an element");
      if (element.empty())
        element_line = scanner.line_number();
      // In the form of two cards the first one has the element and its part only.
      const bool is_head = element.empty() && numbers.size() <= 2;
      element.insert(element.end(), numbers.begin(), numbers.end());
      if (!is_head && element.size() >= 2 + n_nodes_of_element)
        finish_element();
      else if (!is_head && element.size() >= 2 + std::min(4u, n_nodes_of_element) &&
               n_nodes_of_element <= 8)
        finish_element();
    }

    void KeywordReader::check_shape() const
    {
      const std::set<long long> distinct(element.begin() + 2,
                                         element.begin() + 2 + (n_nodes_of_element == 4 ? 4 : 8));
      if (n_nodes_of_element == 4)
      {
        if (distinct.size() == 3)
          TextScanner::fail_at(element_line,
                               "An element is a triangle (two of its nodes are equal). Allowed "
                               "are quadrilaterals only." +
                                   shape_advice(dim));
        return;
      }
      const char *shape = distinct.size() == 4   ? "tetrahedron"
                          : distinct.size() == 5 ? "pyramid"
                          : distinct.size() == 6 ? "wedge"
                                                 : nullptr;
      if (shape != nullptr)
        TextScanner::fail_at(element_line, std::string("An element is a ") + shape + " (it has " +
                                               std::to_string(distinct.size()) +
                                               " different nodes). Allowed are hexahedra only." +
                                               shape_advice(dim));
    }

    void KeywordReader::finish_element()
    {
      if (element.empty())
        return;
      const std::size_t n_corners = n_nodes_of_element == 4 ? 4 : 8;
      const auto n_given = static_cast<std::size_t>(std::count_if(
          element.begin() +
              std::min<std::ptrdiff_t>(2, static_cast<std::ptrdiff_t>(element.size())),
          element.end(), [](const long long n) { return n != 0; }));
      if (n_given == 4 && n_corners == 8)
        TextScanner::fail_at(element_line, "An element is a tetrahedron of 4 nodes. Allowed are "
                                           "hexahedra only." +
                                               shape_advice(dim));
      if (element.size() < 2 + n_nodes_of_element || n_given < n_nodes_of_element)
        TextScanner::fail_at(element_line,
                             "An element of this kind has " + std::to_string(n_nodes_of_element) +
                                 " nodes, and this one has " + std::to_string(n_given) + ".");
      if (n_nodes_of_element == 8 && n_given > 8)
        TextScanner::fail_at(element_line, "An element is a tetrahedron of 10 nodes. Allowed are "
                                           "hexahedra only." +
                                               shape_advice(dim));
      if (element[1] < 1 || element[1] > 2000000000)
        TextScanner::fail_at(element_line, "The number " + std::to_string(element[1]) +
                                               " of a part is outside 1 to 2000000000.");
      std::vector<unsigned int> nodes;
      for (std::size_t k = 0; k < n_nodes_of_element; ++k)
        nodes.push_back(known.node_so_far(element[2 + k], element_line));
      content.nodes.resize(known.index_of_node.size());
      if (n_corners == 4 && dim == 3)
      {
        add_shell(nodes);
        return;
      }
      check_shape();
      MeshFileElement cell;
      cell.line = element_line;
      cell.id = static_cast<unsigned int>(element[1]);
      std::copy_n(nodes.begin(), n_corners, cell.nodes.begin());
      if (!known.cell_of_element
               .emplace(element[0], static_cast<unsigned int>(content.cells.size()))
               .second)
        TextScanner::fail_at(element_line, "There are two elements of number " +
                                               std::to_string(element[0]) + ".");
      content.cells.push_back(cell);
      known.part_titles.emplace(element[1], "");
      if (n_nodes_of_element > 8)
        cells_of_second_order.emplace_back(element_line, nodes);
      element.clear();
    }

    void KeywordReader::add_shell(const std::vector<unsigned int> &nodes)
    {
      if (nodes[2] == nodes[3])
        ++left_out.emplace("ELEMENT_SHELL of three nodes", std::make_pair(0u, element_line))
              .first->second.first;
      else
      {
        MeshFileElement face;
        face.line = element_line;
        face.id = static_cast<unsigned int>(element[1]);
        std::copy(nodes.begin(), nodes.end(), face.nodes.begin());
        shells.push_back(face);
      }
      element.clear();
    }

    void KeywordReader::name_shells()
    {
      std::map<unsigned int, unsigned int> boundary_of_part;
      for (const auto &shell : shells)
      {
        auto &id = boundary_of_part[shell.id];
        if (id == 0)
        {
          id = static_cast<unsigned int>(content.boundary_names.size()) + 1;
          const auto title = known.part_titles.find(shell.id);
          content.boundary_names.emplace(
              boundaries.usable(title == known.part_titles.end() ? "" : title->second,
                                "part " + std::to_string(shell.id), content.remarks),
              id);
          content.surfaces_off_the_body.insert(id);
        }
        content.faces.push_back(shell);
        content.faces.back().id = id;
      }
    }

    void KeywordReader::add_part_card(const std::string_view card)
    {
      if (std::exchange(part_head.skips_card, false))
        return;
      if (!part_head.has_title)
      {
        part_head.title = title_of(card);
        part_head.has_title = true;
        return;
      }
      const auto numbers = fields(card, {widths.set}, 8);
      const long long part = scanner.to_integer(numbers.empty() ? std::string_view() : numbers[0],
                                                "the number of a part");
      if (!known.part_titles.emplace(part, part_head.title).second)
        known.part_titles[part] = part_head.title;
      part_head.has_title = false;
      part_head.skips_card = part_head.has_contact;
      if (part_head.is_only_one)
        data = Data::skipped;
    }

    void KeywordReader::name_parts()
    {
      std::set<unsigned int> in_use;
      for (const auto &cell : content.cells)
        in_use.insert(cell.id);
      for (const auto &[part, title] : known.part_titles)
      {
        const auto id = static_cast<unsigned int>(part);
        if (in_use.count(id) == 0)
        {
          if (std::none_of(shells.begin(), shells.end(),
                           [id](const MeshFileElement &shell) { return shell.id == id; }))
            content.remarks.push_back("The part " + std::to_string(part) + " \"" + title +
                                      "\" of the mesh file has no cells: it is left out.");
          continue;
        }
        const std::string number = "part " + std::to_string(part);
        content.group_names.emplace(groups.usable(title, number, content.remarks), id);
        content.group_names.emplace(number, id);
      }
    }

    void KeywordReader::remark_left_out()
    {
      midside_nodes.report(scanner.places(), content.remarks);
      if (left_out.empty())
        return;
      std::string list;
      for (const auto &[keyword, place] : left_out)
        list += (list.empty() ? "*" : ", *") + keyword + " (" + std::to_string(place.first) +
                (place.first == 1 ? " time, " : " times, first on ") +
                scanner.places().name(place.second) + ")";
      content.remarks.push_back("What the mesh file says besides the mesh is left out: " + list +
                                ". scripts/import_keyword writes a parameter file of it, as far "
                                "as it can.");
    }
  } // namespace

  MeshFileContent read_keyword(const SourceFile &file, const unsigned int dim)
  {
    return KeywordReader(file, dim).read();
  }
} // namespace tombolo
