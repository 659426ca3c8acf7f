// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nodal_fields.h"

#include <gtest/gtest.h>

namespace tombolo
{
  namespace testing
  {
    /** That smoothing of v̂ and its adjoint, of v, are adjoint in the two masses. */
    template <int dim>
    void expect_adjoint_smoothing(const Model<dim> &model, const NodalVector &v,
                                  const NodalVector &v_hat)
    {
      Bridge &bridge = *model.bridge;
      NodalVector smoothed(model.state.partition()), interpolated(model.state.partition());
      bridge.apply_smoothing(v_hat, smoothed);
      bridge.apply_adjoint(v, interpolated);
      const double left = weighted_product(bridge.nodal_mass(), v, smoothed);
      const double right = weighted_product(bridge.mass(), interpolated, v_hat);
      const double scale = std::sqrt(weighted_product(bridge.mass(), v, v) *
                                     weighted_product(bridge.mass(), v_hat, v_hat));
      EXPECT_NEAR(left / scale, right / scale, 1e-13);
      EXPECT_GT(std::abs(left / scale), 1e-4);
    }
  } // namespace testing
} // namespace tombolo
