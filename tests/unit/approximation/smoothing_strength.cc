// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/smoothing_settings.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace tombolo;

  TEST(SmoothingStrength, has_the_row_of_the_paper_at_dilation_1_8)
  {
    const LatticeRow row = SmoothingStrength::lattice_row(*make_kernel("cubic spline"), 1.8);
    ASSERT_EQ(row.value.size(), 5u);
    EXPECT_NEAR(row.value[1], 0.1299, 5e-5);
    EXPECT_NEAR(row.value[2], 0.7401, 5e-5);
    EXPECT_NEAR(row.value[3], 0.1299, 5e-5);
    EXPECT_EQ(row.value[0], 0.);
    EXPECT_EQ(row.value[4], 0.);
    EXPECT_NEAR(row.gradient[1], -0.5, 1e-14);
    EXPECT_NEAR(row.gradient[2], 0., 1e-14);
    EXPECT_NEAR(row.gradient[3], 0.5, 1e-14);
    EXPECT_NEAR(row.third_moment(), 1., 1e-13);
  }

  TEST(SmoothingStrength, has_the_strengths_of_the_method_page)
  {
    const auto kernel = make_kernel("cubic spline");
    const LatticeRow wide = SmoothingStrength::lattice_row(*kernel, 1.8);
    EXPECT_NEAR(SmoothingStrength::fe_matched(wide), 0.98, 0.005);
    EXPECT_NEAR(SmoothingStrength::phase(wide), 1.14, 0.005);
    const LatticeRow narrow = SmoothingStrength::lattice_row(*kernel, 1.5);
    EXPECT_NEAR(SmoothingStrength::fe_matched(narrow), 1.47, 0.005);
  }

  /** Symbol of S (I + γ(I - ΦS)) times that of G over ik: phase speed over wave speed. */
  double phase_speed(const LatticeRow &row, const double gamma, const double k)
  {
    const int n = static_cast<int>(row.value.size() / 2);
    double s = 0, g = 0;
    for (int j = -n; j <= n; ++j)
    {
      s += row.value[static_cast<std::size_t>(j + n)] * std::cos(k * j);
      g += row.gradient[static_cast<std::size_t>(j + n)] * std::sin(k * j);
    }
    return s * (1. + gamma * (1. - s * s)) * g / k;
  }

  TEST(SmoothingStrength, matches_the_phase_error_of_finite_elements_or_removes_it)
  {
    for (const char *name : {"cubic spline", "quintic spline"})
      for (const double dilation : {1.5, 1.8, 2.3, 2.7})
      {
        const LatticeRow row = SmoothingStrength::lattice_row(*make_kernel(name), dilation);
        const double k = 0.02;
        // Lumped linear elements: sin(k/2)/(k/2) = 1 - k²/24 + ...
        EXPECT_NEAR((phase_speed(row, SmoothingStrength::fe_matched(row), k) - 1.) / (k * k),
                    -1. / 24., 1e-3)
            << name << ", dilation " << dilation;
        EXPECT_NEAR((phase_speed(row, SmoothingStrength::phase(row), k) - 1.) / (k * k), 0., 1e-3)
            << name << ", dilation " << dilation;
      }
  }

  TEST(SmoothingStrength, refuses_a_dilation_without_neighbours)
  {
    const auto kernel = make_kernel("cubic spline");
    for (const double dilation : {-1., 0., 1.})
      EXPECT_THROW(SmoothingStrength::lattice_row(*kernel, dilation), InputError);
    EXPECT_THROW(SmoothingStrength::lattice_row(*kernel, 1.0001), InputError);
  }
} // namespace
