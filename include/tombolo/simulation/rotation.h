// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>

namespace tombolo
{
  /**
   * The speed of the outermost node of a model that spins, by the rotation that has its angular
   * momentum about its centre of mass [L/T]:
   * @verbatim
   *   |L| R / I,  I about the axis of L, R the largest distance from this axis
   * @endverbatim
   * Zero where less than half of the kinetic energy about the centre is that of this rotation.
   * Collective.
   */
  template <int dim>
  double speed_of_rim(const Model<dim> &model);
} // namespace tombolo
