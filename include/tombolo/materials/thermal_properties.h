// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/materials/temperature_table.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * How a material holds and conducts heat: section "Material: NAME/Heat". Capacity and
   * conductivity may depend on the temperature; what is conserved is the specific enthalpy
   * h(θ) = ∫ c dθ, zero at the initial temperature, which has an inverse since c is positive.
   */
  class ThermalProperties
  {
  public:
    /** Of a material; null where no section "Heat" sets anything. Throws InputError. */
    static std::shared_ptr<const ThermalProperties> read(const Section &material);

    explicit ThermalProperties(const Entries &e);

    double initial_temperature() const
    {
      return start;
    }

    /** k [M L/(T^3 temperature)]. */
    const TemperatureTable &conductivity() const
    {
      return table_of_conductivity;
    }

    /** c [L^2/(T^2 temperature)]. */
    const TemperatureTable &capacity() const
    {
      return table_of_capacity;
    }

    /** h [L^2/T^2]. */
    double enthalpy(double temperature) const;
    /** θ(h), the inverse of enthalpy(). */
    double temperature(double enthalpy) const;
    /** The temperature after @p heat per mass is added at @p temperature: θ(h(θ) + heat). */
    double temperature_after(double temperature, double heat) const;

    /** Largest k/c over all temperatures: diffusivity times density. */
    double largest_diffusivity() const;

  private:
    /** Of the interval of @p value in @p knots the end that is nearer to the start. */
    std::size_t knot_towards_start(const std::vector<double> &knots, double value) const;

    double start;
    TemperatureTable table_of_conductivity, table_of_capacity;
    // Knots of the capacity, with the initial temperature as one of them, the one called first.
    std::vector<double> knot_temperature, knot_capacity, knot_enthalpy;
    std::size_t first;
  };
} // namespace tombolo
