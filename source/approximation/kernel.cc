// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/kernel.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/simd/vectorization.h>

namespace tombolo
{
  std::unique_ptr<Kernel> read_kernel(const Entries &e, const std::string &by_default,
                                      const std::string &documentation)
  {
    auto kernel = e.plugin<Kernel>("Kernel", by_default, documentation);
    e.plugins<Kernel>(false);
    return e.declares() ? make_kernel(by_default) : std::move(kernel);
  }

  std::unique_ptr<Kernel> make_kernel(const std::string &name)
  {
    const auto &registry = Registry<Kernel>::instance();
    if (!registry.has(name))
    {
      const std::string nearest = nearest_name(name, registry.names());
      throw InputError("There is no kernel \"" + name + "\"; known are " + registry.selection() +
                       (nearest.empty() ? "." : ". Did you mean \"" + nearest + "\"?"));
    }
    const Parameters parameters(MPI_COMM_SELF);
    return registry.create(name, parameters.section(""));
  }

  namespace
  {
    /** A kernel of truncated powers of |r|, without a branch: Spline::evaluate() of distances. */
    template <typename Spline>
    class SplineKernel : public Kernel
    {
    public:
      void evaluate(const std::size_t n, const double *const r, double *const w,
                    double *const dw) const override
      {
        for (std::size_t i = 0; i < n; i += n_lanes)
        {
          const Lanes coordinate = load_lanes(r + i);
          Lanes value, slope;
          Spline::evaluate(abs(coordinate), value, slope);
          store_lanes(value, w + i);
          store_lanes(copysign(Lanes(1.), coordinate) * slope, dw + i);
        }
      }

      bool is_smooth_at_zero() const override
      {
        return Spline::is_smooth;
      }
    };

    /** w(r) = (1 - |r|)₊³ - c (1/2 - |r|)₊³. With c = 4 it is the cubic B-spline, twice
     * continuously differentiable. With c = 2 it is the hyperbolic spline of Yang, Liu and Peng
     * (2014), q³ - 6q + 6 and (2 - q)³ of q = 2|r| but for a factor of 8. Its second derivative is
     * positive wherever it is not zero, so that particles under pressure do not form pairs; the
     * price is a kink at r = 0. */
    template <int c>
    struct SplineOfCubes
    {
      static constexpr bool is_smooth = c == 4;

      static void evaluate(const Lanes &distance, Lanes &value, Lanes &slope)
      {
        const Lanes outer = max(1. - distance, Lanes(0.));
        const Lanes inner = max(0.5 - distance, Lanes(0.));
        const Lanes outer_2 = outer * outer;
        const Lanes inner_2 = inner * inner;
        slope = (3. * c) * inner_2 - 3. * outer_2;
        value = outer_2 * outer - double(c) * (inner_2 * inner);
      }
    };

    /** w(r) = (1 - |r|)₊⁵ - 6 (2/3 - |r|)₊⁵ + 15 (1/3 - |r|)₊⁵: the quintic B-spline, four times
     * continuously differentiable. */
    struct QuinticSpline
    {
      static constexpr bool is_smooth = true;

      static void evaluate(const Lanes &distance, Lanes &value, Lanes &slope)
      {
        const auto fourth_power = [](const Lanes &x)
        {
          const Lanes square = x * x;
          return Lanes(square * square);
        };
        const Lanes a = max(1. - distance, Lanes(0.));
        const Lanes b = max(2. / 3. - distance, Lanes(0.));
        const Lanes c = max(1. / 3. - distance, Lanes(0.));
        const Lanes a_4 = fourth_power(a);
        const Lanes b_4 = fourth_power(b);
        const Lanes c_4 = fourth_power(c);
        slope = 30. * b_4 - 75. * c_4 - 5. * a_4;
        value = a_4 * a - 6. * (b_4 * b) + 15. * (c_4 * c);
      }
    };
  } // namespace

  TOMBOLO_REGISTER(Kernel, SplineKernel<SplineOfCubes<4>>, "cubic spline",
                   "Cubic B-spline, two intervals on either side; the kernel of Pan et al. 2019.")
  TOMBOLO_REGISTER(Kernel, SplineKernel<SplineOfCubes<2>>, "hyperbolic spline",
                   "Cubic spline with a kink at zero, which keeps particles under pressure apart; "
                   "for smoothed particles alone.")
  TOMBOLO_REGISTER(Kernel, SplineKernel<QuinticSpline>, "quintic spline",
                   "Quintic B-spline, three intervals on either side; smoother, and narrower for "
                   "the same support.")
} // namespace tombolo
