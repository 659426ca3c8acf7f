// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/formulation.h>

namespace tombolo
{
  /** Adds @p factor times all @p energies to @p sum. */
  inline void add_energies(const double factor, const PartEnergies &energies, PartEnergies &sum)
  {
    for (double PartEnergies::*const energy :
         {&PartEnergies::elastic, &PartEnergies::plastic, &PartEnergies::hourglass,
          &PartEnergies::viscous, &PartEnergies::thermal_work, &PartEnergies::failure,
          &PartEnergies::contact, &PartEnergies::contact_damping})
      sum.*energy += factor * (energies.*energy);
  }
} // namespace tombolo
