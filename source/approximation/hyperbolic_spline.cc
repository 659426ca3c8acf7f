// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/kernel.h>
#include <tombolo/base/simd/vectorization.h>

#include <cmath>

namespace tombolo
{
  /** w(r) = (1 - |r|)₊³ - 2 (1/2 - |r|)₊³: the hyperbolic spline of Yang, Liu and Peng (2014), q³ -
   * 6q + 6 and (2 - q)³ of q = 2|r| but for a factor of 8. Its second derivative is positive
   * wherever it is not zero, so that particles under pressure do not form pairs; the price is a
   * kink at r = 0. */
  class HyperbolicSpline : public Kernel
  {
  public:
    void evaluate(const std::size_t n, const double *const r, double *const w,
                  double *const dw) const override
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

    bool is_smooth_at_zero() const override
    {
      return false;
    }
  };

  TOMBOLO_REGISTER(Kernel, HyperbolicSpline, "hyperbolic spline",
                   "Cubic spline with a kink at zero, which keeps particles under pressure apart; "
                   "for smoothed particles alone.")
} // namespace tombolo
