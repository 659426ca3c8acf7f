// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/kernel.h>
#include <tombolo/base/simd/vectorization.h>

#include "text_testing.h"

#include <gtest/gtest.h>

#include <vector>

namespace
{
  using namespace tombolo;
  using tombolo::testing::contains;
  using tombolo::testing::input_error;

  /** w and dw at any coordinates, through whole Lanes. */
  struct Values
  {
    Values(const Kernel &kernel, std::vector<double> r)
    {
      r.resize(padded_to_lanes(static_cast<unsigned int>(r.size())));
      w.resize(r.size());
      dw.resize(r.size());
      kernel.evaluate(r.size(), r.data(), w.data(), dw.data());
    }
    std::vector<double> w, dw;
  };

  class EveryKernel : public ::testing::TestWithParam<std::string>
  {};

  TEST_P(EveryKernel, is_even_positive_and_decreasing_inside_and_zero_outside)
  {
    const auto kernel = make_kernel(GetParam());
    double last = 1e300;
    for (double r = 0; r < 0.999; r += 0.01)
    {
      const Values values(*kernel, {r, -r});
      EXPECT_GT(values.w[0], 0.) << "r = " << r;
      EXPECT_LT(values.w[0], last) << "r = " << r;
      EXPECT_EQ(values.w[0], values.w[1]);
      EXPECT_EQ(values.dw[0], -values.dw[1]);
      last = values.w[0];
    }
    const Values outside(*kernel, {1., -1., 1.5, -7., 1e300});
    for (unsigned int i = 0; i < 5; ++i)
    {
      EXPECT_EQ(outside.w[i], 0.);
      EXPECT_EQ(outside.dw[i], 0.);
    }
  }

  TEST_P(EveryKernel, has_the_derivative_of_its_values)
  {
    const auto kernel = make_kernel(GetParam());
    const double step = 1e-5;
    const double scale = Values(*kernel, {0.}).w[0];
    for (double r = -1.1; r <= 1.1; r += 0.0137)
    {
      const Values values(*kernel, {r, r - step, r + step});
      EXPECT_NEAR(values.dw[0], (values.w[2] - values.w[1]) / (2. * step), 1e-7 * scale)
          << "r = " << r;
    }
  }

  class EveryBSpline : public EveryKernel
  {};

  TEST_P(EveryBSpline, shifted_by_its_intervals_sums_to_a_constant)
  {
    // What makes B-splines of them: translates by one interval are a partition of unity.
    const auto kernel = make_kernel(GetParam());
    const double interval = GetParam() == "cubic spline" ? 1. / 2. : 1. / 3.;
    const auto sum = [&](const double r)
    {
      double result = 0;
      for (int k = -8; k <= 8; ++k)
        result += Values(*kernel, {r + k * interval}).w[0];
      return result;
    };
    for (double r = 0; r < 1; r += 0.071)
      EXPECT_NEAR(sum(r) / sum(0.), 1., 1e-14);
  }

  INSTANTIATE_TEST_SUITE_P(Kernels, EveryKernel,
                           ::testing::Values("cubic spline", "hyperbolic spline", "quintic spline"),
                           [](const auto &info)
                           { return info.param.substr(0, info.param.find(' ')); });
  INSTANTIATE_TEST_SUITE_P(Kernels, EveryBSpline,
                           ::testing::Values("cubic spline", "quintic spline"),
                           [](const auto &info)
                           { return info.param.substr(0, info.param.find(' ')); });

  TEST(Kernels, the_cubic_spline_falls_to_a_quarter_at_half_its_support)
  {
    const Values values(*make_kernel("cubic spline"), {0., 0.5});
    EXPECT_DOUBLE_EQ(values.w[1] / values.w[0], 0.25);
  }

  TEST(Kernels, the_hyperbolic_spline_is_convex_inside_and_alone_has_a_kink_at_zero)
  {
    const auto kernel = make_kernel("hyperbolic spline");
    double last = -1e300;
    for (double r = 0.; r < 1.; r += 0.01)
    {
      const double slope = Values(*kernel, {r}).dw[0];
      EXPECT_GT(slope, last) << "r = " << r;
      last = slope;
    }
    EXPECT_FALSE(kernel->is_smooth_at_zero());
    for (const std::string name : {"cubic spline", "quintic spline"})
      EXPECT_TRUE(make_kernel(name)->is_smooth_at_zero()) << name;
  }

  TEST(Kernels, an_unknown_name_is_refused_with_the_nearest)
  {
    EXPECT_TRUE(contains(input_error([] { make_kernel("cubic splin"); }),
                         "Did you mean \"cubic spline\"?"));
  }
} // namespace
