// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/mesh/boundary_names.h>
#include <tombolo/mesh/mesh_source.h>
#include <tombolo/output/history.h>
#include <tombolo/output/output.h>
#include <tombolo/state/body_point.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/point.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /** A location of which an output is requested, and the name of its columns. */
  template <int dim>
  struct NamedLocation
  {
    std::string name;
    dealii::Point<dim> location;

    /** The locations of an entry, a list, separated by semicolons, of `name: x, y, z`; one without
     * a name is called @p word and its number in the list. Throws InputError. */
    static std::vector<NamedLocation> read(const Section &section, const std::string &entry,
                                           const std::string &word)
    {
      std::vector<NamedLocation> result;
      for (const std::string &text : dealii::Utilities::split_string_list(section.get(entry), ';'))
      {
        const auto named =
            read_one(text, section, entry, word + " " + std::to_string(result.size() + 1));
        if (std::any_of(result.begin(), result.end(),
                        [&](const NamedLocation &other) { return other.name == named.name; }))
          section.fail(entry, "two " + word + "s are called \"" + named.name + "\"");
        result.push_back(named);
      }
      return result;
    }

  private:
    static NamedLocation read_one(const std::string &text, const Section &section,
                                  const std::string &entry, const std::string &name)
    {
      const std::size_t colon = text.rfind(':');
      NamedLocation result{
          colon == std::string::npos ? name : dealii::Utilities::trim(text.substr(0, colon)), {}};
      if (result.name.empty())
        section.fail(entry, "\"" + text + "\" has no name before the colon");
      const std::vector<std::string> numbers = dealii::Utilities::split_string_list(
          colon == std::string::npos ? text : text.substr(colon + 1), ',');
      if (numbers.size() != dim)
        section.fail(entry, "\"" + text + "\" has " + std::to_string(numbers.size()) +
                                " coordinates; " + std::to_string(dim) +
                                " are needed, separated by commas");
      for (unsigned int d = 0; d < dim; ++d)
        if (!is_number(numbers[d], result.location[d]) || !std::isfinite(result.location[d]))
          section.fail(entry, "\"" + numbers[d] + "\" in \"" + text + "\" is not a number");
      return result;
    }
  };

  /**
   * Histories at nodes: `probes.csv`, whose rows have time, step, and for each probe position,
   * displacement and velocity (of half a step before) and, in scenes with heat, temperature of its
   * node. Of nodes at the same distance from a location the one with the smallest persistent id is
   * taken, so the choice does not depend on the number of ranks. Nodes by number and of a region
   * are called "node" and their persistent id at the start, those of a region in its order; `Mesh
   * nodes` "mesh node" and their number in the file.
   */
  template <int dim>
  class Probes : public History<dim>
  {
  public:
    explicit Probes(const Entries &e) : History<dim>(e, probes_file, {"Steps", "1", "Interval"})
    {
      this->records.value("places of nodes", initial_coordinates).optional();
      this->records.value("numbers of nodes", chosen).optional();
      this->records.value("choice of nodes", choice).optional();
      e.text("Locations", "", "L",
             "Nodes whose motion is written to probes.csv, by initial coordinates, to which the "
             "nearest node is taken: a list, separated by semicolons, of `name: x, y, z`, or "
             "without a name.");
      if (!e.declares())
        for (const NamedLocation<dim> &named :
             NamedLocation<dim>::read(e.section(), "Locations", "probe"))
          add({named.name, named.location, {}});
      n_locations = probes.size();
      const std::string nodes_text = e.text(
          "Nodes", "", "",
          "Further nodes by number, separated by commas: the `persistent id` of particles in "
          "pictures, by which messages name nodes, too.");
      numbers = read_numbers("Nodes", nodes_text);
      const std::string mesh_nodes_text = e.text(
          "Mesh nodes", "", "",
          "Further nodes by their number in the mesh file, separated by commas: the tag of a node "
          "of gmsh, which is the number of the deck where scripts/import has made the file, or the "
          "index of a point of VTK, counted from 0. Corners of cells have one, also where the "
          "cells are refined.");
      mesh_numbers = read_numbers("Mesh nodes", mesh_nodes_text);
      where = e.optional<Predicate<dim>>("Where", "",
                                         "All nodes at whose initial position this holds, such as "
                                         "`x < 1e-9`, with `Boundary` those of them on it.");
      boundary =
          e.text("Boundary", "", "",
                 "All nodes on these boundaries, names separated by commas, with `Where` those "
                 "of them where it holds.");
      requested_choice = nodes_text + "|" + e.given("Where") + "|" + boundary +
                         (mesh_nodes_text.empty() ? "" : "|" + mesh_nodes_text);
      const bool has_choice =
          !numbers.empty() || !mesh_numbers.empty() || where || !boundary.empty();
      if (!has_choice)
        choice = requested_choice;
      e.refuse(probes.empty() && !has_choice, "Locations",
               "give at least one location, for example `tip: 10, 0, 0`");
    }

    /** Throws InputError where a location is far from every node, or a node is not there. */
    void check(const OutputView<dim> &view) override
    {
      begin(view);
      History<dim>::check(view);
    }

    /** Persistent ids of the nodes that were chosen, in the order of columns. */
    std::vector<std::uint64_t> nodes() const
    {
      std::vector<std::uint64_t> result;
      for (const Probe &probe : probes)
        result.push_back(probe.node.persistent_id());
      return result;
    }

  private:
    static constexpr const char *probes_file = "probes.csv";

    struct Probe
    {
      std::string name;
      dealii::Point<dim> location;
      BodyPoint<dim> node;
    };

    void add(const Probe &probe)
    {
      for (const Probe &other : probes)
        if (other.name == probe.name)
          this->section.fail("Locations", "two probes are called \"" + probe.name + "\"");
      probes.push_back(probe);
    }

    /** The numbers that an entry lists. Throws InputError. */
    std::vector<std::uint64_t> read_numbers(const std::string &entry, const std::string &list) const
    {
      std::vector<std::uint64_t> result;
      for (const std::string &text : dealii::Utilities::split_string_list(list, ','))
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

    /** The persistent ids of `Mesh nodes`. Throws InputError. Collective. */
    std::vector<std::uint64_t> mesh_nodes(const OutputView<dim> &view) const
    {
      std::vector<std::uint64_t> result(mesh_numbers.size());
      if (mesh_numbers.empty())
        return result;
      const std::string entry = "Mesh nodes";
      const std::vector<long long> vertex_numbers =
          mesh_source<dim>(this->section.all())->node_numbers();
      if (vertex_numbers.empty())
        this->section.fail(entry,
                           "the mesh is not that of a file, and its nodes have no numbers of "
                           "their own; give `Locations`, `Where`, `Boundary` or `Nodes`");
      std::map<unsigned int, std::size_t> index_of_vertex;
      for (std::size_t p = 0; p < mesh_numbers.size(); ++p)
      {
        const auto distance = [&](const long long number)
        { return std::abs(static_cast<double>(number) - static_cast<double>(mesh_numbers[p])); };
        const auto nearest = std::min_element(vertex_numbers.begin(), vertex_numbers.end(),
                                              [&](const long long a, const long long b)
                                              { return distance(a) < distance(b); });
        if (static_cast<std::uint64_t>(*nearest) != mesh_numbers[p])
          this->section.fail(entry, "no cell of the mesh file has a corner with the number " +
                                        std::to_string(mesh_numbers[p]) +
                                        "; the nearest number is " + std::to_string(*nearest));
        index_of_vertex[static_cast<unsigned int>(nearest - vertex_numbers.begin())] = p;
      }

      // The vertices of the file are the first ones of the mesh, however its cells are divided.
      struct Found
      {
        std::size_t index;
        std::uint64_t id;
      };
      std::vector<Found> found;
      const Nodes<dim> &nodes = *view.nodes;
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
        for (const unsigned int v : cell->vertex_indices())
          if (const auto requested = index_of_vertex.find(cell->vertex_index(v));
              !cell->is_artificial() && requested != index_of_vertex.end())
            if (const auto node = cell->vertex_dof_index(v, 0); nodes.owned().is_element(node))
              found.push_back({requested->second,
                               nodes.persistent_ids()[view.state->partition()->local_index(node)]});
      for (const Found &node : from_all_ranks(found, nodes.communicator()))
        result[node.index] = node.id;
      return result;
    }

    /** Persistent ids and initial positions of the nodes that are given by number and region.
     * Throws InputError. Collective. */
    std::vector<std::pair<std::uint64_t, dealii::Point<dim>>>
    choose_nodes(const OutputView<dim> &view) const
    {
      struct Found
      {
        std::uint64_t number;
        dealii::Point<dim> position;
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
            std::set<dealii::types::boundary_id> boundaries;
            if (!boundary.empty())
              boundaries = boundary_ids(*view.mesh, this->section, "Boundary");
            nodes.for_each_boundary_node(
                [&](const auto &cell, const unsigned int f)
                { return boundaries.count(cell->face(f)->boundary_id()) > 0; },
                [&](const dealii::types::global_dof_index node)
                {
                  if (nodes.owned().is_element(node))
                    is_in_region[partition.local_index(node)] = true;
                });
            for (unsigned int i = 0; i < partition.n_owned(); ++i)
            {
              const std::uint64_t number = nodes.persistent_ids()[i];
              const auto position = point_of<dim>(view.state->initial_position.node(i));
              const bool is_listed =
                  std::find(listed.begin(), listed.end(), number) != listed.end();
              if (is_listed || (is_in_region[i] && (!where || (*where)(position))))
                found.push_back({number, position, is_listed});
            }
          });
      found = from_all_ranks(found, nodes.communicator());
      std::sort(found.begin(), found.end(),
                [](const Found &a, const Found &b) { return a.number < b.number; });

      std::vector<std::pair<std::uint64_t, dealii::Point<dim>>> result;
      for (const std::uint64_t number : listed)
      {
        const auto node = std::find_if(found.begin(), found.end(),
                                       [&](const Found &one) { return one.number == number; });
        if (node == found.end())
          this->section.fail("Nodes", "there is no node with the number " + std::to_string(number));
        result.emplace_back(number, node->position);
      }
      for (const Found &node : found)
        if (!node.is_listed)
          result.emplace_back(node.number, node.position);
      if (result.size() == listed.size() && (where || !boundary.empty()))
        this->section.fail(where ? "Where" : "Boundary",
                           "there is no node beside those of `Nodes`; nothing would be written");
      return result;
    }

    /** What one of these is called. */
    std::string name_of_chosen(const std::size_t index) const
    {
      const std::size_t mesh_index = index - numbers.size();
      return index >= numbers.size() && mesh_index < mesh_numbers.size()
                 ? "mesh node " + std::to_string(mesh_numbers[mesh_index])
                 : "node " + std::to_string(chosen[index]);
    }

    /** The nodes next to the locations, at the start of the run; afterwards they stay the same ones
     * where cells are divided. Throws InputError. Collective. */
    void begin(const OutputView<dim> &view) override
    {
      probes.resize(n_locations);
      if (choice != requested_choice)
      {
        choice = requested_choice;
        chosen.clear();
        initial_coordinates.clear();
        for (const auto &[number, position] : choose_nodes(view))
        {
          chosen.push_back(number);
          add({name_of_chosen(chosen.size() - 1), position, {}});
        }
      }
      else
        for (std::size_t index = 0; index < chosen.size(); ++index)
          add({name_of_chosen(index), {}, {}});
      const double largest_cell = largest_cell_diameter(*view.nodes);
      const bool are_known = initial_coordinates.size() == dim * probes.size();
      initial_coordinates.resize(dim * probes.size());
      for (std::size_t p = 0; p < probes.size(); ++p)
      {
        BodyPoint<dim> &node = probes[p].node;
        dealii::Tensor<1, dim> location = probes[p].location;
        for (unsigned int d = 0; d < dim && are_known; ++d)
          location[d] = initial_coordinates[dim * p + d];
        node.find(*view.nodes, *view.state, location, largest_cell,
                  p < n_locations ? std::nullopt : std::make_optional(chosen[p - n_locations]));
        if (const std::string why = node.why_outside(); !why.empty())
          this->section.fail("Locations", why);
        std::copy_n(node.initial_position().begin_raw(), dim, initial_coordinates.data() + dim * p);
      }
    }

    void add_columns(const OutputView<dim> &view) override
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
      dealii::Utilities::MPI::sum(std::vector<double>(values), view.nodes->communicator(), values);
      for (std::size_t p = 0; p < probes.size(); ++p)
      {
        const double *const value = values.data() + p * n_values;
        const auto add = [&](const std::string &what, const std::string &unit,
                             const double *const of) {
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

    void check_columns(const OutputDirectory &directory, const UnitLabels &unit_labels) override
    {
      if (this->table.has_other_columns(unit_labels))
        this->section.fail(
            "Locations", "the probes are not those of the run that is resumed, whose rows are in " +
                             directory.file(probes_file) +
                             ": set them back, or resume into another output directory");
    }

    std::vector<Probe> probes; ///< those of locations first
    std::size_t n_locations = 0;
    std::vector<std::uint64_t> numbers;      ///< of the entry `Nodes`
    std::vector<std::uint64_t> mesh_numbers; ///< of the entry `Mesh nodes`
    std::optional<Predicate<dim>> where;     ///< of the region
    std::string boundary;                    ///< likewise
    std::string requested_choice, choice;    ///< what is requested, and what is chosen
    std::vector<std::uint64_t> chosen;       ///< of the nodes by number and region, at the start
    std::vector<double>
        initial_coordinates; ///< initial coordinates of the nodes, one after the other
  };
} // namespace tombolo
