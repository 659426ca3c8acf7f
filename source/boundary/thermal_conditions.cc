// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/boundary/thermal_conditions.h>

#include <tombolo/boundary/thermal_condition.h>
#include <tombolo/boundary/thermal_selection.h>
#include <tombolo/boundary/tributary_areas.h>
#include <tombolo/boundary/values_at_nodes.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  struct ThermalConditions<dim>::Implementation
  {
    struct Constraint
    {
      types::global_dof_index global_node;
      unsigned int condition;
    };

    Implementation(const std::vector<Section> &sections, const Section &heat, const Mesh<dim> &mesh,
                   const Nodes<dim> &nodes);

    bool has_type(bool (*is_wanted)(ThermalConditionType)) const
    {
      return std::any_of(conditions.begin(), conditions.end(),
                         [&](const ThermalCondition<dim> &condition)
                         { return is_wanted(condition.type); });
    }

    /** Calls action(condition, node, area, SurfaceHeat) for the nodes of its faces. */
    template <typename Action>
    void for_each_surface_node(const NodalVector &initial_position, const NodalVector &temperature,
                               const double time, const bool only_films, const Action &action)
    {
      for (unsigned int c = 0; c < conditions.size(); ++c)
      {
        const ThermalCondition<dim> &condition = conditions[c];
        const std::vector<unsigned int> &nodes = areas.nodes(c);
        const std::vector<double> &area = areas.areas(c);
        if (condition.type == ThermalConditionType::heat_flux && !only_films)
        {
          ValuesAtNodes<dim> flux(*condition.function, initial_position, time);
          for (std::size_t k = 0; k < nodes.size(); ++k)
            action(c, nodes[k], area[k], SurfaceHeat{flux(nodes[k]), 0.});
        }
        else if (is_film(condition.type))
        {
          ValuesAtNodes<dim> coefficient(*condition.coefficient, initial_position, time);
          ValuesAtNodes<dim> ambient(*condition.ambient, initial_position, time);
          for (std::size_t k = 0; k < nodes.size(); ++k)
            action(c, nodes[k], area[k],
                   condition.film_heat(coefficient(nodes[k]), ambient(nodes[k]),
                                       temperature.node(nodes[k])[0]));
        }
      }
    }

    /** Does @p action; a RunError of it becomes the failure() of this rank. */
    template <typename Action>
    void evaluate(const Action &action)
    {
      try
      {
        action();
      }
      catch (const RunError &error)
      {
        if (failure.empty())
          failure = error.what();
      }
    }

    std::vector<ThermalCondition<dim>> conditions;
    TributaryAreas<dim> areas; ///< by condition
    std::string failure;

    /** By condition: owned nodes of a temperature or a source, ascending. */
    std::vector<std::vector<types::global_dof_index>> selected_nodes;
    std::vector<Constraint> constraints;        ///< of owned nodes, ascending
    std::vector<unsigned int> constraint_nodes; ///< local
    std::vector<std::uint8_t> constrained;
    std::vector<std::vector<unsigned int>> source_nodes; ///< by condition, local, owned
  };

  template <int dim>
  ThermalConditions<dim>::Implementation::Implementation(const std::vector<Section> &sections,
                                                         const Section &heat, const Mesh<dim> &mesh,
                                                         const Nodes<dim> &nodes)
      : areas(static_cast<unsigned int>(sections.size()), nodes), source_nodes(sections.size())
  {
    if (sections.empty())
      return;
    for (const Section &section : sections)
    {
      conditions.push_back(ThermalCondition<dim>::read(section, heat));
      conditions.back().place.find_boundaries(mesh, section);
    }
    selected_nodes = ThermalSelection<dim>(sections, conditions, nodes, areas).owned_nodes();

    // Of several conditions that prescribe a node, as at an edge, the last one does it.
    std::map<types::global_dof_index, unsigned int> prescribed;
    for (unsigned int c = 0; c < conditions.size(); ++c)
      if (conditions[c].type == ThermalConditionType::temperature)
        for (const types::global_dof_index node : selected_nodes[c])
          prescribed[node] = c;
    for (const auto &[node, c] : prescribed)
      constraints.push_back({node, c});
  }

  template <int dim>
  bool ThermalConditions<dim>::is_thermal(const Section &section)
  {
    return thermal_condition_type(section).has_value();
  }

  template <int dim>
  void ThermalConditions<dim>::declare_parameters(const Entries &e)
  {
    e.text("Film coefficient", mandatory, "M/(T^3 K)",
           "h >= 0 of a convection, which gives the heat h (ambient temperature - temperature) to "
           "the body per current area and time; a function of the initial position x, y, z and of "
           "the time t.");
    e.text("Emissivity", mandatory, "",
           "Of a radiation, from 0 to 1; a function of the initial position x, y, z and of the "
           "time t. The heat emissivity * Stefan-Boltzmann constant * (ambient temperature^4 - "
           "temperature^4), both from `Heat/Absolute zero`, enters per current area and time.");
    e.text("Ambient temperature", mandatory, "K",
           "Of a convection or a radiation: the temperature far from the surface, a function of "
           "the initial position x, y, z and of the time t.");
    e.number("Stefan-Boltzmann constant", mandatory, any_number(), "M/(T^3 K^4)",
             "Of a radiation, larger than zero, in the units of the scene: 5.670374419e-8 W/(m^2 "
             "K^4) in metres, kilograms, seconds and kelvin.");
  }

  template <int dim>
  void ThermalConditions<dim>::validate(const Section &section, const Section &heat)
  {
    ThermalCondition<dim>::read(section, heat);
  }

  template <int dim>
  ThermalConditions<dim>::ThermalConditions(const std::vector<Section> &sections,
                                            const Section &heat, const Mesh<dim> &mesh,
                                            const Nodes<dim> &nodes)
      : implementation(std::make_unique<Implementation>(sections, heat, mesh, nodes))
  {}

  template <int dim>
  ThermalConditions<dim>::~ThermalConditions() = default;

  template <int dim>
  IndexSet ThermalConditions<dim>::required_nodes() const
  {
    return implementation->areas.required_nodes();
  }

  template <int dim>
  void ThermalConditions<dim>::set_partition(const NodePartition &partition)
  {
    Implementation &data = *implementation;
    data.areas.set_partition(partition);
    for (unsigned int c = 0; c < data.conditions.size(); ++c)
      if (data.conditions[c].type == ThermalConditionType::heat_source)
      {
        data.source_nodes[c].clear();
        for (const types::global_dof_index node : data.selected_nodes[c])
          data.source_nodes[c].push_back(partition.local_index(node));
      }
    data.constrained.clear();
    data.constraint_nodes.clear();
    if (Utilities::MPI::max(data.constraints.empty() ? 0 : 1, partition.communicator()) == 0)
      return;
    data.constrained.assign(partition.n_owned(), 0);
    for (const auto &constraint : data.constraints)
    {
      const unsigned int node = partition.local_index(constraint.global_node);
      data.constraint_nodes.push_back(node);
      data.constrained[node] = std::numeric_limits<std::uint8_t>::max();
    }
  }

  template <int dim>
  void ThermalConditions<dim>::remove_faces(
      const std::vector<std::vector<types::global_dof_index>> &nodes_of_cells)
  {
    implementation->areas.remove_faces_of(nodes_of_cells);
  }

  template <int dim>
  unsigned int ThermalConditions<dim>::n_conditions() const
  {
    return static_cast<unsigned int>(implementation->conditions.size());
  }

  template <int dim>
  const std::string &ThermalConditions<dim>::name(const unsigned int condition) const
  {
    AssertIndexRange(condition, n_conditions());
    return implementation->conditions[condition].name;
  }

  template <int dim>
  bool ThermalConditions<dim>::has_surface_heat() const
  {
    return implementation->has_type(&crosses_surface);
  }

  template <int dim>
  bool ThermalConditions<dim>::has_sources() const
  {
    return implementation->has_type([](const ThermalConditionType type)
                                    { return type == ThermalConditionType::heat_source; });
  }

  template <int dim>
  bool ThermalConditions<dim>::has_films() const
  {
    return implementation->has_type(&is_film);
  }

  template <int dim>
  bool ThermalConditions<dim>::has_constraints() const
  {
    return implementation->has_type([](const ThermalConditionType type)
                                    { return type == ThermalConditionType::temperature; });
  }

  template <int dim>
  const std::vector<std::uint8_t> &ThermalConditions<dim>::constrained_components() const
  {
    return implementation->constrained;
  }

  template <int dim>
  const std::vector<unsigned int> &ThermalConditions<dim>::constrained_nodes() const
  {
    return implementation->constraint_nodes;
  }

  template <int dim>
  std::vector<unsigned int>
  ThermalConditions<dim>::surface_nodes(const std::shared_ptr<const NodePartition> &partition) const
  {
    return implementation->areas.owned_nodes(partition);
  }

  template <int dim>
  void ThermalConditions<dim>::update_areas(const NodalVector &position)
  {
    implementation->areas.update(position);
  }

  template <int dim>
  void ThermalConditions<dim>::add_surface_heat(const NodalVector &initial_position,
                                                const NodalVector &temperature, const double time,
                                                NodalVector &heat_rate,
                                                std::vector<double> &of_condition) const
  {
    AssertDimension(of_condition.size(), n_conditions());
    const auto add = [&](const unsigned int condition, const unsigned int node, const double area,
                         const SurfaceHeat &heat)
    {
      const double rate = heat.flux * area;
      heat_rate.node(node)[0] += rate;
      of_condition[condition] += rate;
    };
    implementation->evaluate(
        [&]() {
          implementation->for_each_surface_node(initial_position, temperature, time, false, add);
        });
  }

  template <int dim>
  void ThermalConditions<dim>::add_film_action(const NodalVector &initial_position,
                                               const NodalVector &temperature, const double time,
                                               const NodalVector &field, NodalVector &result) const
  {
    const auto add =
        [&](const unsigned int, const unsigned int node, const double area, const SurfaceHeat &heat)
    { result.node(node)[0] += heat.film * area * field.node(node)[0]; };
    implementation->evaluate(
        [&]()
        { implementation->for_each_surface_node(initial_position, temperature, time, true, add); });
  }

  template <int dim>
  void ThermalConditions<dim>::add_sources(const NodalVector &initial_position,
                                           const NodalVector &initial_volume, const double time,
                                           NodalVector &heat_rate,
                                           std::vector<double> &of_condition) const
  {
    AssertDimension(of_condition.size(), n_conditions());
    const Implementation &data = *implementation;
    const auto add = [&]()
    {
      for (unsigned int c = 0; c < data.conditions.size(); ++c)
      {
        if (data.conditions[c].type != ThermalConditionType::heat_source)
          continue;
        ValuesAtNodes<dim> source(*data.conditions[c].function, initial_position, time);
        for (const unsigned int node : data.source_nodes[c])
        {
          const double rate = source(node) * *initial_volume.node(node);
          heat_rate.node(node)[0] += rate;
          of_condition[c] += rate;
        }
      }
    };
    implementation->evaluate(add);
  }

  template <int dim>
  void ThermalConditions<dim>::prescribe(const NodalVector &initial_position, const double time,
                                         NodalVector &temperature) const
  {
    const Implementation &data = *implementation;
    const auto set = [&]()
    {
      std::vector<std::optional<ValuesAtNodes<dim>>> values(data.conditions.size());
      for (std::size_t k = 0; k < data.constraints.size(); ++k)
      {
        const unsigned int c = data.constraints[k].condition;
        if (!values[c])
          values[c].emplace(*data.conditions[c].function, initial_position, time);
        const unsigned int node = data.constraint_nodes[k];
        temperature.node(node)[0] = (*values[c])(node);
      }
    };
    implementation->evaluate(set);
  }

  template <int dim>
  unsigned int ThermalConditions<dim>::condition_of_constraint(const std::size_t k) const
  {
    return implementation->constraints[k].condition;
  }

  template <int dim>
  const std::string &ThermalConditions<dim>::failure() const
  {
    return implementation->failure;
  }

  template class ThermalConditions<2>;
  template class ThermalConditions<3>;
} // namespace tombolo
