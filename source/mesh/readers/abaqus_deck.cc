// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/readers/abaqus_deck.h>
#include <tombolo/mesh/readers/mesh_file.h>

#include <algorithm>
#include <cctype>
#include <set>

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

    std::string without_quotes(std::string_view text)
    {
      if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
        text = trimmed(text.substr(1, text.size() - 2));
      return std::string(text);
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

      bool has(const std::string &option) const
      {
        known.insert(option);
        return options.count(option) > 0;
      }

      std::string get(const std::string &option) const
      {
        known.insert(option);
        const auto found = options.find(option);
        return found == options.end() ? "" : found->second;
      }

      /** Options that were asked for: others are left out. */
      mutable std::set<std::string> known;
    };

    Keyword parse_keyword(std::string_view line)
    {
      Keyword keyword;
      const auto fields = fields_of(line.substr(1));
      if (!fields.empty())
        keyword.name = abaqus_key(fields[0]);
      for (std::size_t i = 1; i < fields.size(); ++i)
      {
        const std::size_t equals = fields[i].find('=');
        const std::string option = abaqus_key(trimmed(fields[i].substr(0, equals)));
        keyword.options[option] =
            equals == fields[i].npos ? "" : without_quotes(trimmed(fields[i].substr(equals + 1)));
      }
      return keyword;
    }

    bool is_number(std::string_view field)
    {
      return !field.empty() && field.find_first_not_of("0123456789") == field.npos;
    }

    class AbaqusParser
    {
    public:
      AbaqusParser(const SourceFile &file, const unsigned int dim)
          : scanner(file), dim(dim), scope(&deck.outside)
      {}

      AbaqusDeck parse()
      {
        scanner.places().name_lines_of([this]() { parse_lines(); });
        deck.places = scanner.places();
        return std::move(deck);
      }

    private:
      void parse_lines();

      enum class Data
      {
        none,
        skipped,
        nodes,
        elements,
        node_set,
        element_set,
        surface,
        instance
      };

      void begin_section(const Keyword &keyword);
      /** Reads the file of the data of a keyword, if it names one, and notes options that are left
       * out. */
      void read_further(const Keyword &keyword);
      void leave_out(const std::string &what);
      /** Fails for keywords without which nodes or elements would be missing or elsewhere. */
      void refuse_hidden_mesh(const Keyword &keyword) const;
      /** Whether the keyword begins or ends a part, an instance or the assembly. */
      bool changes_scope(const Keyword &keyword);
      void begin_elements(const Keyword &keyword);
      void begin_surface(const Keyword &keyword);
      void check_type(const AbaqusElementType &type) const;
      void add_line(std::string_view line);
      void add_node(const std::vector<std::string_view> &fields);
      void add_element_fields(const std::vector<std::string_view> &fields);
      void finish_element();
      /** Whether elements of a type make neither cells nor faces; their nodes are not kept. */
      bool is_left_out(const AbaqusElementType &type) const;
      void keep_element(long long number, unsigned int line);
      void add_set_entries(const std::vector<std::string_view> &fields);
      void add_face(const std::vector<std::string_view> &fields);
      void add_placement(const std::vector<std::string_view> &fields);
      AbaqusSetEntry entry_of(std::string_view field) const;
      /** The name that an option gives; fails where it is missing. */
      std::string name_in(const Keyword &keyword, const std::string &option) const;
      /** The set of a name, a new one if there is none yet. */
      static AbaqusSet &set_of(std::vector<AbaqusSet> &sets, const std::string &name);

      TextScanner scanner;
      const unsigned int dim;
      AbaqusDeck deck;
      AbaqusScope *scope;
      Data data = Data::none;
      AbaqusSet *set = nullptr;       ///< that the data belong to, if any
      bool generates = false;         ///< whether the data of a set are ranges
      std::vector<long long> element; ///< number and nodes so far
      unsigned int element_line = 0;
      unsigned int n_lines_of_instance = 0;
    };

    void AbaqusParser::parse_lines()
    {
      std::string_view line;
      while (scanner.next_line(line))
      {
        if (line.compare(0, 2, "**") == 0)
          continue;
        if (line[0] != '*')
        {
          add_line(line);
          continue;
        }
        std::string text(line);
        while (text.back() == ',' && scanner.next_line(line))
          text += std::string(line);
        const Keyword keyword = parse_keyword(text);
        if (keyword.name == "INCLUDE")
        {
          scanner.include(name_in(keyword, "INPUT"));
          continue;
        }
        finish_element();
        begin_section(keyword);
      }
      finish_element();
    }

    std::string AbaqusParser::name_in(const Keyword &keyword, const std::string &option) const
    {
      const std::string name = keyword.get(option);
      if (name.empty())
        scanner.fail("*" + keyword.name + " has no " + option + ".");
      return name;
    }

    AbaqusSet &AbaqusParser::set_of(std::vector<AbaqusSet> &sets, const std::string &name)
    {
      const std::string key = abaqus_key(name);
      for (auto &other : sets)
        if (abaqus_key(other.name) == key)
          return other;
      sets.emplace_back();
      sets.back().name = name;
      return sets.back();
    }

    bool AbaqusParser::changes_scope(const Keyword &keyword)
    {
      const auto begin = [&](std::vector<AbaqusScope> &scopes)
      {
        if (scope != &deck.outside)
          scanner.fail("*" + keyword.name + " stands inside of \"" + scope->name +
                       "\", which does not end.");
        const std::string name = name_in(keyword, "NAME");
        for (const auto &other : scopes)
          if (abaqus_key(other.name) == abaqus_key(name))
            scanner.fail("There are two of *" + keyword.name + " called \"" + name + "\".");
        scopes.emplace_back();
        scope = &scopes.back();
        scope->name = name;
        scope->line = scanner.line_number();
      };
      data = Data::none;
      if (keyword.name == "PART")
        begin(deck.parts);
      else if (keyword.name == "INSTANCE")
      {
        begin(deck.instances);
        scope->part = keyword.get("PART");
        n_lines_of_instance = 0;
        data = Data::instance;
      }
      else if (keyword.name == "END PART" || keyword.name == "END INSTANCE")
        scope = &deck.outside;
      else if (keyword.name != "ASSEMBLY" && keyword.name != "END ASSEMBLY")
        return false;
      return true;
    }

    void AbaqusParser::refuse_hidden_mesh(const Keyword &keyword) const
    {
      static const std::set<std::string> generators = {"NGEN",  "NFILL",  "NCOPY", "NMAP",
                                                       "ELGEN", "ELCOPY", "SYSTEM"};
      if (generators.count(keyword.name) > 0)
        scanner.fail("*" + keyword.name +
                     " is not allowed: it makes or moves nodes or elements. Write the mesh with "
                     "*NODE and *ELEMENT alone, as Abaqus/CAE does.");
      const std::string system = abaqus_key(keyword.get("SYSTEM"));
      if (keyword.name == "NODE" && system != "" && system != "R")
        scanner.fail("*NODE with SYSTEM=" + system +
                     " is not allowed. Allowed are Cartesian coordinates (SYSTEM=R).");
    }

    void AbaqusParser::begin_section(const Keyword &keyword)
    {
      refuse_hidden_mesh(keyword);
      set = nullptr;
      if (changes_scope(keyword))
        return;
      generates = keyword.has("GENERATE");
      if (keyword.name == "NODE")
      {
        data = Data::nodes;
        if (!keyword.get("NSET").empty())
          set = &set_of(scope->node_sets, keyword.get("NSET"));
      }
      else if (keyword.name == "ELEMENT")
        begin_elements(keyword);
      else if (keyword.name == "NSET" || keyword.name == "ELSET")
      {
        const bool is_of_nodes = keyword.name == "NSET";
        data = is_of_nodes ? Data::node_set : Data::element_set;
        set = &set_of(is_of_nodes ? scope->node_sets : scope->element_sets,
                      name_in(keyword, keyword.name));
        set->is_internal = keyword.has("INTERNAL") || set->is_internal;
        set->instance = keyword.get("INSTANCE");
        if (is_of_nodes && !keyword.get("ELSET").empty())
          set->nodes_of_elements.push_back(entry_of(keyword.get("ELSET")));
      }
      else if (keyword.name == "SURFACE")
        begin_surface(keyword);
      else
      {
        data = Data::skipped;
        if (keyword.name != "HEADING" && keyword.name != "PREPRINT")
          leave_out(keyword.name);
        return;
      }
      read_further(keyword);
    }

    void AbaqusParser::read_further(const Keyword &keyword)
    {
      if (data == Data::skipped)
        return;
      const std::string input = keyword.get("INPUT");
      for (const auto &[option, value] : keyword.options)
        if (keyword.known.count(option) == 0 && option != "UNSORTED")
          leave_out(keyword.name + " with " + option);
      if (!input.empty())
        scanner.include(input);
    }

    void AbaqusParser::leave_out(const std::string &what)
    {
      ++deck.left_out.emplace(what, std::make_pair(0u, scanner.line_number())).first->second.first;
    }

    void AbaqusParser::begin_elements(const Keyword &keyword)
    {
      data = Data::elements;
      if (!keyword.has("TYPE"))
        scanner.fail("*ELEMENT has no TYPE.");
      const AbaqusElementType type = abaqus_element_type(abaqus_key(keyword.get("TYPE")));
      check_type(type);
      scope->elements.emplace_back();
      scope->elements.back().type = type;
      if (!keyword.get("ELSET").empty())
        set = &set_of(scope->element_sets, keyword.get("ELSET"));
      if (is_left_out(type))
        leave_out("ELEMENT, TYPE=" + type.name);
    }

    void AbaqusParser::check_type(const AbaqusElementType &type) const
    {
      const std::string begin = "Elements of type " + type.name + " are not allowed";
      const std::string allowed =
          dim == 3 ? " Allowed are hexahedra (C3D8, C3D8R, C3D20, ...) and faces of them (S4, ...)."
                   : " Allowed are quadrilaterals (CPS4, CPE4, S4, ...) and edges of them (T2D2, "
                     "B21).";
      if (type.n_nodes == 0)
        scanner.fail(begin + "." + allowed);
      if (type.dimension > dim)
        scanner.fail("There are hexahedra (" + type.name +
                     "), and the scene has two dimensions. Allowed are quadrilaterals; or set "
                     "Dimension = 3.");
      if (type.dimension + 1 >= dim && !type.is_cube && !type.is_rigid && type.dimension > 0)
        scanner.fail(begin + ": they are " + abaqus_shape_of(type) + "." + allowed +
                     shape_advice(dim));
    }

    void AbaqusParser::begin_surface(const Keyword &keyword)
    {
      const std::string type = abaqus_key(keyword.get("TYPE"));
      data = Data::skipped;
      if (type != "" && type != "ELEMENT" && type != "NODE")
      {
        leave_out("SURFACE, TYPE=" + type);
        return;
      }
      data = Data::surface;
      scope->surfaces.emplace_back();
      scope->surfaces.back().name = name_in(keyword, "NAME");
      scope->surfaces.back().is_of_nodes = type == "NODE";
    }

    void AbaqusParser::add_line(const std::string_view line)
    {
      const auto fields = fields_of(line);
      switch (data)
      {
      case Data::nodes:
        add_node(fields);
        break;
      case Data::elements:
        add_element_fields(fields);
        break;
      case Data::node_set:
      case Data::element_set:
        add_set_entries(fields);
        break;
      case Data::surface:
        add_face(fields);
        break;
      case Data::instance:
        add_placement(fields);
        break;
      case Data::skipped:
        break;
      default:
        scanner.fail("\"" + std::string(line.substr(0, 40)) +
                     "\" belongs to no keyword (*NODE, *ELEMENT, ...).");
      }
    }

    void AbaqusParser::add_node(const std::vector<std::string_view> &fields)
    {
      if (fields.size() < 3)
        scanner.fail("A node is a number and two or three coordinates, separated by commas.");
      const long long number = scanner.to_integer(fields[0], "the number of a node");
      if (!scope->index_of_node.emplace(number, static_cast<unsigned int>(scope->nodes.size()))
               .second)
        scanner.fail("There are two nodes of number " + std::to_string(number) + ".");
      std::array<double, 3> node = {};
      // Further fields are direction cosines.
      for (std::size_t d = 0; d < 3 && d + 1 < fields.size(); ++d)
        node[d] =
            fields[d + 1].empty() ? 0 : scanner.to_real(fields[d + 1], "a coordinate of a node");
      scope->nodes.push_back(node);
      if (set != nullptr)
      {
        AbaqusSetEntry entry;
        entry.line = scanner.line_number();
        entry.first = entry.last = number;
        set->entries.push_back(entry);
      }
    }

    void AbaqusParser::add_element_fields(const std::vector<std::string_view> &fields)
    {
      AbaqusElements &elements = scope->elements.back();
      const AbaqusElementType &type = elements.type;
      if (is_left_out(type))
      {
        // One line each; sets may name them.
        keep_element(scanner.to_integer(fields.empty() ? std::string_view() : fields[0],
                                        "the number of an element"),
                     scanner.line_number());
        return;
      }
      if (element.empty())
        element_line = scanner.line_number();
      for (const auto &field : fields)
        element.push_back(scanner.to_integer(field, element.empty() ? "the number of an element"
                                                                    : "the number of a node"));
      if (element.size() > type.n_nodes)
        finish_element();
    }

    void AbaqusParser::finish_element()
    {
      if (element.empty())
        return;
      AbaqusElements &elements = scope->elements.back();
      if (element.size() != elements.type.n_nodes + 1)
        TextScanner::fail_at(element_line, "An element of this type has " +
                                               std::to_string(elements.type.n_nodes) +
                                               " nodes, and this one has " +
                                               std::to_string(element.size() - 1) + ".");
      elements.nodes.insert(elements.nodes.end(), element.begin() + 1, element.end());
      keep_element(element[0], element_line);
      element.clear();
    }

    bool AbaqusParser::is_left_out(const AbaqusElementType &type) const
    {
      return type.dimension + 1 < dim || (type.is_rigid && !type.is_cube);
    }

    void AbaqusParser::keep_element(const long long number, const unsigned int line)
    {
      scope->elements.back().numbers.push_back(number);
      scope->elements.back().lines.push_back(line);
      if (set != nullptr)
      {
        AbaqusSetEntry entry;
        entry.line = line;
        entry.first = entry.last = number;
        set->entries.push_back(entry);
      }
    }

    AbaqusSetEntry AbaqusParser::entry_of(const std::string_view field) const
    {
      AbaqusSetEntry entry;
      entry.line = scanner.line_number();
      std::string name = without_quotes(field);
      const std::size_t dot = name.rfind('.');
      if (dot != name.npos)
      {
        entry.instance = name.substr(0, dot);
        name = name.substr(dot + 1);
      }
      if (is_number(name))
        entry.first = entry.last = scanner.to_integer(name, "a number of a set");
      else
        entry.name = name;
      return entry;
    }

    void AbaqusParser::add_set_entries(const std::vector<std::string_view> &fields)
    {
      if (!generates)
      {
        for (const auto &field : fields)
          if (!field.empty())
          {
            set->entries.push_back(entry_of(field));
            if (set->entries.back().instance.empty())
              set->entries.back().instance = set->instance;
          }
        return;
      }
      if (fields.size() < 2 || fields.size() > 3)
        scanner.fail("A line of GENERATE is a first and a last number and a step.");
      AbaqusSetEntry entry;
      entry.line = scanner.line_number();
      entry.instance = set->instance;
      entry.is_range = true;
      entry.first = scanner.to_integer(fields[0], "the first number");
      entry.last = scanner.to_integer(fields[1], "the last number");
      entry.step = fields.size() > 2 ? scanner.to_integer(fields[2], "the step") : 1;
      constexpr long long largest = 1000000000000;
      if (entry.step < 1 || entry.last < entry.first || entry.first < 0 || entry.last > largest ||
          entry.step > largest)
        scanner.fail("A range of GENERATE goes up, with a step of at least 1.");
      set->entries.push_back(entry);
    }

    void AbaqusParser::add_face(const std::vector<std::string_view> &fields)
    {
      AbaqusSurface &surface = scope->surfaces.back();
      if (fields.empty() || fields.size() > 2)
        scanner.fail("A line of *SURFACE is an element or a set of elements and the name of a "
                     "face.");
      surface.entries.push_back(entry_of(fields[0]));
      surface.faces.push_back(fields.size() > 1 && !surface.is_of_nodes ? abaqus_key(fields[1])
                                                                        : std::string());
    }

    void AbaqusParser::add_placement(const std::vector<std::string_view> &fields)
    {
      std::vector<double> numbers;
      for (const auto &field : fields)
        numbers.push_back(field.empty() ? 0 : scanner.to_real(field, "a number of *INSTANCE"));
      if (++n_lines_of_instance == 1 && numbers.size() <= 3)
        std::copy(numbers.begin(), numbers.end(), scope->translation.begin());
      else if (n_lines_of_instance == 2 && numbers.size() == 7)
      {
        std::copy_n(numbers.begin(), 3, scope->axis_begin.begin());
        std::copy_n(numbers.begin() + 3, 3, scope->axis_end.begin());
        scope->angle = numbers[6];
        if (scope->angle != 0 && scope->axis_begin == scope->axis_end)
          scanner.fail("The two points of the axis that the instance \"" + scope->name +
                       "\" is turned about are one point.");
      }
      else
        scanner.fail("Below *INSTANCE stand a line of three numbers (a translation) and perhaps a "
                     "line of seven (two points of an axis and an angle in degrees).");
    }
  } // namespace

  std::string abaqus_key(const std::string_view name)
  {
    std::string result(name);
    for (char &c : result)
      c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return result;
  }

  AbaqusDeck parse_abaqus(const SourceFile &file, const unsigned int dim)
  {
    return AbaqusParser(file, dim).parse();
  }
} // namespace tombolo
