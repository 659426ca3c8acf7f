// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/readers/abaqus_deck.h>
#include <tombolo/mesh/readers/mesh_file.h>
#include <tombolo/mesh/readers/midside_nodes.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

namespace tombolo
{
  namespace
  {
    /** Nodes of the faces S1, S2, ... of C3D8 and of four-node plane elements (Abaqus' manual,
     * "Three-dimensional solid element library" and "Plane element library"). */
    const std::vector<std::vector<unsigned int>> hexahedron_faces = {
        {0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
    const std::vector<std::vector<unsigned int>> quadrilateral_faces = {
        {0, 1}, {1, 2}, {2, 3}, {3, 0}};

    using Vector = std::array<double, 3>;

    /** Where an instance places a point of its part: moved, then turned (Rodrigues' formula). */
    Vector placed(const AbaqusScope &instance, Vector point)
    {
      for (unsigned int d = 0; d < 3; ++d)
        point[d] += instance.translation[d];
      if (instance.angle == 0)
        return point;
      Vector axis, arm;
      double length = 0;
      for (unsigned int d = 0; d < 3; ++d)
      {
        axis[d] = instance.axis_end[d] - instance.axis_begin[d];
        arm[d] = point[d] - instance.axis_begin[d];
        length += axis[d] * axis[d];
      }
      double along = 0;
      for (unsigned int d = 0; d < 3; ++d)
      {
        axis[d] /= std::sqrt(length);
        along += axis[d] * arm[d];
      }
      const double angle = instance.angle * std::acos(-1.) / 180;
      // The usual angles give exact coordinates.
      const auto exact = [](const double value)
      { return std::abs(value - std::round(value)) < 1e-15 ? std::round(value) : value; };
      const double sine = exact(std::sin(angle)), cosine = exact(std::cos(angle));
      for (unsigned int d = 0; d < 3; ++d)
      {
        const unsigned int e = (d + 1) % 3, f = (d + 2) % 3;
        point[d] = instance.axis_begin[d] + cosine * arm[d] +
                   sine * (axis[e] * arm[f] - axis[f] * arm[e]) + (1 - cosine) * along * axis[d];
      }
      return point;
    }

    class AbaqusMesh
    {
    public:
      AbaqusMesh(const SourceFile &file, const unsigned int dim)
          : deck(parse_abaqus(file, dim)), dim(dim)
      {
        content.places = deck.places;
      }

      MeshFileContent read()
      {
        deck.places.name_lines_of([this]() { make_content(); });
        return std::move(content);
      }

    private:
      void make_content();

      /** A part that an instance places, or what stands outside of the parts. */
      struct Body
      {
        std::string name; ///< of the instance, empty outside
        const AbaqusScope *mesh;
        const AbaqusScope *placement;
        unsigned int first_node = 0;
        std::unordered_map<long long, unsigned int> elements; ///< indices of all elements
      };

      /** The sets that a set is looked up for, the outermost first. */
      using Path = std::vector<const AbaqusSet *>;

      enum class Kind
      {
        cell,
        face,
        left_out
      };

      struct Element
      {
        Kind kind;
        unsigned int index; ///< in content.cells or in faces
      };

      void make_bodies();
      void add_body(const std::string &name, const AbaqusScope &mesh, const AbaqusScope &placement);
      void add_elements(Body &body);
      void name_sets();
      void name_sets_of(const Body &body, const std::string &prefix);
      void name_short_sets();
      void name_parts_and_instances();
      void remark_what_is_left_out();

      /** The nodes or elements of a set, of those of the names of @p body. */
      std::vector<unsigned int> members_of(const Body &body, const AbaqusSet &set, bool is_of_nodes,
                                           const Path &outer = {}) const;
      /** Adds those of one entry. @p of_what is for messages. */
      void add_members(const Body &body, const AbaqusSetEntry &entry, const std::string &of_what,
                       bool is_of_nodes, const Path &path,
                       std::vector<unsigned int> &members) const;
      const Body &body_of_instance(const std::string &name, unsigned int line) const;

      void add_element_set(const std::string &name, const std::vector<unsigned int> &elements);
      void add_surface(const std::string &name, const Body &body, const AbaqusSurface &surface);
      void add_face_of_cell(unsigned int id, unsigned int cell, const std::string &face,
                            unsigned int line);
      unsigned int boundary_id(const std::string &name);

      AbaqusDeck deck;
      const unsigned int dim;
      MeshFileContent content;
      std::vector<Body> bodies; ///< the first is what stands outside of parts
      std::vector<Element> elements;
      std::vector<MeshFileElement> faces;
      std::set<unsigned int> faces_in_sets;
      MidsideNodes midside_nodes;
      /** What ranges name that does not exist, by line. */
      mutable std::map<unsigned int, std::string> gaps;
    };

    void AbaqusMesh::make_content()
    {
      make_bodies();
      if (content.nodes.empty())
        throw MeshFileError("There is no section *NODE.");
      name_sets();
      remark_what_is_left_out();
    }

    void AbaqusMesh::make_bodies()
    {
      bodies.reserve(1 + std::max(deck.instances.size(), deck.parts.size()));
      add_body("", deck.outside, deck.outside);
      std::set<std::string> placed_parts;
      for (const auto &instance : deck.instances)
      {
        const AbaqusScope *mesh = &instance;
        if (instance.nodes.empty())
        {
          const std::string key = abaqus_key(instance.part);
          const auto part = std::find_if(deck.parts.begin(), deck.parts.end(),
                                         [&](const auto &p) { return abaqus_key(p.name) == key; });
          if (part == deck.parts.end())
            TextScanner::fail_at(instance.line, "The instance \"" + instance.name +
                                                    "\" is of the part \"" + instance.part +
                                                    "\", and there is no such part.");
          mesh = &*part;
          placed_parts.insert(key);
        }
        add_body(instance.name, *mesh, instance);
      }
      for (const auto &part : deck.parts)
        if (deck.instances.empty())
          add_body(part.name, part, part);
        else if (placed_parts.count(abaqus_key(part.name)) == 0)
          content.remarks.push_back("The part \"" + part.name +
                                    "\" of the mesh file has no instance: it is left out.");
      if (deck.instances.empty() && !deck.parts.empty())
        content.remarks.push_back("The mesh file has no *INSTANCE: its parts stay where they are.");
    }

    void AbaqusMesh::add_body(const std::string &name, const AbaqusScope &mesh,
                              const AbaqusScope &placement)
    {
      bodies.push_back(
          {name, &mesh, &placement, static_cast<unsigned int>(content.nodes.size()), {}});
      for (const auto &node : mesh.nodes)
        content.nodes.push_back(placed(placement, node));
      add_elements(bodies.back());
      if (placement.angle != 0)
      {
        std::ostringstream text;
        const auto write = [&](const Vector &v)
        { text << '(' << v[0] << ", " << v[1] << ", " << v[2] << ')'; };
        text << "The instance \"" << name << "\" of the mesh file is moved by ";
        write(placement.translation);
        text << " and then turned by " << placement.angle << " degrees about the axis from ";
        write(placement.axis_begin);
        text << " to ";
        write(placement.axis_end);
        content.remarks.push_back(text.str() + ", as " + deck.places.name(placement.line) +
                                  " and those after it say.");
      }
    }

    void AbaqusMesh::add_elements(Body &body)
    {
      for (const auto &block : body.mesh->elements)
      {
        const unsigned int n_nodes = block.nodes.empty() ? 0 : block.type.n_nodes;
        const unsigned int n_corners = 1u << block.type.dimension;
        for (std::size_t e = 0; e < block.numbers.size(); ++e)
        {
          const unsigned int line = block.lines[e];
          if (!body.elements.emplace(block.numbers[e], static_cast<unsigned int>(elements.size()))
                   .second)
            TextScanner::fail_at(line, "There are two elements of number " +
                                           std::to_string(block.numbers[e]) + ".");
          if (n_nodes == 0)
          {
            elements.push_back({Kind::left_out, 0});
            continue;
          }
          std::array<unsigned int, 27> nodes = {};
          for (unsigned int k = 0; k < n_nodes; ++k)
          {
            const auto found = body.mesh->index_of_node.find(block.nodes[e * n_nodes + k]);
            if (found == body.mesh->index_of_node.end())
              TextScanner::fail_at(line, "There is no node of number " +
                                             std::to_string(block.nodes[e * n_nodes + k]) + ".");
            nodes[k] = body.first_node + found->second;
          }
          MeshFileElement element;
          element.line = line;
          std::copy_n(nodes.begin(), n_corners, element.nodes.begin());
          const bool is_cell = block.type.dimension == dim;
          auto &list = is_cell ? content.cells : faces;
          elements.push_back(
              {is_cell ? Kind::cell : Kind::face, static_cast<unsigned int>(list.size())});
          list.push_back(element);
          if (is_cell && n_nodes > n_corners)
            midside_nodes.add([&](const unsigned int k) { return content.nodes[nodes[k]]; },
                              dim == 3 ? hexahedron_midsides : quadrilateral_midsides, n_corners,
                              line);
        }
      }
    }

    const AbaqusMesh::Body &AbaqusMesh::body_of_instance(const std::string &name,
                                                         const unsigned int line) const
    {
      std::string list;
      for (std::size_t b = 1; b < bodies.size(); ++b)
      {
        if (abaqus_key(bodies[b].name) == abaqus_key(name))
          return bodies[b];
        list += (list.empty() ? "\"" : ", \"") + bodies[b].name + "\"";
      }
      TextScanner::fail_at(line, "There is no instance \"" + name + "\"." +
                                     (list.empty() ? "" : " Instances are " + list + "."));
    }

    std::vector<unsigned int> AbaqusMesh::members_of(const Body &body, const AbaqusSet &set,
                                                     const bool is_of_nodes,
                                                     const Path &outer) const
    {
      std::vector<unsigned int> members;
      const std::string of_what = "the set \"" + set.name + "\"";
      Path path = outer;
      path.push_back(&set);
      // A set that is named twice is looked up once, or nested sets would take exponential time.
      std::set<std::string> names;
      for (const auto &entry : set.entries)
        if (entry.name.empty() ||
            names.insert(abaqus_key(entry.instance + "." + entry.name)).second)
          add_members(body, entry, of_what, is_of_nodes, path, members);
      std::vector<unsigned int> with_nodes;
      for (const auto &entry : set.nodes_of_elements)
        add_members(body, entry, of_what, false, path, with_nodes);
      for (const unsigned int e : with_nodes)
        if (elements[e].kind != Kind::left_out)
        {
          const bool is_cell = elements[e].kind == Kind::cell;
          const auto &element = (is_cell ? content.cells : faces)[elements[e].index];
          members.insert(members.end(), element.nodes.begin(),
                         element.nodes.begin() + (1u << (is_cell ? dim : dim - 1)));
        }
      std::sort(members.begin(), members.end());
      members.erase(std::unique(members.begin(), members.end()), members.end());
      return members;
    }

    void AbaqusMesh::add_members(const Body &body, const AbaqusSetEntry &entry,
                                 const std::string &of_what, const bool is_of_nodes,
                                 const Path &path, std::vector<unsigned int> &members) const
    {
      const std::string what = is_of_nodes ? "node" : "element";
      const Body &place =
          entry.instance.empty() ? body : body_of_instance(entry.instance, entry.line);
      if (!entry.name.empty())
      {
        const auto &sets = is_of_nodes ? place.mesh->node_sets : place.mesh->element_sets;
        const auto found = std::find_if(sets.begin(), sets.end(),
                                        [&](const AbaqusSet &set)
                                        { return abaqus_key(set.name) == abaqus_key(entry.name); });
        if (found == sets.end())
          TextScanner::fail_at(entry.line, "There is no set of " + what + "s \"" + entry.name +
                                               "\", which " + of_what + " names.");
        if (std::find(path.begin(), path.end(), &*found) != path.end())
          TextScanner::fail_at(entry.line, "The set \"" + entry.name + "\" contains itself.");
        const auto inner = members_of(place, *found, is_of_nodes, path);
        members.insert(members.end(), inner.begin(), inner.end());
        return;
      }
      const auto &known = is_of_nodes ? place.mesh->index_of_node : place.elements;
      const unsigned int first = is_of_nodes ? place.first_node : 0;
      const long long n_named = (entry.last - entry.first) / entry.step + 1;
      const std::size_t n_before = members.size();
      // Of a range what exists is taken.
      if (n_named > static_cast<long long>(known.size()))
      {
        for (const auto &[number, index] : known)
          if (number >= entry.first && number <= entry.last &&
              (number - entry.first) % entry.step == 0)
            members.push_back(first + index);
      }
      else
        for (long long number = entry.first; number <= entry.last; number += entry.step)
        {
          const auto found = known.find(number);
          if (found != known.end())
            members.push_back(first + found->second);
        }
      const long long n_missing = n_named - static_cast<long long>(members.size() - n_before);
      if (n_missing > 0 && !entry.is_range)
        TextScanner::fail_at(entry.line, "There is no " + what + " of number " +
                                             std::to_string(entry.first) + ", which " + of_what +
                                             " names.");
      if (n_missing > 0)
        gaps[entry.line] = std::to_string(n_missing) + " of " + std::to_string(n_named) + " " +
                           what + "s of " + of_what + " (" + deck.places.name(entry.line) + ")";
    }

    unsigned int AbaqusMesh::boundary_id(const std::string &name)
    {
      return content.boundary_names
          .emplace(name, static_cast<unsigned int>(content.boundary_names.size()) + 1)
          .first->second;
    }

    void AbaqusMesh::add_element_set(const std::string &name,
                                     const std::vector<unsigned int> &members)
    {
      MeshFileSet cells;
      cells.name = name;
      for (const unsigned int e : members)
        if (elements[e].kind == Kind::cell)
          cells.members.push_back(elements[e].index);
        else if (elements[e].kind == Kind::face)
        {
          faces_in_sets.insert(elements[e].index);
          content.faces.push_back(faces[elements[e].index]);
          content.faces.back().id = boundary_id(name);
          content.surfaces_off_the_body.insert(content.faces.back().id);
        }
      if (!cells.members.empty())
        content.cell_sets.push_back(std::move(cells));
    }

    void AbaqusMesh::add_face_of_cell(const unsigned int id, const unsigned int cell,
                                      const std::string &face, const unsigned int line)
    {
      const auto &places = dim == 3 ? hexahedron_faces : quadrilateral_faces;
      const bool is_named = face.size() == 2 && (face[0] == 'S' || face[0] == 'E') &&
                            face[1] >= '1' && face[1] < static_cast<char>('1' + places.size());
      if (!is_named && !face.empty())
        TextScanner::fail_at(line, "The face of an element is called \"" + face +
                                       "\". Allowed are S1 to S" + std::to_string(places.size()) +
                                       ".");
      for (std::size_t f = 0; f < places.size(); ++f)
        if (face.empty() || face[1] == static_cast<char>('1' + f))
        {
          MeshFileElement element;
          element.line = line;
          element.id = id;
          for (std::size_t k = 0; k < places[f].size(); ++k)
            element.nodes[k] = content.cells[cell].nodes[places[f][k]];
          content.faces.push_back(element);
        }
    }

    void AbaqusMesh::add_surface(const std::string &name, const Body &body,
                                 const AbaqusSurface &surface)
    {
      const std::string of_what = "the surface \"" + surface.name + "\"";
      if (surface.is_of_nodes)
      {
        MeshFileSet nodes;
        nodes.name = name;
        for (const auto &entry : surface.entries)
          add_members(body, entry, of_what, true, {}, nodes.members);
        content.node_sets.push_back(std::move(nodes));
        return;
      }
      const unsigned int id = boundary_id(name);
      for (std::size_t i = 0; i < surface.entries.size(); ++i)
      {
        std::vector<unsigned int> members;
        add_members(body, surface.entries[i], of_what, false, {}, members);
        for (const unsigned int e : members)
          if (elements[e].kind == Kind::cell)
            add_face_of_cell(id, elements[e].index, surface.faces[i], surface.entries[i].line);
          else if (elements[e].kind == Kind::face)
          {
            faces_in_sets.insert(elements[e].index);
            content.surfaces_off_the_body.insert(id);
            content.faces.push_back(faces[elements[e].index]);
            content.faces.back().id = id;
          }
      }
    }

    void AbaqusMesh::name_sets_of(const Body &body, const std::string &prefix)
    {
      for (const auto &set : body.mesh->element_sets)
        if (!set.is_internal)
          add_element_set(prefix + set.name, members_of(body, set, false));
      for (const auto &surface : body.mesh->surfaces)
        add_surface(prefix + surface.name, body, surface);
      for (const auto &set : body.mesh->node_sets)
        if (!set.is_internal)
          content.node_sets.push_back({prefix + set.name, members_of(body, set, true)});
    }

    void AbaqusMesh::name_short_sets()
    {
      // Names of parts stand for the sets of all instances, where they mean one thing.
      std::map<std::string, std::set<const AbaqusScope *>> scopes_of_name;
      const auto for_all_names = [](const AbaqusScope &scope, const auto &action)
      {
        for (const auto *sets : {&scope.element_sets, &scope.node_sets})
          for (const auto &set : *sets)
            if (!set.is_internal)
              action(set.name);
        for (const auto &surface : scope.surfaces)
          action(surface.name);
      };
      for (const auto &body : bodies)
        for_all_names(*body.mesh, [&](const std::string &name)
                      { scopes_of_name[abaqus_key(name)].insert(body.mesh); });
      std::string ambiguous;
      const auto is_short = [&](const std::string &name)
      { return scopes_of_name[abaqus_key(name)].size() == 1; };
      for (std::size_t b = 1; b < bodies.size(); ++b)
      {
        const Body &body = bodies[b];
        for (const auto &set : body.mesh->element_sets)
          if (!set.is_internal && is_short(set.name))
            add_element_set(set.name, members_of(body, set, false));
        for (const auto &surface : body.mesh->surfaces)
          if (is_short(surface.name))
            add_surface(surface.name, body, surface);
        for (const auto &set : body.mesh->node_sets)
          if (!set.is_internal && is_short(set.name))
            content.node_sets.push_back({set.name, members_of(body, set, true)});
      }
      std::set<std::string> reported;
      for (std::size_t b = 1; b < bodies.size(); ++b)
        for_all_names(*bodies[b].mesh,
                      [&](const std::string &name)
                      {
                        if (!is_short(name) && reported.insert(abaqus_key(name)).second)
                          ambiguous += (ambiguous.empty() ? "\"" : ", \"") + name + "\"";
                      });
      if (!ambiguous.empty())
        content.remarks.push_back("Several parts of the mesh file, or a part and the assembly, "
                                  "have sets called " +
                                  ambiguous +
                                  ". The sets of parts are called with their instances, as in \"" +
                                  bodies[1].name + ".NAME\".");
    }

    void AbaqusMesh::name_parts_and_instances()
    {
      std::set<std::string> known;
      for (const auto &set : content.cell_sets)
        known.insert(set.name);
      const auto add = [&](const Body &body, const std::string &name)
      {
        MeshFileSet set;
        set.name = name;
        for (const auto &[number, e] : body.elements)
          if (elements[e].kind == Kind::cell)
            set.members.push_back(elements[e].index);
        std::sort(set.members.begin(), set.members.end());
        if (known.count(name) == 0 && !set.members.empty())
          content.cell_sets.push_back(std::move(set));
      };
      for (std::size_t b = 1; b < bodies.size(); ++b)
      {
        if (bodies[b].mesh != bodies[b].placement)
          add(bodies[b], bodies[b].mesh->name);
        add(bodies[b], bodies[b].name);
      }
    }

    void AbaqusMesh::name_sets()
    {
      // Names that stand outside come last only where parts have names too.
      name_short_sets();
      name_sets_of(bodies[0], "");
      for (std::size_t b = 1; b < bodies.size(); ++b)
        name_sets_of(bodies[b], bodies[b].name + ".");
      name_parts_and_instances();
    }

    void AbaqusMesh::remark_what_is_left_out()
    {
      std::vector<bool> is_in_set(content.cells.size(), false);
      for (const auto &set : content.cell_sets)
        for (const unsigned int cell : set.members)
          is_in_set[cell] = true;
      if (!content.cell_sets.empty() &&
          std::find(is_in_set.begin(), is_in_set.end(), false) != is_in_set.end())
        content.remarks.push_back("Some cells are in no ELSET; they are of material 0.");
      if (faces_in_sets.size() < faces.size())
        content.remarks.push_back(std::to_string(faces.size() - faces_in_sets.size()) +
                                  " face elements of the mesh file (S4, CPS4, ...) are in no set: "
                                  "they name no boundary.");
      midside_nodes.report(content.places, content.remarks);
      std::string missing;
      for (const auto &gap : gaps)
        missing += (missing.empty() ? "" : ", ") + gap.second;
      if (!missing.empty())
        content.remarks.push_back(
            "Ranges of the mesh file (GENERATE) name what does not exist, and "
            "what exists is taken. Missing are " +
            missing + ".");
      if (deck.left_out.empty())
        return;
      std::string list;
      for (const auto &[keyword, place] : deck.left_out)
        list += (list.empty() ? "*" : ", *") + keyword + " (" + std::to_string(place.first) +
                (place.first == 1 ? " time, " : " times, first on ") +
                deck.places.name(place.second) + ")";
      content.remarks.push_back("What the mesh file says besides the mesh is left out: " + list +
                                ".");
    }
  } // namespace

  MeshFileContent read_abaqus(const SourceFile &file, const unsigned int dim)
  {
    return AbaqusMesh(file, dim).read();
  }
} // namespace tombolo
