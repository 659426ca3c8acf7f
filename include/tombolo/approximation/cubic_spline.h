// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/kernel.h>

namespace tombolo
{
  /** w(r) = (1 - |r|)₊³ - 4 (1/2 - |r|)₊³: the cubic B-spline, twice continuously differentiable.
   */
  class CubicSpline : public Kernel
  {
  public:
    void evaluate(std::size_t n, const double *r, double *w, double *dw) const override;
  };
} // namespace tombolo
