// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/strain_measure.h>

namespace tombolo
{
  /** Declares `Strain measure` of particles, whose default follows `Smoothing`. */
  void declare_particle_strain_measure(const Entries &e);

  /** Reads it. Throws the InputError of a logarithmic measure with a smoothing by which positions
   * do not move with the velocity that strains. */
  StrainMeasure read_particle_strain_measure(const Section &section);
} // namespace tombolo
