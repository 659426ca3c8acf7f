// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/contact/contact_law.h>
#include <tombolo/materials/temperature_table.h>

#include <limits>

namespace tombolo
{
  /** The surface of a contact that is the boundary of a part. */
  constexpr const char *surface_of_part = "part";

  /** Friction and its heat, of a contact with a surface or between bodies. */
  struct FrictionSettings
  {
    TemperatureTable friction; ///< Coulomb's coefficient, over the temperature
    double shear_limit = std::numeric_limits<double>::max(); ///< of the traction [M/(L T^2)]
    bool has_heat;                                           ///< whether bodies have temperatures
    double heat_fraction = 0; ///< of the heat of friction, enters the body; zero without heat
    bool splits_by_effusivity = false; ///< instead, by √(k ρ c) of both sides

  protected:
    explicit FrictionSettings(const bool has_heat) : has_heat(has_heat) {}

    /** `Friction`, over a temperature only with heat, and `Heat fraction`. Throw InputError. */
    void read_friction(const Entries &e, const std::string &documentation);
    void read_heat_fraction(const Entries &e, const std::string &documentation);
  };

  /** The law of a contact with its coefficients, as the section of the contact sets them. */
  struct ContactSettings : FrictionSettings
  {
    /** Throws InputError. */
    ContactSettings(const Entries &e, bool has_heat = true);

    /** Whether the force along the surface is limited by the area. */
    bool limits_shear() const
    {
      return shear_limit < std::numeric_limits<double>::max() || shears_at_yield;
    }

    bool is_kinematic = false; ///< whether nodes are put onto the surface
    bool is_of_faces = false;  ///< whether faces touch, and not nodes
    ContactLaw law;            ///< of a penalty contact, with the stable time step of the bodies
    TemperatureTable tool_effusivity; ///< √(k ρ c) of the surface [M/(T^(5/2) temperature)]
    bool shears_at_yield = false; ///< instead of the limit, 1/√3 of the yield stress at the node
    double cutting_speed = 0; ///< particles twice as fast have flown off; zero: not counted [L/T]
    double radius = 0;        ///< of the balls that nodes are [L]
  };
} // namespace tombolo
