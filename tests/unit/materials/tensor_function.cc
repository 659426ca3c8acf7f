// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include <tombolo/materials/logarithmic_strain.h>
#include <tombolo/materials/tensor_function.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace
{
  using namespace tombolo;
  using Real = long double;
  using Matrix = std::array<std::array<Real, 3>, 3>;

  Matrix sum(const Matrix &a, const Real factor, const Matrix &b)
  {
    Matrix result = a;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        result[i][j] += factor * b[i][j];
    return result;
  }

  Matrix product(const Matrix &a, const Matrix &b)
  {
    Matrix result = {};
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        for (unsigned int k = 0; k < 3; ++k)
          result[i][j] += a[i][k] * b[k][j];
    return result;
  }

  Matrix transposed(const Matrix &a)
  {
    Matrix result;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        result[i][j] = a[j][i];
    return result;
  }

  Real size_of(const Matrix &a)
  {
    Real squared = 0;
    for (const auto &row : a)
      for (const Real entry : row)
        squared += entry * entry;
    return std::sqrt(squared);
  }

  Matrix identity_matrix()
  {
    return {{{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}}};
  }

  /** Σ a_k x^k of as many terms as have an effect. */
  template <typename Coefficient>
  Matrix series(const Matrix &x, const Coefficient &coefficient)
  {
    Matrix result = {}, power = x;
    for (unsigned int k = 1; k < 400; ++k, power = product(power, x))
      result = sum(result, coefficient(k), power);
    return result;
  }

  Matrix inverse_stretch(const Matrix &x)
  {
    Real coefficient = 1;
    return series(x, [&](const unsigned int k) { return coefficient *= -2 / Real(k); });
  }

  Matrix strain_of_inverse_stretch(const Matrix &x)
  {
    return series(x, [](const unsigned int k) { return (k % 2 == 0 ? 1 : -1) / Real(2 * k); });
  }

  Matrix random_matrix(std::mt19937 &generator, const Real size)
  {
    std::uniform_real_distribution<double> entry(-1., 1.);
    Matrix result;
    for (auto &row : result)
      for (Real &value : row)
        value = entry(generator);
    return sum({}, size / size_of(result), result);
  }

  /** With doubles for entries. */
  Matrix random_symmetric(std::mt19937 &generator, const Real size)
  {
    Matrix result = random_matrix(generator, 1);
    result = sum(result, 1, transposed(result));
    result = sum({}, size / size_of(result), result);
    for (auto &row : result)
      for (Real &value : row)
        value = double(value);
    return result;
  }

  SymmetricTensor3 in_lanes(const Matrix &a)
  {
    SymmetricTensor3 result;
    for (unsigned int c = 0; c < 6; ++c)
      result.entry[c] = double(a[SymmetricTensor3::row[c]][SymmetricTensor3::column[c]]);
    return result;
  }

  Matrix first_lane(const Lanes (&a)[6])
  {
    Matrix result;
    for (unsigned int c = 0; c < 6; ++c)
    {
      const unsigned int i = SymmetricTensor3::row[c], j = SymmetricTensor3::column[c];
      result[i][j] = result[j][i] = a[c][0];
    }
    return result;
  }

  /** Largest error over the size, of random tensors of this size. */
  template <typename Function, typename Reference>
  double error(const double size, const Reference &reference)
  {
    std::mt19937 generator(3);
    Real largest = 0;
    for (unsigned int sample = 0; sample < 200; ++sample)
    {
      const Matrix x = random_symmetric(generator, size);
      const Matrix found = first_lane(function_of<Function>(in_lanes(x)).entry);
      largest = std::max(largest, size_of(sum(found, -1, reference(x))) / size);
    }
    return double(largest);
  }
} // namespace

TEST(TensorFunction, is_exact_to_round_off_on_both_sides_of_the_ends_of_series)
{
  const auto check = [](auto function, const auto &reference, const double tolerance)
  {
    using Function = decltype(function);
    for (const double size :
         {1e-12, 1e-3, 0.999 * Function::largest_of_short, 1.001 * Function::largest_of_short,
          0.5 * Function::largest_of_long, 0.999 * Function::largest_of_long,
          1.001 * Function::largest_of_long, 2. * Function::largest_of_long})
      EXPECT_LT(error<Function>(size, reference), tolerance) << size;
  };
  check(InverseStretch(), inverse_stretch, 4e-15);
  check(StrainOfInverseStretch(), strain_of_inverse_stretch, 4e-15);
}

TEST(TensorFunction, makes_increments_of_strains_and_rotations)
{
  std::mt19937 generator(5);
  for (const double strain_size : {1e-6, 0.01, 0.0149, 0.0151, 0.1, 0.149, 0.151})
    for (const double increment_size : {1e-6, 1e-3, 0.05})
      for (unsigned int sample = 0; sample < 50; ++sample)
      {
        const Matrix strain = random_symmetric(generator, strain_size);
        Matrix3<Lanes> h;
        Matrix to_begin = identity_matrix();
        const Matrix increment = random_matrix(generator, increment_size);
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
          {
            h(i, j) = double(increment[i][j]);
            to_begin[i][j] -= double(increment[i][j]);
          }
        // With these moduli the stress is the strain.
        Lanes turned[6];
        std::copy_n(in_lanes(strain).entry, 6, turned);
        const MotionIncrement<Lanes> motion =
            logarithmic_increment(h, Compliance(1. / 3., 0.5), turned);
        const MotionIncrement<Lanes> rate_increment = motion_increment(h);
        for (unsigned int i = 0; i < 3; ++i)
          EXPECT_NEAR(motion.spin[i][0], rate_increment.spin[i][0], 1e-15 * increment_size);
        EXPECT_NEAR(motion.volume_factor[0], rate_increment.volume_factor[0], 1e-15);

        const Matrix stretch = sum(identity_matrix(), 1, inverse_stretch(strain));
        const Matrix expected = strain_of_inverse_stretch(
            sum(product(transposed(to_begin), product(stretch, to_begin)), -1, identity_matrix()));
        const Matrix found = sum(first_lane(motion.strain), 1, first_lane(turned));
        EXPECT_LT(size_of(sum(found, -1, expected)),
                  2e-15 * (strain_size + increment_size) + 1e-18);

        Real spin[3];
        for (unsigned int i = 0; i < 3; ++i)
          spin[i] = motion.spin[i][0];
        const Matrix3<Real> spin_rotation = rotation_of(spin);
        Matrix rotation;
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            rotation[i][j] = spin_rotation(i, j);
        EXPECT_LT(size_of(sum(first_lane(turned), -1,
                              product(rotation, product(strain, transposed(rotation))))),
                  2e-15 * strain_size);
      }
}
