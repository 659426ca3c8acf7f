// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/probes.h>

#include <tombolo/base/format.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/boundary/region.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/mesh/boundary_names.h>
#include <tombolo/mesh/joined_meshes.h>
#include <tombolo/output/output.h>
#include <tombolo/output/symmetric_tensors.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace tombolo
{
  namespace
  {
    /** A place that an output is asked for, and what its columns are called. */
    template <int dim>
    struct NamedPlace
    {
      std::string name;
      Point<dim> location;
    };

    template <int dim>
    NamedPlace<dim> read_place(const std::string &text, const Section &section,
                               const std::string &entry, const std::string &name)
    {
      const std::size_t colon = text.rfind(':');
      NamedPlace<dim> result{
          colon == std::string::npos ? name : Utilities::trim(text.substr(0, colon)), {}};
      if (result.name.empty())
        section.fail(entry, "\"" + text + "\" has no name before the colon");
      const std::vector<std::string> numbers = Utilities::split_string_list(
          colon == std::string::npos ? text : text.substr(colon + 1), ',');
      if (numbers.size() != dim)
        section.fail(entry, "\"" + text + "\" has " + std::to_string(numbers.size()) +
                                " coordinates; " + std::to_string(dim) +
                                " are needed, separated by commas");
      for (unsigned int d = 0; d < dim; ++d)
      {
        try
        {
          result.location[d] = Utilities::string_to_double(numbers[d]);
        }
        catch (const ExceptionBase &)
        {
          result.location[d] = std::numeric_limits<double>::quiet_NaN();
        }
        if (!std::isfinite(result.location[d]))
          section.fail(entry, "\"" + numbers[d] + "\" in \"" + text + "\" is not a number");
      }
      return result;
    }

    /** The places of an entry, a list, separated by semicolons, of `name: x, y, z`; one without a
     * name is called @p word and its number in the list. Throws InputError. */
    template <int dim>
    std::vector<NamedPlace<dim>> read_named_places(const Section &section, const std::string &entry,
                                                   const std::string &word)
    {
      std::vector<NamedPlace<dim>> result;
      for (const std::string &text : Utilities::split_string_list(section.get(entry), ';'))
      {
        const auto place =
            read_place<dim>(text, section, entry, word + " " + std::to_string(result.size() + 1));
        if (std::any_of(result.begin(), result.end(),
                        [&](const NamedPlace<dim> &other) { return other.name == place.name; }))
          section.fail(entry, "two " + word + "s are called \"" + place.name + "\"");
        result.push_back(place);
      }
      return result;
    }

    const char *const probes_file = "probes.csv";

    const OutputOfScene of_probes(
        1, "probes", "its own Locations, Nodes, Mesh nodes, Where and Boundary",
        [](const Section &output)
        {
          const Section probes = output.subsection("probes");
          for (const char *const entry : {"Locations", "Nodes", "Mesh nodes", "Where", "Boundary"})
            if (probes.is_set(entry))
              return true;
          return false;
        });

    template <int dim>
    std::string text_of(const Point<dim> &point)
    {
      std::string result;
      for (unsigned int d = 0; d < dim; ++d)
        result += (d == 0 ? "(" : ", ") + format_number(point[d]);
      return result + ")";
    }
  } // namespace

  template <int dim>
  Probes<dim>::Probes(const Entries &e) : History<dim>(e, probes_file, {"Steps", "1", "Interval"})
  {
    this->records.value("places of nodes", places).optional();
    this->records.value("numbers of nodes", chosen).optional();
    this->records.value("choice of nodes", choice).optional();
    e.text(
        "Locations", "", "L",
        "Nodes whose motion is written to probes.csv, by initial coordinates, to which the nearest "
        "node is taken: a list, separated by semicolons, of `name: x, y, z`, or without a name.");
    if (!e.declares())
      for (const NamedPlace<dim> &place : read_named_places<dim>(e.section(), "Locations", "probe"))
        add({place.name, place.location, {}});
    n_locations = probes.size();
    const std::string of_nodes =
        e.text("Nodes", "", "",
               "Further nodes by number, separated by commas: the `persistent id` of particles in "
               "pictures, by which messages name nodes, too.");
    numbers = read_numbers("Nodes", of_nodes);
    const std::string of_mesh = e.text(
        "Mesh nodes", "", "",
        "Further nodes by their number in the mesh file, separated by commas: the tag of a node of "
        "gmsh, which is the number of the deck where scripts/import has made the file, or the "
        "index of a point of VTK, counted from 0. Corners of cells have one, also where the cells "
        "are refined.");
    mesh_numbers = read_numbers("Mesh nodes", of_mesh);
    where = e.optional<Predicate<dim>>("Where", "",
                                       "All nodes at whose initial position this holds, such as "
                                       "`x < 1e-9`, with `Boundary` those of them on it.");
    boundary =
        e.text("Boundary", "", "",
               "All nodes on these boundaries, names separated by commas, with `Where` those "
               "of them where it holds.");
    wanted_choice =
        of_nodes + "|" + e.given("Where") + "|" + boundary + (of_mesh.empty() ? "" : "|" + of_mesh);
    const bool has_choice = !numbers.empty() || !mesh_numbers.empty() || where || !boundary.empty();
    if (!has_choice)
      choice = wanted_choice;
    e.refuse(probes.empty() && !has_choice, "Locations",
             "give at least one location, for example `tip: 10, 0, 0`");
  }

  template <int dim>
  void Probes<dim>::add(const Probe &probe)
  {
    for (const Probe &other : probes)
      if (other.name == probe.name)
        this->section.fail("Locations", "two probes are called \"" + probe.name + "\"");
    probes.push_back(probe);
  }

  template <int dim>
  std::vector<std::uint64_t> Probes<dim>::read_numbers(const std::string &entry,
                                                       const std::string &list) const
  {
    std::vector<std::uint64_t> result;
    for (const std::string &text : Utilities::split_string_list(list, ','))
    {
      const bool is_number = !text.empty() && text.size() < 20 &&
                             text.find_first_not_of("0123456789") == std::string::npos;
      if (!is_number)
        this->section.fail(entry, "\"" + text + "\" is not the number of a node");
      result.push_back(std::stoull(text));
      if (std::count(result.begin(), result.end(), result.back()) > 1)
        this->section.fail(entry, "the node " + text + " is listed twice");
    }
    return result;
  }

  template <int dim>
  std::vector<std::uint64_t> Probes<dim>::mesh_nodes(const OutputView<dim> &view) const
  {
    std::vector<std::uint64_t> result(mesh_numbers.size());
    if (mesh_numbers.empty())
      return result;
    const std::string entry = "Mesh nodes";
    const std::vector<long long> of_vertices =
        mesh_source<dim>(this->section.all())->node_numbers();
    if (of_vertices.empty())
      this->section.fail(entry, "the mesh is not that of a file, and its nodes have no numbers of "
                                "their own; give `Locations`, `Where`, `Boundary` or `Nodes`");
    std::map<unsigned int, std::size_t> place_of_vertex;
    for (std::size_t p = 0; p < mesh_numbers.size(); ++p)
    {
      const auto distance = [&](const long long number)
      { return std::abs(static_cast<double>(number) - static_cast<double>(mesh_numbers[p])); };
      const auto nearest = std::min_element(of_vertices.begin(), of_vertices.end(),
                                            [&](const long long a, const long long b)
                                            { return distance(a) < distance(b); });
      if (static_cast<std::uint64_t>(*nearest) != mesh_numbers[p])
        this->section.fail(entry, "no cell of the mesh file has a corner with the number " +
                                      std::to_string(mesh_numbers[p]) + "; the nearest number is " +
                                      std::to_string(*nearest));
      place_of_vertex[static_cast<unsigned int>(nearest - of_vertices.begin())] = p;
    }

    // The vertices of the file are the first ones of the mesh, however its cells are divided.
    struct Found
    {
      std::size_t place;
      std::uint64_t id;
    };
    std::vector<Found> found;
    const Nodes<dim> &nodes = *view.nodes;
    for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      for (const unsigned int v : cell->vertex_indices())
        if (const auto wanted = place_of_vertex.find(cell->vertex_index(v));
            !cell->is_artificial() && wanted != place_of_vertex.end())
          if (const auto node = cell->vertex_dof_index(v, 0); nodes.owned().is_element(node))
            found.push_back({wanted->second,
                             nodes.persistent_ids()[view.state->partition()->local_index(node)]});
    for (const Found &node : of_all_ranks(found, nodes.communicator()))
      result[node.place] = node.id;
    return result;
  }

  template <int dim>
  std::string Probes<dim>::name_of_chosen(const std::size_t index) const
  {
    const std::size_t of_mesh = index - numbers.size();
    return index >= numbers.size() && of_mesh < mesh_numbers.size()
               ? "mesh node " + std::to_string(mesh_numbers[of_mesh])
               : "node " + std::to_string(chosen[index]);
  }

  template <int dim>
  std::vector<std::pair<std::uint64_t, Point<dim>>>
  Probes<dim>::choose_nodes(const OutputView<dim> &view) const
  {
    struct Found
    {
      std::uint64_t number;
      Point<dim> place;
      bool is_listed;
    };
    const Nodes<dim> &nodes = *view.nodes;
    const NodePartition &partition = *view.state->partition();
    std::vector<std::uint64_t> listed = mesh_nodes(view);
    listed.insert(listed.begin(), numbers.begin(), numbers.end());
    std::vector<Found> found;
    attempt_on_all_ranks<InputError>(
        nodes.communicator(),
        [&]
        {
          std::vector<bool> is_in_region(partition.n_owned(), where && boundary.empty());
          std::set<types::boundary_id> boundaries;
          if (!boundary.empty())
            boundaries = boundary_ids(*view.mesh, this->section, "Boundary");
          std::vector<types::global_dof_index> cell_nodes;
          for (const auto &cell : nodes.dof_handler().active_cell_iterators())
            for (const unsigned int f : cell->face_indices())
              if (!cell->is_artificial() && cell->face(f)->at_boundary() &&
                  boundaries.count(cell->face(f)->boundary_id()) > 0)
              {
                nodes.cell_nodes(cell, cell_nodes);
                for (const unsigned int k : nodes.face_places(f))
                  if (nodes.owned().is_element(cell_nodes[k]))
                    is_in_region[partition.local_index(cell_nodes[k])] = true;
              }
          for (unsigned int i = 0; i < partition.n_owned(); ++i)
          {
            const std::uint64_t number = nodes.persistent_ids()[i];
            const auto place = point_of<dim>(view.state->initial_position.node(i));
            const bool is_listed = std::find(listed.begin(), listed.end(), number) != listed.end();
            if (is_listed || (is_in_region[i] && (!where || (*where)(place))))
              found.push_back({number, place, is_listed});
          }
        });
    found = of_all_ranks(found, nodes.communicator());
    std::sort(found.begin(), found.end(),
              [](const Found &a, const Found &b) { return a.number < b.number; });

    std::vector<std::pair<std::uint64_t, Point<dim>>> result;
    for (const std::uint64_t number : listed)
    {
      const auto node = std::find_if(found.begin(), found.end(),
                                     [&](const Found &one) { return one.number == number; });
      if (node == found.end())
        this->section.fail("Nodes", "there is no node with the number " + std::to_string(number));
      result.emplace_back(number, node->place);
    }
    for (const Found &node : found)
      if (!node.is_listed)
        result.emplace_back(node.number, node.place);
    if (result.size() == listed.size() && (where || !boundary.empty()))
      this->section.fail(where ? "Where" : "Boundary",
                         "there is no node beside those of `Nodes`; nothing would be written");
    return result;
  }

  template <int dim>
  void Probes<dim>::check(const OutputView<dim> &view)
  {
    begin(view);
    History<dim>::check(view);
  }

  template <int dim>
  void Probes<dim>::begin(const OutputView<dim> &view)
  {
    probes.resize(n_locations);
    if (choice != wanted_choice)
    {
      choice = wanted_choice;
      chosen.clear();
      places.clear();
      for (const auto &[number, place] : choose_nodes(view))
      {
        chosen.push_back(number);
        add({name_of_chosen(chosen.size() - 1), place, {}});
      }
    }
    else
      for (std::size_t index = 0; index < chosen.size(); ++index)
        add({name_of_chosen(index), {}, {}});
    const double largest_cell = largest_cell_diameter(*view.nodes);
    const bool are_known = places.size() == dim * probes.size();
    places.resize(dim * probes.size());
    for (std::size_t p = 0; p < probes.size(); ++p)
    {
      BodyPoint<dim> &node = probes[p].node;
      Tensor<1, dim> location = probes[p].location;
      for (unsigned int d = 0; d < dim && are_known; ++d)
        location[d] = places[dim * p + d];
      node.find(*view.nodes, *view.state, location, largest_cell,
                p < n_locations ? std::nullopt : std::make_optional(chosen[p - n_locations]));
      if (const double nearest = node.distance_at_start(); nearest > largest_cell)
        this->section.fail("Locations", "the nearest node is " + format_number(nearest) +
                                            " away from " + text_of(probes[p].location) +
                                            ", more than the largest cell measures (" +
                                            format_number(largest_cell) +
                                            "): this place is outside of the body");
      std::copy_n(node.place_at_start().begin_raw(), dim, places.data() + dim * p);
    }
  }

  template <int dim>
  void Probes<dim>::check_columns(const OutputDirectory &directory, const UnitLabels &unit_labels)
  {
    if (this->table.has_other_columns(unit_labels))
      this->section.fail("Locations",
                         "the probes are not those of the run that is resumed, whose rows are in " +
                             directory.file(probes_file) +
                             ": set them back, or resume into another output directory");
  }

  template <int dim>
  void Probes<dim>::add_columns(const OutputView<dim> &view)
  {
    constexpr unsigned int n_values = 10; // position, displacement, velocity, temperature
    std::vector<double> values(probes.size() * n_values, 0.);
    for (std::size_t p = 0; p < probes.size(); ++p)
      if (probes[p].node.is_here())
      {
        const unsigned int node = probes[p].node.node();
        double *const value = values.data() + p * n_values;
        for (unsigned int d = 0; d < dim && view.has_mechanics; ++d)
        {
          value[d] = view.state->position.node(node)[d];
          value[3 + d] = value[d] - view.state->initial_position.node(node)[d];
          value[6 + d] = view.state->velocity.node(node)[d];
        }
        if (view.heat != nullptr)
          value[9] = *view.heat->present_temperature.node(node);
      }
    // One rank owns each node: the sum only adds zeros to its values.
    Utilities::MPI::sum(std::vector<double>(values), view.nodes->communicator(), values);
    for (std::size_t p = 0; p < probes.size(); ++p)
    {
      const double *const value = values.data() + p * n_values;
      const auto add = [&](const std::string &what, const std::string &unit, const double *const of)
      {
        this->add_vector(probes[p].name + " " + what, unit, {{of[0], of[1], of[2]}});
      };
      if (view.has_mechanics)
      {
        add("position", "L", value);
        add("displacement", "L", value + 3);
        add("velocity", "L/T", value + 6);
      }
      if (view.heat != nullptr)
        this->table.add(probes[p].name + " temperature", "temperature", value[9]);
    }
  }

  template <int dim>
  std::vector<std::uint64_t> Probes<dim>::nodes() const
  {
    std::vector<std::uint64_t> result;
    for (const Probe &probe : probes)
      result.push_back(probe.node.persistent_id());
    return result;
  }

  template class Probes<2>;
  template class Probes<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Output, Probes, "probes",
      "Histories of position, displacement, velocity and temperature at "
      "named nodes (probes.csv).")

  namespace
  {
    const char *const points_file = "points.csv";

    const OutputOfScene of_points(2, "point history", "its own Locations",
                                  [](const Section &output) {
                                    return output.subsection("point history").is_set("Locations");
                                  });
  } // namespace

  /**
   * Histories at material points: `points.csv`, whose rows have time, step, and of the point next
   * to each place of `Locations`, by initial positions, the stress (xx, yy, zz, yz, xz, xy), its
   * von Mises stress and what the material and the formulation remember there. Of points at the
   * same distance the one that comes first by its coordinates is taken. It is looked for in each
   * row, so that it is the one that is there: where cells are divided a point of a child, where
   * they become particles one of these.
   */
  template <int dim>
  class PointHistory : public History<dim>
  {
  public:
    explicit PointHistory(const Entries &e) : History<dim>(e, points_file)
    {
      e.text("Locations", "", "L",
             "Places of which the stress and what the material remembers are written to "
             "points.csv, by initial coordinates, to which the nearest material point is taken, an "
             "integration point of an element or a particle: a list, separated by semicolons, of "
             "`name: x, y, z`, or without a name.");
      if (!e.declares())
        places = read_named_places<dim>(e.section(), "Locations", "point");
      e.refuse(places.empty(), "Locations",
               "give at least one location, for example `root: 0, 0, 0`");
    }

    void check(const OutputView<dim> &view) override
    {
      if (!view.has_mechanics)
        this->section.fail("Locations", "the scene has no mechanics, and no material points");
      const double largest_cell = largest_cell_diameter(*view.nodes);
      for (const NamedPlace<dim> &place : places)
        if (const double distance = nearest(view, place.location).distance; distance > largest_cell)
          this->section.fail(
              "Locations",
              "the nearest material point is " + format_number(distance) + " away from \"" +
                  place.name + "\", more than the largest cell measures (" +
                  format_number(largest_cell) + "): this place is outside of the body");
      History<dim>::check(view);
    }

  private:
    struct Candidate
    {
      double distance = std::numeric_limits<double>::max();
      Point<dim> initial;
      unsigned int part = 0, point = 0, rank = 0;

      bool is_before(const Candidate &other, const double alike) const
      {
        if (std::abs(distance - other.distance) > alike)
          return distance < other.distance;
        for (unsigned int d = 0; d < dim; ++d)
          if (std::abs(initial[d] - other.initial[d]) > alike)
            return initial[d] < other.initial[d];
        return part != other.part ? part < other.part : rank < other.rank;
      }
    };

    /** The material point next to a place, the same on all ranks. Collective. */
    Candidate nearest(const OutputView<dim> &view, const Point<dim> &location) const
    {
      const MPI_Comm communicator = view.nodes->communicator();
      const double alike = 1e-9 * largest_cell_diameter(*view.nodes);
      Candidate best;
      best.rank = Utilities::MPI::this_mpi_process(communicator);
      for (unsigned int p = 0; p < view.parts.size(); ++p)
      {
        const Formulation<dim> &formulation = *view.parts[p].formulation;
        const std::vector<Point<dim>> &initial = formulation.initial_point_positions();
        const MaterialPoints &points = formulation.points();
        for (unsigned int i = 0; i < points.size(); ++i)
        {
          const Candidate other{location.distance(initial[i]), initial[i], p, i, best.rank};
          if (points.component(MaterialPoints::volume, 0)[i] > 0. && other.is_before(best, alike))
            best = other;
        }
      }
      for (const Candidate &other : of_all_ranks(std::vector<Candidate>{best}, communicator))
        if (other.is_before(best, alike))
          best = other;
      return best;
    }

    void add_columns(const OutputView<dim> &view) override
    {
      for (const NamedPlace<dim> &place : places)
      {
        const Candidate found = nearest(view, place.location);
        const MaterialPoints &points = view.parts[found.part].formulation->points();
        const MPI_Comm communicator = view.nodes->communicator();
        const bool is_here = found.rank == Utilities::MPI::this_mpi_process(communicator);
        for (unsigned int f = 0; f < points.fields().size(); ++f)
        {
          const FieldDescription &field = points.fields()[f];
          if (field.is_internal)
            continue;
          std::vector<double> values(field.n_components, 0.);
          for (unsigned int c = 0; c < field.n_components && is_here; ++c)
            values[c] = points.component(f, c)[found.point];
          // One rank has the point: the sum only adds zeros to its values.
          Utilities::MPI::sum(std::vector<double>(values), communicator, values);
          const std::string name = place.name + " " + field.name;
          static const std::array<const char *, 6> of_tensor = {
              {" xx", " yy", " zz", " yz", " xz", " xy"}};
          for (unsigned int c = 0; c < field.n_components; ++c)
            this->table.add(name + (field.n_components == 1   ? ""
                                    : field.n_components == 6 ? of_tensor[c]
                                                              : " " + std::to_string(c + 1)),
                            field.unit, values[c]);
          if (f == MaterialPoints::stress)
            this->table.add(place.name + " von Mises stress", field.unit,
                            von_mises_stress(values.data()));
        }
      }
    }

    std::vector<NamedPlace<dim>> places;
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Output, PointHistory, "point history",
                                  "Histories of stress and of what the material remembers at named "
                                  "material points (points.csv).")
} // namespace tombolo
