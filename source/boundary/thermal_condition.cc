// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/boundary/thermal_condition.h>

#include <algorithm>
#include <array>
#include <limits>
#include <sstream>
#include <utility>

namespace tombolo
{
  using namespace dealii;

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
  } // namespace

  std::optional<ThermalConditionType> thermal_condition_type(const Section &section)
  {
    const std::string text = section.get("Type");
    for (const auto &[name, type] : type_names)
      if (text == name)
        return type;
    return {};
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
    std::ostringstream allowed;
    allowed << "a temperature not below absolute zero, which is " << absolute_zero;
    ambient.emplace(section, "Ambient temperature", absolute_zero, infinity, allowed.str());
  }

  template <int dim>
  ThermalCondition<dim> ThermalCondition<dim>::read(const Section &section, const Section &heat)
  {
    const std::optional<ThermalConditionType> type = thermal_condition_type(section);
    Assert(type, ExcMessage("This is no thermal condition."));
    const bool is_source = *type == ThermalConditionType::heat_source;
    if (is_source && section.is_set("Boundary"))
      section.fail("Boundary", "a heat source is in the volume; use `Where`, or neither.");
    ThermalCondition condition{section.name(), *type, Place<dim>(section, is_source), {}, {}, {}};
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
} // namespace tombolo
