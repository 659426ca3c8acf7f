// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/cubic_spline.h>
#include <tombolo/base/simd/vectorization.h>

#include <cmath>

namespace tombolo
{
  void CubicSpline::evaluate(const std::size_t n, const double *const r, double *const w,
                             double *const dw) const
  {
    // Truncated powers instead of pieces: no branch.
    for (std::size_t i = 0; i < n; i += n_lanes)
    {
      const Lanes coordinate = load_lanes(r + i);
      const Lanes distance = abs(coordinate);
      const Lanes outer = max(1. - distance, Lanes(0.));
      const Lanes inner = max(0.5 - distance, Lanes(0.));
      const Lanes outer_2 = outer * outer;
      const Lanes inner_2 = inner * inner;
      const Lanes slope = 12. * inner_2 - 3. * outer_2;
      store_lanes(outer_2 * outer - 4. * (inner_2 * inner), w + i);
      store_lanes(copysign(Lanes(1.), coordinate) * slope, dw + i);
    }
  }

  TOMBOLO_REGISTER(Kernel, CubicSpline, "cubic spline",
                   "Cubic B-spline, two intervals on either side; the kernel of Pan et al. 2019.")
} // namespace tombolo
