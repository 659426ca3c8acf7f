// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/kernel.h>

namespace tombolo
{
  /** w(r) = (1 - |r|)₊³ - 2 (1/2 - |r|)₊³: the hyperbolic spline of Yang, Liu and Peng (2014), q³ -
   * 6q + 6 and (2 - q)³ of q = 2|r| but for a factor of 8. Its second derivative is positive
   * wherever it is not zero, so that particles under pressure do not form pairs; the price is a
   * kink at r = 0. */
  class HyperbolicSpline : public Kernel
  {
  public:
    void evaluate(std::size_t n, const double *r, double *w, double *dw) const override;
    bool is_smooth_at_zero() const override;
  };
} // namespace tombolo
