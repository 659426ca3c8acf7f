// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/hyperbolic_spline.h>
#include <tombolo/base/simd/vectorization.h>

#include <cmath>

namespace tombolo
{
  void HyperbolicSpline::evaluate(const std::size_t n, const double *const r, double *const w,
                                  double *const dw) const
  {
    for (std::size_t i = 0; i < n; i += n_lanes)
    {
      const Lanes coordinate = load_lanes(r + i);
      const Lanes distance = abs(coordinate);
      const Lanes outer = max(1. - distance, Lanes(0.));
      const Lanes inner = max(0.5 - distance, Lanes(0.));
      const Lanes outer_2 = outer * outer;
      const Lanes inner_2 = inner * inner;
      const Lanes slope = 6. * inner_2 - 3. * outer_2;
      store_lanes(outer_2 * outer - 2. * (inner_2 * inner), w + i);
      store_lanes(copysign(Lanes(1.), coordinate) * slope, dw + i);
    }
  }

  bool HyperbolicSpline::is_smooth_at_zero() const
  {
    return false;
  }

  TOMBOLO_REGISTER(Kernel, HyperbolicSpline, "hyperbolic spline",
                   "Cubic spline with a kink at zero, which keeps particles under pressure apart; "
                   "for smoothed particles alone.")
} // namespace tombolo
