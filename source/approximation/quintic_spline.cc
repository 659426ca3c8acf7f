// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/kernel.h>
#include <tombolo/base/simd/vectorization.h>

#include <cmath>

namespace tombolo
{
  /** w(r) = (1 - |r|)₊⁵ - 6 (2/3 - |r|)₊⁵ + 15 (1/3 - |r|)₊⁵: the quintic B-spline, four times
   * continuously differentiable. */
  class QuinticSpline : public Kernel
  {
  public:
    void evaluate(const std::size_t n, const double *const r, double *const w,
                  double *const dw) const override
    {
      const auto fourth_power = [](const Lanes &x)
      {
        const Lanes square = x * x;
        return Lanes(square * square);
      };
      for (std::size_t i = 0; i < n; i += n_lanes)
      {
        const Lanes coordinate = load_lanes(r + i);
        const Lanes distance = abs(coordinate);
        const Lanes a = max(1. - distance, Lanes(0.));
        const Lanes b = max(2. / 3. - distance, Lanes(0.));
        const Lanes c = max(1. / 3. - distance, Lanes(0.));
        const Lanes a_4 = fourth_power(a);
        const Lanes b_4 = fourth_power(b);
        const Lanes c_4 = fourth_power(c);
        const Lanes slope = 30. * b_4 - 75. * c_4 - 5. * a_4;
        store_lanes(a_4 * a - 6. * (b_4 * b) + 15. * (c_4 * c), w + i);
        store_lanes(copysign(Lanes(1.), coordinate) * slope, dw + i);
      }
    }
  };

  TOMBOLO_REGISTER(Kernel, QuinticSpline, "quintic spline",
                   "Quintic B-spline, three intervals on either side; smoother, and narrower for "
                   "the same support.")
} // namespace tombolo
