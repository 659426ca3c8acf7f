// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/physics/mechanics/step_estimator.h>

namespace tombolo
{
  /** The estimate of Pan et al. 2019, eq. (41), without its factor. Not a bound: at free corners of
   * particles with ν ≥ 0.3, and for dilations from 1.9, it is larger than the stable step. */
  template <int dim>
  class CourantEstimator : public StepEstimator<dim>
  {
  public:
    explicit CourantEstimator(const Section &section);
    static void declare_parameters(dealii::ParameterHandler &handler);
    StepLimit estimate(Model<dim> &model) override;
    bool is_cheap() const override;
  };
} // namespace tombolo
