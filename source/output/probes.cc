// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/probes.h>

#include <tombolo/base/format.h>
#include <tombolo/output/output_of_scene.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    const char *const probes_file = "probes.csv";

    const OutputOfScene of_probes(1, "probes", "its own Locations",
                                  [](const Section &output)
                                  { return output.subsection("probes").is_set("Locations"); });

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
    const std::string locations = e.text(
        "Locations", "", "L",
        "Nodes whose motion is written to probes.csv, by initial coordinates, to which the nearest "
        "node is taken: a list, separated by semicolons, of `name: x, y, z`, or without a name.");
    for (const std::string &text : Utilities::split_string_list(locations, ';'))
      read_location(text);
    e.refuse(probes.empty(), "Locations",
             "give at least one location, for example `tip: 10, 0, 0`");
  }

  template <int dim>
  void Probes<dim>::read_location(const std::string &text)
  {
    Probe probe;
    const std::size_t colon = text.rfind(':');
    probe.name = colon == std::string::npos ? "probe " + std::to_string(probes.size() + 1)
                                            : Utilities::trim(text.substr(0, colon));
    if (probe.name.empty())
      this->section.fail("Locations", "\"" + text + "\" has no name before the colon");
    for (const Probe &other : probes)
      if (other.name == probe.name)
        this->section.fail("Locations", "two probes are called \"" + probe.name + "\"");

    const std::vector<std::string> numbers = Utilities::split_string_list(
        colon == std::string::npos ? text : text.substr(colon + 1), ',');
    if (numbers.size() != dim)
      this->section.fail("Locations", "\"" + text + "\" has " + std::to_string(numbers.size()) +
                                          " coordinates; " + std::to_string(dim) +
                                          " are needed, separated by commas");
    for (unsigned int d = 0; d < dim; ++d)
    {
      try
      {
        probe.location[d] = Utilities::string_to_double(numbers[d]);
      }
      catch (const ExceptionBase &)
      {
        probe.location[d] = std::numeric_limits<double>::quiet_NaN();
      }
      if (!std::isfinite(probe.location[d]))
        this->section.fail("Locations",
                           "\"" + numbers[d] + "\" in \"" + text + "\" is not a number");
    }
    probes.push_back(probe);
  }

  template <int dim>
  void Probes<dim>::check(const OutputView<dim> &view)
  {
    find_nodes(view);
    History<dim>::check(view);
  }

  template <int dim>
  void Probes<dim>::begin(const OutputView<dim> &view)
  {
    find_nodes(view);
  }

  template <int dim>
  void Probes<dim>::find_nodes(const OutputView<dim> &view)
  {
    const double largest_cell = BodyPoint<dim>::largest_cell(*view.nodes);
    const bool are_known = places.size() == dim * probes.size();
    places.resize(dim * probes.size());
    for (std::size_t p = 0; p < probes.size(); ++p)
    {
      BodyPoint<dim> &node = probes[p].node;
      Tensor<1, dim> location = probes[p].location;
      for (unsigned int d = 0; d < dim && are_known; ++d)
        location[d] = places[dim * p + d];
      node.find(*view.nodes, *view.state, location, largest_cell);
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
} // namespace tombolo
