// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>

namespace tombolo
{
  /** What the stress of a point follows. */
  enum class StrainMeasure
  {
    rate,       ///< the rate of deformation, turned with the spin: Cauchy stress (eqs 5, 19)
    logarithmic ///< the elastic logarithmic strain: Kirchhoff stress, from an energy
  };

  /** Declares `Strain measure`, with this default. */
  void declare_strain_measure(const Entries &e, StrainMeasure by_default);

  /** Reads it. */
  StrainMeasure read_strain_measure(const Section &section);
} // namespace tombolo
