// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>

namespace tombolo
{
  /** What the present stresses take from the motion with the present velocity per unit time, this
   * rank's share [M L^2/T^3]; @p step is the last one. Changes nothing. Collective. */
  template <int dim>
  double internal_power(Model<dim> &model, double step);
} // namespace tombolo
