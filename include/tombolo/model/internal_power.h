// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>

namespace tombolo
{
  /** The internal power of the present stresses at the present velocity, this
   * rank's share [M L^2/T^3]; @p step is the last one. Not a number on a rank with a particle that
   * is turned inside out. Changes nothing. Collective. */
  template <int dim>
  double internal_power(const Model<dim> &model, double step);

  /** The energy that a change of the model between two steps dissipates besides what it changes at
   * once, this rank's share: ½ Δt times internal_power() @p before minus that @p after. Forces of
   * before work on the first half of the step, and the points that advance over the whole of it are
   * those of after. Zero where either is not a number on any rank. Collective. */
  double energy_of_change(double before, double after, double step, MPI_Comm communicator);
} // namespace tombolo
