// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/contact/contact_settings.h>

#include <algorithm>
#include <optional>

namespace tombolo
{
  /** The entries of a section "Body contact: NAME", without those that choose the faces. */
  struct MortarSettings : FrictionSettings
  {
    /** Throws InputError. */
    MortarSettings(const Entries &e, bool has_heat = true);

    /** Whether heat passes from one body to the other. */
    bool conducts() const
    {
      return conductance.largest() > 0.;
    }

    /** Whether the temperatures of the surfaces are needed. */
    bool needs_temperature() const
    {
      return conducts() || bonding_temperature || !friction.is_constant() || splits_by_effusivity;
    }

    /** The largest traction along the surface at a pressure and a mean temperature of both sides:
     * Coulomb's, and the limit of shear [M/(L T^2)]. */
    double largest_traction(const double pressure, const double temperature) const
    {
      return std::min(friction.value(temperature) * pressure, shear_limit);
    }

    bool is_tied = false;
    bool resolves_overlap = false; ///< the overlap at the start is without force
    double stiffness;              ///< α: of the mass over the square of the stable step
    ContactLaw law;                ///< with dampers
    ContactLaw bond;               ///< the same springs without
    TemperatureTable conductance;  ///< h over the pressure [M/(T^3 K)]
    std::optional<double> bonding_temperature;
  };
} // namespace tombolo
