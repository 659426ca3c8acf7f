// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/boundary/thermal_conditions.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace tombolo
{
  namespace
  {
    const std::array<std::pair<const char *, ThermalConditionType>, 6> type_names = {
        {{"temperature", ThermalConditionType::temperature},
         {"heat flux", ThermalConditionType::heat_flux},
         {"convection", ThermalConditionType::convection},
         {"radiation", ThermalConditionType::radiation},
         {"adiabatic", ThermalConditionType::adiabatic},
         {"heat source", ThermalConditionType::heat_source}}};

    constexpr double infinity = std::numeric_limits<double>::infinity();

    /** None of a condition of another kind. */
    std::optional<ThermalConditionType> thermal_condition_type(const Section &section)
    {
      const std::string text = section.get("Type");
      for (const auto &[name, type] : type_names)
        if (text == name)
          return type;
      return {};
    }
  } // namespace

  bool is_thermal(const Section &section)
  {
    return thermal_condition_type(section).has_value();
  }

  bool is_film(const ThermalConditionType type)
  {
    return type == ThermalConditionType::convection || type == ThermalConditionType::radiation;
  }

  bool crosses_surface(const ThermalConditionType type)
  {
    return type == ThermalConditionType::heat_flux || is_film(type);
  }

  bool is_on_faces(const ThermalConditionType type)
  {
    return crosses_surface(type) || type == ThermalConditionType::adiabatic;
  }

  bool are_compatible(const ThermalConditionType a, const ThermalConditionType b)
  {
    return a != b && crosses_surface(a) && crosses_surface(b);
  }

  template <int dim>
  void ThermalCondition<dim>::declare_parameters(const Entries &e)
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
  void ThermalCondition<dim>::read_radiation(const Section &section, const Section &heat)
  {
    if (!heat.is_set("Absolute zero"))
      section.fail("Type", "radiation needs absolute temperatures: `Absolute zero` of the section "
                           "`" +
                               heat.path() +
                               "` says where they begin on the scale of the other temperatures, 0 "
                               "for kelvin, -273.15 for degrees Celsius.");
    absolute_zero = heat.get_double("Absolute zero");
    stefan_boltzmann = section.get_positive("Stefan-Boltzmann constant");
    coefficient.emplace(section, "Emissivity", 0., 1., "an emissivity from 0 to 1");
    ambient.emplace(section, "Ambient temperature", absolute_zero, infinity,
                    as_text("a temperature not below absolute zero, which is ", absolute_zero));
  }

  template <int dim>
  ThermalCondition<dim> ThermalCondition<dim>::read(const Section &section, const Section &heat)
  {
    const std::optional<ThermalConditionType> type = thermal_condition_type(section);
    Assert(type, ExcMessage("This is no thermal condition."));
    for (const char *const entry : {"Axes", "Start", "End"})
      if (section.is_set(entry))
        section.fail(entry, "it is for conditions of the motion and for loads; a function of time "
                            "can have any value from some time on.");
    const bool is_source = *type == ThermalConditionType::heat_source;
    if (is_source && section.is_set("Boundary"))
      section.fail("Boundary", "a heat source is in the volume; use `Where`, or neither.");
    ThermalCondition condition{section.name(), *type, Region<dim>(section, is_source), {}, {}, {}};
    switch (*type)
    {
    case ThermalConditionType::temperature:
    case ThermalConditionType::heat_flux:
    case ThermalConditionType::heat_source:
      if (!section.is_set("Function"))
        section.fail("", "the entry \"Function\" is missing: a condition of type " +
                             in_quotes(section.get("Type")) +
                             " needs a function of x, y, z and t, or a number.");
      condition.function.emplace(section, "Function");
      break;
    case ThermalConditionType::convection:
      condition.coefficient.emplace(section, "Film coefficient", 0., infinity,
                                    "a film coefficient of zero or more");
      condition.ambient.emplace(section, "Ambient temperature");
      break;
    case ThermalConditionType::radiation:
      condition.read_radiation(section, heat);
      break;
    case ThermalConditionType::adiabatic:
      if (section.is_set("Function"))
        section.fail("Function", "no heat passes an adiabatic surface; for a given flux use `Type "
                                 "= heat flux`.");
      break;
    }
    return condition;
  }

  template <int dim>
  SurfaceHeat ThermalCondition<dim>::film_heat(const double coefficient, const double ambient,
                                               const double temperature) const
  {
    if (type == ThermalConditionType::convection)
      return {coefficient * (ambient - temperature), coefficient};
    const double factor = coefficient * stefan_boltzmann;
    const double a = ambient - absolute_zero;
    const double b = temperature - absolute_zero;
    // a^4 - b^4 without the loss of digits near equilibrium.
    return {factor * (a * a + b * b) * (a + b) * (a - b), std::max(4. * factor * b * b * b, 0.)};
  }

  template struct ThermalCondition<2>;
  template struct ThermalCondition<3>;

  /** A function at nodes at one time, evaluated once where it is the same everywhere. */
  template <int dim>
  struct ValuesAtNodes
  {
    const LimitedFunction<dim> &function;
    const NodalVector &initial_position;
    double time;
    double present = 0;
    bool is_evaluated = false;

    double operator()(const unsigned int node)
    {
      if (!is_evaluated || function.depends_on_position())
        present = function.value(point_of<dim>(initial_position.node(node)), time);
      is_evaluated = true;
      return present;
    }
  };

  template <int dim>
  ThermalConditions<dim>::ThermalConditions(const std::vector<Section> &sections,
                                            const Section &heat, const Mesh<dim> &mesh,
                                            const Nodes<dim> &nodes)
      : Base(sections, mesh, nodes, heat), selected_nodes(sections.size()),
        source_nodes(sections.size())
  {
    if (sections.empty())
      return;
    std::vector<unsigned int> n_conflicts;
    const auto select_node =
        [&](const unsigned int c, const types::global_dof_index node, const Point<dim> & /*point*/)
    { selected_nodes[c].push_back(node); };
    const auto select = [&]
    {
      this->for_each_node(nodes, select_node);
      for (std::vector<types::global_dof_index> &selected : selected_nodes)
      {
        std::sort(selected.begin(), selected.end());
        selected.erase(std::unique(selected.begin(), selected.end()), selected.end());
      }
      n_conflicts = find_faces(nodes);
    };
    this->find(sections, nodes, select);
    Utilities::MPI::sum(n_conflicts, nodes.communicator(), n_conflicts);
    refuse_conflicts(sections, n_conflicts);

    std::map<types::global_dof_index, typename Base::Constraint> constraints_by_node;
    for (unsigned int c = 0; c < conditions.size(); ++c)
    {
      std::vector<types::global_dof_index> &selected = selected_nodes[c];
      selected.erase(std::remove_if(selected.begin(), selected.end(),
                                    [&](const types::global_dof_index node)
                                    { return !nodes.owned().is_element(node); }),
                     selected.end());
      if (prescribes(conditions[c].type))
        for (const types::global_dof_index node : selected)
          Base::constraint_of(node, constraints_by_node).condition[0] = static_cast<int>(c);
    }
    for (const auto &[node, constraint] : constraints_by_node)
      constraints.push_back(constraint);
  }

  template <int dim>
  std::vector<unsigned int> ThermalConditions<dim>::find_faces(const Nodes<dim> &nodes)
  {
    std::vector<unsigned int> n_conflicts(conditions.size() * conditions.size(), 0), present;
    const auto select = [&](const auto &cell, const unsigned int f, const auto &face_nodes,
                            const std::vector<Point<dim>> &face_points)
    {
      const bool is_outer = nodes.is_outer_face(cell, f);
      present.clear();
      for (unsigned int c = 0; c < conditions.size(); ++c)
      {
        const ThermalCondition<dim> &condition = conditions[c];
        if (prescribes(condition.type))
        {
          const std::vector<types::global_dof_index> &all = selected_nodes[c];
          if (std::all_of(face_nodes.begin(), face_nodes.end(),
                          [&](const types::global_dof_index node)
                          { return std::binary_search(all.begin(), all.end(), node); }))
            present.push_back(c);
          continue;
        }
        if (!is_on_faces(condition.type) || (crosses_surface(condition.type) && !is_outer) ||
            !this->selects_face(c, cell, f))
          continue;
        present.push_back(c);
        if (crosses_surface(condition.type))
          areas.add_face(c, face_nodes);
        if (is_film(condition.type))
          for (const LimitedFunction<dim> *function :
               {&*condition.coefficient, &*condition.ambient})
            if (function->depends_on_position())
              for (const Point<dim> &point : face_points)
                function->check_start(point);
      }
      for (const unsigned int later : present)
        for (const unsigned int earlier : present)
          if (earlier < later && !are_compatible(conditions[earlier].type, conditions[later].type))
            ++n_conflicts[later * conditions.size() + earlier];
    };
    nodes.for_each_face(&Base::is_at_boundary, select);
    return n_conflicts;
  }

  template <int dim>
  void ThermalConditions<dim>::refuse_conflicts(const std::vector<Section> &sections,
                                                const std::vector<unsigned int> &n_conflicts) const
  {
    for (unsigned int later = 0; later < conditions.size(); ++later)
      for (unsigned int earlier = 0; earlier < later; ++earlier)
      {
        const unsigned int n = n_conflicts[later * conditions.size() + earlier];
        if (n == 0)
          continue;
        const bool is_twice = conditions[later].type == conditions[earlier].type;
        sections[later].fail(
            "Type", (n == 1 ? "a face" : std::to_string(n) + " faces") +
                        " of the boundary that the condition selects " + (n == 1 ? "has" : "have") +
                        " the condition \"" + conditions[earlier].name + "\" of type \"" +
                        sections[earlier].get("Type") + "\" already; " +
                        (is_twice ? "allowed is one condition of a type on a face."
                                  : "a temperature or an adiabatic surface allows no other "
                                    "condition on a face."));
      }
  }

  template <int dim>
  void ThermalConditions<dim>::set_partition(const NodePartition &partition)
  {
    Base::set_partition(partition);
    for (unsigned int c = 0; c < conditions.size(); ++c)
      if (conditions[c].type == ThermalConditionType::heat_source)
      {
        source_nodes[c].clear();
        for (const types::global_dof_index node : selected_nodes[c])
          source_nodes[c].push_back(partition.local_index(node));
      }
  }

  template <int dim>
  template <typename Action>
  void ThermalConditions<dim>::for_each_surface_node(const NodalVector &initial_position,
                                                     const NodalVector &temperature,
                                                     const double time, const bool only_films,
                                                     const Action &action) const
  {
    for (unsigned int c = 0; c < conditions.size(); ++c)
    {
      const ThermalCondition<dim> &condition = conditions[c];
      const std::vector<unsigned int> &nodes = areas.group(c).nodes;
      const std::vector<double> &area = areas.group(c).areas;
      if (condition.type == ThermalConditionType::heat_flux && !only_films)
      {
        ValuesAtNodes<dim> flux{*condition.function, initial_position, time};
        for (std::size_t k = 0; k < nodes.size(); ++k)
          action(c, nodes[k], area[k], SurfaceHeat{flux(nodes[k]), 0.});
      }
      else if (is_film(condition.type))
      {
        ValuesAtNodes<dim> coefficient{*condition.coefficient, initial_position, time};
        ValuesAtNodes<dim> ambient{*condition.ambient, initial_position, time};
        for (std::size_t k = 0; k < nodes.size(); ++k)
          action(c, nodes[k], area[k],
                 condition.film_heat(coefficient(nodes[k]), ambient(nodes[k]),
                                     temperature.node(nodes[k])[0]));
      }
    }
  }

  template <int dim>
  void ThermalConditions<dim>::add_surface_heat(const NodalVector &initial_position,
                                                const NodalVector &temperature, const double time,
                                                NodalVector &heat_rate,
                                                std::vector<double> &condition_rates) const
  {
    AssertDimension(condition_rates.size(), this->n_conditions());
    const auto add = [&](const unsigned int condition, const unsigned int node, const double area,
                         const SurfaceHeat &heat)
    {
      const double rate = heat.flux * area;
      heat_rate.node(node)[0] += rate;
      condition_rates[condition] += rate;
    };
    this->evaluate([&]()
                   { for_each_surface_node(initial_position, temperature, time, false, add); });
  }

  template <int dim>
  void ThermalConditions<dim>::add_film_action(const NodalVector &initial_position,
                                               const NodalVector &temperature, const double time,
                                               const NodalVector &field, NodalVector &result) const
  {
    const auto add =
        [&](const unsigned int, const unsigned int node, const double area, const SurfaceHeat &heat)
    { result.node(node)[0] += heat.film * area * field.node(node)[0]; };
    this->evaluate([&]()
                   { for_each_surface_node(initial_position, temperature, time, true, add); });
  }

  template <int dim>
  void ThermalConditions<dim>::add_sources(const NodalVector &initial_position,
                                           const NodalVector &initial_volume, const double time,
                                           NodalVector &heat_rate,
                                           std::vector<double> &condition_rates) const
  {
    AssertDimension(condition_rates.size(), this->n_conditions());
    const auto add = [&]()
    {
      for (unsigned int c = 0; c < conditions.size(); ++c)
      {
        if (conditions[c].type != ThermalConditionType::heat_source)
          continue;
        ValuesAtNodes<dim> source{*conditions[c].function, initial_position, time};
        for (const unsigned int node : source_nodes[c])
        {
          const double rate = source(node) * *initial_volume.node(node);
          heat_rate.node(node)[0] += rate;
          condition_rates[c] += rate;
        }
      }
    };
    this->evaluate(add);
  }

  template <int dim>
  void ThermalConditions<dim>::prescribe(const NodalVector &initial_position, const double time,
                                         NodalVector &temperature) const
  {
    const auto set = [&]()
    {
      std::vector<std::optional<ValuesAtNodes<dim>>> values(conditions.size());
      for (std::size_t k = 0; k < constraints.size(); ++k)
      {
        const unsigned int c = static_cast<unsigned int>(constraints[k].condition[0]);
        if (!values[c])
          values[c].emplace(ValuesAtNodes<dim>{*conditions[c].function, initial_position, time});
        const unsigned int node = constraint_nodes[k];
        temperature.node(node)[0] = (*values[c])(node);
      }
    };
    this->evaluate(set);
  }

  template class ThermalConditions<2>;
  template class ThermalConditions<3>;
} // namespace tombolo
