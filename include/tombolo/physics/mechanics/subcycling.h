// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>

namespace tombolo
{
  /** About the cost of the forces of a step over the present one, if cells had the longer steps
   * that their own limits allow, 8 of the smallest at most (StepGroups); @p limit is that of the
   * scene [T]. One where no cell can. Collective. */
  template <int dim>
  double cost_with_longer_steps(const Model<dim> &model, double limit);
} // namespace tombolo
