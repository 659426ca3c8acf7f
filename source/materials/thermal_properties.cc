// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/thermal_properties.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace
  {
    const char *const heat_entries[] = {"Specific heat capacity", "Conductivity",
                                        "Initial temperature"};
  } // namespace

  std::shared_ptr<const ThermalProperties> ThermalProperties::read(const Section &material)
  {
    const Section section = material.subsection("Heat");
    for (const char *const entry : heat_entries)
      if (section.is_set(entry))
        return std::make_shared<const ThermalProperties>(section);
    return nullptr;
  }

  ThermalProperties::ThermalProperties(const Entries &e)
  {
    table_of_capacity = e.object<TemperatureTable>(
        "Specific heat capacity", mandatory, "L^2/(T^2 temperature)",
        "$c$ per mass: a number, or pairs `temperature: value` separated by commas.");
    e.refuse(!(table_of_capacity.smallest() > 0.), "Specific heat capacity",
             table_of_capacity.is_constant()
                 ? "allowed is a number larger than zero."
                 : "allowed are values larger than zero at all temperatures.");
    table_of_conductivity = e.object<TemperatureTable>(
        "Conductivity", mandatory, "M L/(T^3 temperature)",
        "Conductivity $k$: a number, or pairs `temperature: value` separated by commas.");
    e.refuse(!(table_of_conductivity.smallest() >= 0.), "Conductivity",
             table_of_conductivity.is_constant() ? "allowed is zero or a positive number."
                                                 : "allowed are zero and positive values.");
    start = e.number("Initial temperature", mandatory, {}, "temperature",
                     "The temperature at the start, at which the specific enthalpy is zero.");

    // The initial temperature becomes a knot: enthalpies then add up from zero, away from it.
    knot_temperature =
        table_of_capacity.is_constant() ? std::vector<double>() : table_of_capacity.temperatures();
    const auto position = std::lower_bound(knot_temperature.begin(), knot_temperature.end(), start);
    first = static_cast<std::size_t>(position - knot_temperature.begin());
    if (position == knot_temperature.end() || *position != start)
      knot_temperature.insert(position, start);
    const std::size_t n = knot_temperature.size();
    knot_capacity.resize(n);
    table_of_capacity.evaluate(static_cast<unsigned int>(n), knot_temperature.data(),
                               knot_capacity.data());
    knot_enthalpy.assign(n, 0.);
    const auto gain = [&](const std::size_t k)
    {
      return 0.5 * (knot_capacity[k] + knot_capacity[k + 1]) *
             (knot_temperature[k + 1] - knot_temperature[k]);
    };
    for (std::size_t k = first + 1; k < n; ++k)
      knot_enthalpy[k] = knot_enthalpy[k - 1] + gain(k - 1);
    for (std::size_t k = first; k-- > 0;)
      knot_enthalpy[k] = knot_enthalpy[k + 1] - gain(k);
  }

  std::size_t ThermalProperties::knot_towards_start(const std::vector<double> &knots,
                                                    const double value) const
  {
    const auto begin = knots.begin();
    if (value >= knots[first])
      return static_cast<std::size_t>(
          std::upper_bound(begin + static_cast<std::ptrdiff_t>(first), knots.end(), value) - begin -
          1);
    return static_cast<std::size_t>(
        std::lower_bound(begin, begin + static_cast<std::ptrdiff_t>(first), value) - begin);
  }

  double ThermalProperties::enthalpy(const double temperature) const
  {
    const std::size_t k = knot_towards_start(knot_temperature, temperature);
    const double distance = temperature - knot_temperature[k];
    const std::size_t beyond = distance < 0. ? k - 1 : k + 1; // wraps around below the first knot
    double capacity = knot_capacity[k];
    if (beyond < knot_temperature.size())
    {
      const double share = distance / (knot_temperature[beyond] - knot_temperature[k]);
      capacity = (1. - 0.5 * share) * knot_capacity[k] + 0.5 * share * knot_capacity[beyond];
    }
    return knot_enthalpy[k] + capacity * distance;
  }

  double ThermalProperties::temperature(const double enthalpy) const
  {
    const std::size_t k = knot_towards_start(knot_enthalpy, enthalpy);
    const double gain = enthalpy - knot_enthalpy[k];
    const std::size_t beyond = gain < 0. ? k - 1 : k + 1; // wraps around below the first knot
    double capacity = knot_capacity[k];
    if (beyond < knot_temperature.size())
    {
      // The square of the capacity is linear in the enthalpy; needed is the mean of the capacities
      // at the knot and at the point.
      const double share = gain / (knot_enthalpy[beyond] - knot_enthalpy[k]);
      const double squared = (1. - share) * knot_capacity[k] * knot_capacity[k] +
                             share * knot_capacity[beyond] * knot_capacity[beyond];
      capacity = 0.5 * (capacity + std::sqrt(squared));
    }
    return knot_temperature[k] + gain / capacity;
  }

  double ThermalProperties::temperature_after(const double temperature, const double heat) const
  {
    if (knot_capacity.size() == 1)
      return temperature + heat / knot_capacity.front();
    return this->temperature(enthalpy(temperature) + heat);
  }

  double ThermalProperties::largest_diffusivity() const
  {
    // Between knots of both this is a ratio of linear functions, which has no extremum.
    double largest = 0;
    for (const TemperatureTable *const table : {&table_of_conductivity, &table_of_capacity})
      for (const double knot : table->temperatures())
        largest =
            std::max(largest, table_of_conductivity.value(knot) / table_of_capacity.value(knot));
    return largest;
  }
} // namespace tombolo
