// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>

namespace tombolo
{
  /** The next number below with a short mantissa: what a different order of summation does to the
   * last digits of an estimate must not change the step. */
  double round_down(double step);

  /** Eq. (41) of Pan et al. 2019 without its factor: the smallest ratio of characteristic length
   * (an element's, or a particle's support) to wave speed, over the ratio of a cell that takes
   * longer steps. Not a bound of the stable step: at free
   * corners of particles with ν ≥ 0.3, and for dilations from 1.9, it is larger. Collective. */
  template <int dim>
  StepLimit courant_limit(const Model<dim> &model);
} // namespace tombolo
