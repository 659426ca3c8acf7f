// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include <tombolo/materials/logarithmic_strain.h>

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
  using namespace tombolo;
  using Matrix = dealii::Tensor<2, 3>;

  constexpr unsigned int row_of_component[6] = {0, 1, 2, 1, 0, 0};
  constexpr unsigned int column_of_component[6] = {0, 1, 2, 2, 2, 1};

  Matrix random_matrix(std::mt19937 &generator, const double size)
  {
    std::uniform_real_distribution<double> entry(-size, size);
    Matrix result;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        result[i][j] = entry(generator);
    return result;
  }

  Matrix unit_matrix()
  {
    return Matrix(dealii::unit_symmetric_tensor<3>());
  }

  Matrix half_logarithm(const Matrix &b)
  {
    Matrix result;
    for (const auto &[value, direction] : dealii::eigenvectors(symmetrize(b)))
      result += 0.5 * std::log(value) * outer_product(direction, direction);
    return result;
  }

  const Compliance identical(1. / 3., 0.5);

  /** The strain ε of one lane, advanced by the deformation f of a step. */
  class StrainedPoint
  {
  public:
    MotionIncrement<Lanes> advance(const Matrix &f)
    {
      const Matrix h = unit_matrix() - invert(f);
      Matrix3<Lanes> increment;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          increment(i, j) = h[i][j];
      return advance(increment);
    }

    MotionIncrement<Lanes> advance(const Matrix3<Lanes> &h)
    {
      // With these moduli the stress is the strain.
      const MotionIncrement<Lanes> motion = logarithmic_increment(h, identical, strain);
      for (unsigned int c = 0; c < 6; ++c)
        strain[c] += motion.strain[c];
      return motion;
    }

    Matrix value() const
    {
      Matrix result;
      for (unsigned int c = 0; c < 6; ++c)
        result[row_of_component[c]][column_of_component[c]] =
            result[column_of_component[c]][row_of_component[c]] = strain[c][0];
      return result;
    }

    Lanes strain[6] = {0., 0., 0., 0., 0., 0.};
  };
} // namespace

TEST(LogarithmicStrain, is_that_of_the_whole_deformation_whatever_the_steps_are)
{
  std::mt19937 generator(3);
  // Of few and large steps, up to stretches of some tenths and of some ones, and of many small.
  for (const auto &[size, n_steps] :
       {std::pair{0.3, 6u}, std::pair{1e-3, 400u}, std::pair{0.02, 60u}})
    for (unsigned int sample = 0; sample < 20; ++sample)
    {
      StrainedPoint point;
      Matrix total = unit_matrix();
      double ratio = 1.;
      for (unsigned int n = 0; n < n_steps; ++n)
      {
        Matrix f = unit_matrix() + random_matrix(generator, size);
        if (determinant(f) < 0.2)
          f = unit_matrix();
        total = f * total;
        ratio *= point.advance(f).volume_factor[0];
      }
      const Matrix expected = half_logarithm(total * transpose(total));
      EXPECT_LT((point.value() - expected).norm(), 1e-11 * (1. + expected.norm()));
      EXPECT_NEAR(ratio, determinant(total), 1e-11 * ratio);
      EXPECT_NEAR(trace(point.value()), std::log(ratio), 1e-11);
    }
}

TEST(LogarithmicStrain, comes_back_after_a_closed_cycle)
{
  std::mt19937 generator(5);
  StrainedPoint point;
  Matrix total = unit_matrix();
  for (unsigned int n = 0; n < 50; ++n)
  {
    const Matrix f = unit_matrix() + random_matrix(generator, 0.05);
    total = f * total;
    point.advance(f);
  }
  EXPECT_GT(point.value().norm(), 0.05);
  point.advance(invert(total));
  EXPECT_LT(point.value().norm(), 1e-13);
}

TEST(LogarithmicStrain, turns_with_a_rigid_rotation)
{
  StrainedPoint point;
  const double entries[3][3] = {{0.2, 0.05, -0.02}, {0.05, -0.1, 0.03}, {-0.02, 0.03, 0.4}};
  point.advance(unit_matrix() + Matrix(entries));
  const Matrix before = point.value();
  // About the axis (1, -2, 2)/3.
  const double cosine = std::cos(0.7), sine = std::sin(0.7);
  const double axis[3] = {1. / 3., -2. / 3., 2. / 3.};
  Matrix rotation = cosine * unit_matrix();
  for (unsigned int i = 0; i < 3; ++i)
    for (unsigned int j = 0; j < 3; ++j)
      rotation[i][j] += (1. - cosine) * axis[i] * axis[j];
  for (unsigned int k = 0; k < 3; ++k)
  {
    const unsigned int i = (k + 1) % 3, j = (k + 2) % 3;
    rotation[j][i] += sine * axis[k];
    rotation[i][j] -= sine * axis[k];
  }
  const MotionIncrement<Lanes> motion = point.advance(rotation);
  for (const Lanes &component : motion.strain)
    EXPECT_LT(std::abs(component[0]), 1e-14);
  EXPECT_LT((point.value() - rotation * before * transpose(rotation)).norm(), 1e-14);
}

TEST(LogarithmicStrain, has_all_digits_of_small_strains)
{
  std::mt19937 generator(7);
  for (const double size : {1e-15, 1e-12, 1e-9, 1e-6})
  {
    const Matrix h = random_matrix(generator, size);
    Matrix3<Lanes> increment;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        increment(i, j) = h[i][j];
    StrainedPoint point;
    point.advance(increment);
    // To second order ½ ln((I - h)⁻¹ (I - h)⁻ᵀ) is sym h + ½ (h h + h hᵀ + hᵀ hᵀ) - (sym h)².
    const Matrix symmetric = 0.5 * (h + transpose(h));
    const Matrix expected = symmetric +
                            0.5 * (h * h + h * transpose(h) + transpose(h) * transpose(h)) -
                            symmetric * symmetric;
    EXPECT_LT((point.value() - expected).norm(), (1e-14 + 10. * size * size) * size);
  }
}

TEST(LogarithmicStrain, no_digit_of_a_point_depends_on_those_that_are_computed_with_it)
{
  if (n_lanes == 1)
    GTEST_SKIP() << "One lane has no neighbour.";
  std::mt19937 generator(11);
  // Sizes of entries for which the function of a tensor is found in other ways.
  const double sizes[] = {1e-6, 1e-3, 0.01, 0.1, 0.6};
  for (const double own : sizes)
    for (const double other : sizes)
      for (unsigned int sample = 0; sample < 20; ++sample)
      {
        Matrix3<Lanes> alone, beside;
        Lanes strain_alone[6], strain_beside[6];
        const Matrix h = 0.3 * random_matrix(generator, own),
                     other_h = 0.3 * random_matrix(generator, other),
                     strain = random_matrix(generator, own),
                     strain_of_other = random_matrix(generator, other);
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
          {
            alone(i, j) = h[i][j];
            beside(i, j) = other_h[i][j];
            beside(i, j)[0] = h[i][j];
          }
        for (unsigned int c = 0; c < 6; ++c)
        {
          strain_alone[c] = strain[row_of_component[c]][column_of_component[c]];
          strain_beside[c] = strain_of_other[row_of_component[c]][column_of_component[c]];
          strain_beside[c][0] = strain_alone[c][0];
        }
        const MotionIncrement<Lanes> alone_increment =
            logarithmic_increment(alone, identical, strain_alone);
        const MotionIncrement<Lanes> beside_increment =
            logarithmic_increment(beside, identical, strain_beside);
        for (unsigned int c = 0; c < 6; ++c)
          ASSERT_EQ(alone_increment.strain[c][0], beside_increment.strain[c][0])
              << own << " beside " << other;
      }
}

TEST(LogarithmicStrain, short_series_have_all_digits)
{
  for (const double x : {1e-16, -1e-9, 1e-4, 2.9e-3, -2.9e-3, 3.1e-3, -0.2, 0.7})
  {
    const Lanes lanes = x;
    const double scale = std::abs(x);
    EXPECT_NEAR(exponential_less_one(lanes)[0] / scale, std::expm1(x) / scale, 1e-13);
    EXPECT_NEAR(logarithm_of_one_and(lanes)[0] / scale, std::log1p(x) / scale, 1e-13);
  }
}
