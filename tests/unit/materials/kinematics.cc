// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/kinematics.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace tombolo;

  constexpr unsigned int row[6] = {0, 1, 2, 1, 0, 0};
  constexpr unsigned int column[6] = {0, 1, 2, 2, 2, 1};

  Matrix3<double> transpose(const Matrix3<double> &a)
  {
    Matrix3<double> result;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        result(i, j) = a(j, i);
    return result;
  }

  /** The rotation by an angle about a fixed, oblique axis. */
  Matrix3<double> turned_by(const double angle)
  {
    const double axis[3] = {1. / 3., 2. / 3., 2. / 3.};
    const double cayley = 2. * std::tan(0.5 * angle);
    const double spin[3] = {cayley * axis[0], cayley * axis[1], cayley * axis[2]};
    return rotation_of(spin);
  }

  /** The sum of strain increments, turned along, of a body that is strained up to @p strain
   * (xx = -yy) in @p n_steps steps while it spins; in the axes of the body at the end. */
  Matrix3<double> strain_in_a_spinning_body(const double strain, const double angle_per_step,
                                            const unsigned int n_steps)
  {
    const auto deformation = [&](const unsigned int n)
    {
      Matrix3<double> stretch = zero_matrix<double>();
      const double now = strain * n / n_steps;
      stretch(0, 0) = 1. + now;
      stretch(1, 1) = 1. - now;
      stretch(2, 2) = 1.;
      return multiply(turned_by(n * angle_per_step), stretch);
    };
    double sum[6] = {0., 0., 0., 0., 0., 0.};
    for (unsigned int n = 1; n <= n_steps; ++n)
    {
      double determinant;
      const Matrix3<double> back = inverse(deformation(n), determinant);
      Matrix3<double> increment = multiply(deformation(n - 1), back);
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          increment(i, j) = (i == j ? 1. : 0.) - increment(i, j);
      const MotionIncrement<double> motion = motion_increment(increment);
      rotate(motion.spin, sum);
      for (unsigned int c = 0; c < 6; ++c)
        sum[c] += motion.strain[c];
    }
    Matrix3<double> tensor;
    for (unsigned int c = 0; c < 6; ++c)
      tensor(row[c], column[c]) = tensor(column[c], row[c]) = sum[c];
    const Matrix3<double> turn = turned_by(n_steps * angle_per_step);
    return multiply(transpose(turn), multiply(tensor, turn));
  }

  TEST(Kinematics, a_spinning_body_is_strained_in_the_directions_in_which_it_is_stretched)
  {
    const double strain = 1e-4;
    for (const double angle : {0.01, 0.02, 0.04})
    {
      const Matrix3<double> result = strain_in_a_spinning_body(strain, angle, 50);
      const double expected[3] = {strain, -strain, 0.};
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          // A lag of half a step would leave an error of `angle` times the strain.
          EXPECT_NEAR(result(i, j), i == j ? expected[i] : 0., (angle * angle + strain) * strain)
              << i << j << " at " << angle;
    }
  }

  TEST(Kinematics, a_rigid_rotation_leaves_no_strain_however_large)
  {
    for (const double angle : {0.01, 0.5, 2.})
    {
      Matrix3<double> increment = transpose(turned_by(angle));
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          increment(i, j) = (i == j ? 1. : 0.) - increment(i, j);
      const MotionIncrement<double> motion = motion_increment(increment);
      for (const double component : motion.strain)
        EXPECT_NEAR(component, 0., 1e-14);
      EXPECT_NEAR(motion.volume_factor, 1., 1e-14);
    }
  }
} // namespace
