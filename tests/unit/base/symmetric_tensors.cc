// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/symmetric_tensors.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace tombolo;

namespace
{
  constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
}

TEST(SymmetricTensors, pressure_and_von_mises_stress_are_those_of_the_components)
{
  const double stress[6] = {1, 2, -6, 4, 5, 6};
  EXPECT_DOUBLE_EQ(pressure(stress), 1.);
  EXPECT_DOUBLE_EQ(von_mises_stress(stress),
                   std::sqrt(0.5 * (1. + 64. + 49.) + 3. * (16. + 25. + 36.)));
}

TEST(SymmetricTensors, principal_values_come_the_largest_first)
{
  // In the xz plane: mean 2, shear 3; along y: 4.
  const double stress[6] = {2, 4, 2, 0, 3, 0};
  const auto values = principal_values(stress);
  EXPECT_NEAR(values[0], 5., 1e-14);
  EXPECT_NEAR(values[1], 4., 1e-14);
  EXPECT_NEAR(values[2], -1., 1e-14);
}

TEST(SymmetricTensors, principal_values_of_a_nearly_hydrostatic_stress_keep_their_digits)
{
  const double stress[6] = {1e9, 1e9, 1e9, 0, 0, 1.};
  const auto values = principal_values(stress);
  EXPECT_NEAR(values[0] - values[2], 2., 1e-6);
  EXPECT_NEAR(values[1], 1e9, 1e-6);
}

TEST(SymmetricTensors, what_is_not_finite_has_no_principal_values)
{
  const double stress[6] = {2, not_a_number, 2, 0, 3, 0};
  for (const double value : principal_values(stress))
    EXPECT_TRUE(std::isnan(value));
}

TEST(SymmetricTensors, logarithmic_strain_turns_with_the_body_and_adds_up)
{
  // Stretched by 2 along x and by 1/2 along z, then turned by 90 degrees about y: x becomes -z.
  dealii::Tensor<2, 3> stretch, turn;
  stretch[0][0] = 2.;
  stretch[1][1] = 1.;
  stretch[2][2] = 0.5;
  turn[2][0] = -1.;
  turn[1][1] = 1.;
  turn[0][2] = 1.;
  const SymmetricComponents strain = logarithmic_strain<3>(turn * stretch);
  const double expected[6] = {-std::log(2.), 0., std::log(2.), 0., 0., 0.};
  for (unsigned int c = 0; c < 6; ++c)
    EXPECT_NEAR(strain[c], expected[c], 1e-14) << c;
  const SymmetricComponents twice = logarithmic_strain<3>(stretch * stretch);
  EXPECT_NEAR(twice[0], 2. * std::log(2.), 1e-14);
}

TEST(SymmetricTensors, logarithmic_strain_of_a_small_shear_is_half_of_it)
{
  const double gamma = 1e-5;
  dealii::Tensor<2, 3> shear;
  for (unsigned int d = 0; d < 3; ++d)
    shear[d][d] = 1.;
  shear[0][2] = gamma;
  const SymmetricComponents strain = logarithmic_strain<3>(shear);
  EXPECT_NEAR(strain[4], 0.5 * gamma, 1e-10);
  EXPECT_NEAR(strain[3], 0., 1e-15);
  EXPECT_NEAR(strain[5], 0., 1e-15);
}

TEST(SymmetricTensors, logarithmic_strain_in_two_dimensions_is_plane)
{
  dealii::Tensor<2, 2> stretch;
  stretch[0][0] = 1.1;
  stretch[1][1] = 0.9;
  const SymmetricComponents strain = logarithmic_strain<2>(stretch);
  EXPECT_NEAR(strain[0], std::log(1.1), 1e-14);
  EXPECT_NEAR(strain[1], std::log(0.9), 1e-14);
  EXPECT_EQ(strain[2], 0.);
}

TEST(SymmetricTensors, a_body_that_is_turned_inside_out_has_no_logarithmic_strain)
{
  dealii::Tensor<2, 2> mirror;
  mirror[0][0] = -1.;
  mirror[1][1] = 1.;
  EXPECT_TRUE(std::isnan(logarithmic_strain<2>(mirror)[0]));
  EXPECT_TRUE(std::isnan(logarithmic_strain<2>(dealii::Tensor<2, 2>())[0]));
}
