// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/kernel.h>

namespace tombolo
{
  /** w(r) = (1 - |r|)₊⁵ - 6 (2/3 - |r|)₊⁵ + 15 (1/3 - |r|)₊⁵: the quintic B-spline, four times
   * continuously differentiable. */
  class QuinticSpline : public Kernel
  {
  public:
    void evaluate(std::size_t n, const double *r, double *w, double *dw) const override;
  };
} // namespace tombolo
