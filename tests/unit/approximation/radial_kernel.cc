// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/radial_rows.h>
#include <tombolo/base/simd/vectorization.h>

#include <deal.II/base/numbers.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace
{
  using namespace tombolo;

  /** W and dW/dr at any distances, through whole Lanes. */
  template <int dim>
  struct RadialValues
  {
    RadialValues(const RadialKernel<dim> &kernel, std::vector<double> r)
    {
      r.resize(padded_to_lanes(static_cast<unsigned int>(r.size())));
      value.resize(r.size());
      slope.resize(r.size());
      kernel.evaluate(r.size(), r.data(), value.data(), slope.data());
    }
    std::vector<double> value, slope;
  };

  /** ∫ W dx by Simpson's rule, exact for the pieces of splines up to the cubic ones. */
  template <int dim>
  double integral(const RadialKernel<dim> &kernel)
  {
    constexpr unsigned int n = 6000;
    const double step = kernel.support() / n;
    std::vector<double> r;
    for (unsigned int i = 0; i <= n; ++i)
      r.push_back(i * step);
    const RadialValues<dim> values(kernel, r);
    double sum = 0;
    for (unsigned int i = 0; i <= n; ++i)
      sum += (i == 0 || i == n ? 1.
              : i % 2 == 1     ? 4.
                               : 2.) *
             values.value[i] * std::pow(r[i], dim - 1);
    return 2. * (dim - 1) * dealii::numbers::PI * sum * step / 3.;
  }

  class EveryRadialKernel : public ::testing::TestWithParam<std::string>
  {};

  TEST_P(EveryRadialKernel, integrates_to_one)
  {
    for (const double h : {1., 0.0371})
    {
      EXPECT_NEAR(integral(RadialKernel<2>(make_kernel(GetParam()), h)), 1., 1e-12);
      EXPECT_NEAR(integral(RadialKernel<3>(make_kernel(GetParam()), h)), 1., 1e-12);
    }
  }

  TEST_P(EveryRadialKernel, has_the_slope_of_its_values_and_ends_at_its_support)
  {
    const double h = 0.4, step = 1e-6;
    const RadialKernel<3> kernel(make_kernel(GetParam()), h);
    EXPECT_EQ(kernel.support(), 2. * h);
    const double scale = std::pow(h, -4);
    for (double r = 0.013; r < 0.9; r += 0.0171)
    {
      const RadialValues<3> values(kernel, {r, r - step, r + step});
      EXPECT_NEAR(values.slope[0], (values.value[2] - values.value[1]) / (2. * step), 1e-7 * scale)
          << "r = " << r;
    }
    const RadialValues<3> outside(kernel, {0.8, 0.8000001, 3.});
    for (unsigned int i = 0; i < 3; ++i)
    {
      EXPECT_EQ(outside.value[i], 0.);
      EXPECT_EQ(outside.slope[i], 0.);
    }
  }

  INSTANTIATE_TEST_SUITE_P(Kernels, EveryRadialKernel,
                           ::testing::Values("cubic spline", "hyperbolic spline", "quintic spline"),
                           [](const auto &info)
                           { return info.param.substr(0, info.param.find(' ')); });

  TEST(RadialKernels, the_hyperbolic_one_has_the_values_of_its_authors)
  {
    // W = α (q³ - 6q + 6), α (2 - q)³ of q = r/h, with α = 1/(3πh²) and 15/(62πh³); slopes on both
    // sides of q = 1 are -3α/h.
    const double h = 0.7, pi = dealii::numbers::PI;
    const auto expect = [&](const auto &values, const double alpha)
    {
      EXPECT_NEAR(values.value[0], 6. * alpha, 1e-12 * alpha);
      EXPECT_NEAR(values.value[1], alpha * (0.125 - 3. + 6.), 1e-12 * alpha);
      EXPECT_NEAR(values.value[2], alpha, 1e-7 * alpha);
      EXPECT_NEAR(values.value[3], alpha, 1e-7 * alpha);
      EXPECT_NEAR(values.value[4], 0.125 * alpha, 1e-12 * alpha);
      EXPECT_NEAR(values.slope[0], -6. * alpha / h, 1e-12 * alpha / h);
      EXPECT_NEAR(values.slope[2], -3. * alpha / h, 1e-7 * alpha / h);
      EXPECT_NEAR(values.slope[3], -3. * alpha / h, 1e-7 * alpha / h);
      EXPECT_NEAR(values.slope[4], -0.75 * alpha / h, 1e-12 * alpha / h);
    };
    const std::vector<double> r = {0., 0.5 * h, h * (1. - 1e-9), h * (1. + 1e-9), 1.5 * h};
    expect(RadialValues<2>(RadialKernel<2>(make_kernel("hyperbolic spline"), h), r),
           1. / (3. * pi * h * h));
    expect(RadialValues<3>(RadialKernel<3>(make_kernel("hyperbolic spline"), h), r),
           15. / (62. * pi * h * h * h));
  }
} // namespace
