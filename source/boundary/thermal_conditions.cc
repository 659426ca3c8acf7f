// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/boundary/thermal_conditions.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/boundary/limited_function.h>
#include <tombolo/boundary/region.h>
#include <tombolo/boundary/thermal_condition.h>
#include <tombolo/boundary/tributary_areas.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  using namespace dealii;

  /** The nodes and faces that thermal conditions select, at the start of a run. */
  template <int dim>
  class ThermalSelection
  {
  public:
    /** Finds them, and adds faces that heat crosses to @p areas, by condition. @p conditions are
     * those of @p sections and must outlive this, as @p nodes. No heat crosses planes of symmetry.
     * Throws InputError where a condition selects nothing, or two on one face exclude each other.
     * Collective. */
    ThermalSelection(const std::vector<Section> &sections,
                     const std::vector<ThermalCondition<dim>> &conditions, const Nodes<dim> &nodes,
                     TributaryAreas<dim> &areas)
        : conditions(conditions), nodes(nodes), selected_nodes(sections.size()),
          n_selected(sections.size(), 0), n_conflicts(sections.size() * sections.size(), 0)
    {
      // The value of a predicate or a function can be undefined on one rank alone.
      std::string message;
      try
      {
        find_nodes();
        find_faces(areas);
      }
      catch (const InputError &error)
      {
        message = error.what();
      }
      throw_on_all_ranks<InputError>(message, nodes.communicator());
      refuse_what_selects_nothing(sections);
      refuse_conflicts(sections);
    }

    /** By condition: owned nodes of a temperature or a source, ascending; none for others. */
    std::vector<std::vector<dealii::types::global_dof_index>> owned_nodes() const
    {
      std::vector<std::vector<types::global_dof_index>> result(selected_nodes.size());
      for (std::size_t c = 0; c < selected_nodes.size(); ++c)
        std::copy_if(
            selected_nodes[c].begin(), selected_nodes[c].end(), std::back_inserter(result[c]),
            [&](const types::global_dof_index node) { return nodes.owned().is_element(node); });
      return result;
    }

  private:
    void find_nodes()
    {
      std::vector<types::global_dof_index> cell_nodes;
      std::vector<Point<dim>> cell_points;
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      {
        if (cell->is_artificial())
          continue;
        nodes.cell_nodes(cell, cell_nodes);
        nodes.cell_points(cell, cell_points);
        const auto select = [&](const unsigned int c, const unsigned int k)
        {
          if (conditions[c].place.contains(cell_points[k]))
            selected_nodes[c].push_back(cell_nodes[k]);
        };
        for (unsigned int c = 0; c < conditions.size(); ++c)
        {
          const Place<dim> &place = conditions[c].place;
          if (is_on_faces(conditions[c].type))
            continue;
          if (!place.has_boundaries())
            for (unsigned int k = 0; k < cell_nodes.size(); ++k)
              select(c, k);
          else
            for (const unsigned int f : cell->face_indices())
              if (cell->face(f)->at_boundary() && place.has_boundary(cell->face(f)->boundary_id()))
                for (const unsigned int k : nodes.face_places(f))
                  select(c, k);
        }
      }
      for (unsigned int c = 0; c < conditions.size(); ++c)
      {
        std::vector<types::global_dof_index> &selected = selected_nodes[c];
        std::sort(selected.begin(), selected.end());
        selected.erase(std::unique(selected.begin(), selected.end()), selected.end());
        for (const types::global_dof_index node : selected)
          n_selected[c] += nodes.owned().is_element(node) ? 1 : 0;
      }
    }

    void find_faces(TributaryAreas<dim> &areas)
    {
      std::vector<types::global_dof_index> cell_nodes, face_nodes;
      std::vector<Point<dim>> cell_points;
      std::vector<unsigned int> present;
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      {
        if (!cell->is_locally_owned() || !cell->at_boundary())
          continue;
        nodes.cell_nodes(cell, cell_nodes);
        nodes.cell_points(cell, cell_points);
        for (const unsigned int f : cell->face_indices())
        {
          if (!cell->face(f)->at_boundary())
            continue;
          face_nodes.clear();
          for (const unsigned int k : nodes.face_places(f))
            face_nodes.push_back(cell_nodes[k]);
          const bool is_outer = nodes.is_outer_face(cell, f);
          present.clear();
          for (unsigned int c = 0; c < conditions.size(); ++c)
          {
            const ThermalCondition<dim> &condition = conditions[c];
            if (condition.type == ThermalConditionType::temperature)
            {
              const std::vector<types::global_dof_index> &all = selected_nodes[c];
              if (std::all_of(face_nodes.begin(), face_nodes.end(),
                              [&](const types::global_dof_index node)
                              { return std::binary_search(all.begin(), all.end(), node); }))
                present.push_back(c);
              continue;
            }
            if (!is_on_faces(condition.type) || (crosses_surface(condition.type) && !is_outer) ||
                !condition.place.contains_face(cell->face(f)->boundary_id(),
                                               cell->face(f)->center()))
              continue;
            present.push_back(c);
            ++n_selected[c];
            if (crosses_surface(condition.type))
              areas.add_face(c, face_nodes);
            if (is_film(condition.type))
              for (const LimitedFunction<dim> *function :
                   {&*condition.coefficient, &*condition.ambient})
                if (function->depends_on_place())
                  for (const unsigned int k : nodes.face_places(f))
                    function->check_start(cell_points[k]);
          }
          for (const unsigned int later : present)
            for (const unsigned int earlier : present)
              if (earlier < later &&
                  !are_compatible(conditions[earlier].type, conditions[later].type))
                ++n_conflicts[later * conditions.size() + earlier];
        }
      }
    }

    void refuse_what_selects_nothing(const std::vector<Section> &sections) const
    {
      for (unsigned int c = 0; c < conditions.size(); ++c)
        if (Utilities::MPI::sum(n_selected[c], nodes.communicator()) == 0)
          conditions[c].place.fail_empty(
              sections[c], is_on_faces(conditions[c].type) ? nodes.outer_face_text() : "node");
    }

    void refuse_conflicts(const std::vector<Section> &sections) const
    {
      std::vector<unsigned int> n_shared(n_conflicts.size());
      Utilities::MPI::sum(n_conflicts, nodes.communicator(), n_shared);
      for (unsigned int later = 0; later < conditions.size(); ++later)
        for (unsigned int earlier = 0; earlier < later; ++earlier)
        {
          const unsigned int n = n_shared[later * conditions.size() + earlier];
          if (n == 0)
            continue;
          const bool is_twice = conditions[later].type == conditions[earlier].type;
          sections[later].fail(
              "Type", (n == 1 ? "a face" : std::to_string(n) + " faces") +
                          " of the boundary that the condition selects " +
                          (n == 1 ? "has" : "have") + " the condition \"" +
                          conditions[earlier].name + "\" of type \"" +
                          sections[earlier].get("Type") + "\" already; " +
                          (is_twice ? "allowed is one condition of a type on a face."
                                    : "a temperature or an adiabatic surface allows no other "
                                      "condition on a face."));
        }
    }

    const std::vector<ThermalCondition<dim>> &conditions;
    const Nodes<dim> &nodes;
    /** By condition: owned and ghost nodes of a temperature or a source, ascending. */
    std::vector<std::vector<dealii::types::global_dof_index>> selected_nodes;
    std::vector<unsigned long> n_selected; ///< owned nodes or faces, by condition
    /** Faces of this rank with two conditions that exclude each other: [later][earlier]. */
    std::vector<unsigned int> n_conflicts;
  };

  template class ThermalSelection<2>;

  template class ThermalSelection<3>;

  /** The values of a function at nodes at one time; one without a place is evaluated once. */
  template <int dim>
  class ValuesAtNodes
  {
  public:
    ValuesAtNodes(const LimitedFunction<dim> &function, const NodalVector &initial_position,
                  const double time)
        : function(function), initial_position(initial_position), time(time)
    {}

    double operator()(const unsigned int node)
    {
      if (!is_known || function.depends_on_place())
        present = function.value(point_of<dim>(initial_position.node(node)), time);
      is_known = true;
      return present;
    }

  private:
    const LimitedFunction<dim> &function;
    const NodalVector &initial_position;
    double time;
    double present = 0;
    bool is_known = false;
  };

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
