// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/materials/temperature_table.h>

namespace tombolo
{
  /** The entry `Friction` of a contact, Coulomb's coefficient, over a temperature only where the
   * scene @p has_heat. Throws InputError. */
  inline TemperatureTable read_friction(const Entries &e, const std::string &documentation,
                                        const bool has_heat)
  {
    const auto friction = e.object<TemperatureTable>("Friction", "0", "", documentation);
    e.refuse(!(friction.smallest() >= 0. && friction.largest() <= 10.), "Friction",
             friction.is_constant() ? "allowed is a number from 0 to 10."
                                    : "allowed are coefficients from 0 to 10.");
    e.refuse(!friction.is_constant() && !has_heat, "Friction",
             "the scene has no temperature; allowed is one number, or materials with a section "
             "\"Heat\".");
    return friction;
  }
} // namespace tombolo
