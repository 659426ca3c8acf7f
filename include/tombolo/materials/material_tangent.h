// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/material.h>

namespace tombolo
{
  /** Sets the tangent of isotropic elasticity at point @p i. */
  inline void set_elastic_tangent(const double bulk, const double shear, const unsigned int i,
                                  const MaterialTangent &tangent)
  {
    for (unsigned int row = 0; row < 6; ++row)
      for (unsigned int column = 0; column < 6; ++column)
        tangent[6 * row + column][i] = (row == column ? 2. * shear : 0.) +
                                       (row < 3 && column < 3 ? bulk - 2. / 3. * shear : 0.);
  }
} // namespace tombolo
