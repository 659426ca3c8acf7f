// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <tombolo/base/input/parameters.h>
#include <tombolo/contact/contact_law.h>
#include <tombolo/materials/temperature_table.h>

namespace tombolo
{
  /** The law of a contact with its coefficients, as the section of the contact gives them. */
  struct ContactSettings
  {
    static void declare_parameters(dealii::ParameterHandler &handler);

    /** Throws InputError. */
    ContactSettings(const Section &section, bool has_heat);

    bool is_kinematic = false; ///< whether nodes are put onto the surface
    bool is_of_faces = false;  ///< whether faces touch, and not nodes
    ContactLaw law;            ///< of a penalty contact, with the stable time step of the bodies
    TemperatureTable friction; ///< Coulomb's coefficient, over the temperature of the node
    bool has_heat;             ///< whether bodies have temperatures
    double heat_fraction = 0;  ///< of the heat of friction, enters the body; zero without heat
  };
} // namespace tombolo
