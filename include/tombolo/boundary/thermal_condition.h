// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/boundary/limited_function.h>
#include <tombolo/boundary/region.h>

#include <optional>
#include <string>

namespace tombolo
{
  enum class ThermalConditionType
  {
    temperature,
    heat_flux,
    convection,
    radiation,
    adiabatic,
    heat_source
  };

  /** By the entry `Type`; none of a condition of another kind. */
  std::optional<ThermalConditionType> thermal_condition_type(const Section &section);

  /** Whether what enters depends on the temperature of the surface. */
  bool is_film(ThermalConditionType type);

  /** Whether it gives heat to the surface. */
  bool crosses_surface(ThermalConditionType type);

  /** Whether it acts on faces of the boundary, not on nodes. */
  bool is_on_faces(ThermalConditionType type);

  /** Whether both can be on one face. */
  bool are_compatible(ThermalConditionType a, ThermalConditionType b);

  /** What enters the body through a surface. */
  struct SurfaceHeat
  {
    double flux; ///< per area and time [M/T^3]
    double film; ///< the derivative of minus that by the temperature, not less than zero
  };

  /** What one section "Condition: NAME" of heat says. */
  template <int dim>
  struct ThermalCondition
  {
    std::string name;
    ThermalConditionType type;
    Place<dim> place;
    std::optional<LimitedFunction<dim>> function;    ///< temperature, flux or source
    std::optional<LimitedFunction<dim>> coefficient; ///< film coefficient or emissivity
    std::optional<LimitedFunction<dim>> ambient;     ///< temperature
    double stefan_boltzmann = 0;
    double absolute_zero = 0;

    /** Reads what the type needs and nothing else. @p heat has the absolute zero. Throws
     * InputError. */
    static ThermalCondition read(const Section &section, const Section &heat);

    /** Of convection, h (θ_a - θ), and radiation, ε σ ((θ_a - θ_0)^4 - (θ - θ_0)^4), where @p
     * coefficient is h or ε. */
    SurfaceHeat film_heat(double coefficient, double ambient, double temperature) const;

  private:
    void read_radiation(const Section &section, const Section &heat);
  };
} // namespace tombolo
