// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/rigid_rotation.h>

#include <cmath>
#include <limits>

namespace tombolo
{
  using namespace dealii;

  namespace rigid_rotation
  {
    namespace
    {
      /** sin φ/φ, (1 - cos φ)/φ², and the derivatives of both by φ over φ. */
      struct RotationFactors
      {
        double sine, versine, slope_of_sine, slope_of_versine;

        explicit RotationFactors(const double angle)
        {
          const double square = angle * angle;
          if (square < 1e-6) // the next terms are below round-off
          {
            sine = 1. - square / 6. * (1. - square / 20.);
            versine = 0.5 - square / 24. * (1. - square / 30.);
            slope_of_sine = -1. / 3. + square / 30.;
            slope_of_versine = -1. / 12. + square / 180.;
            return;
          }
          const double half = std::sin(0.5 * angle);
          sine = std::sin(angle) / angle;
          versine = 2. * half * half / square;
          slope_of_sine = (std::cos(angle) - sine) / square;
          slope_of_versine = (sine - 2. * versine) / square;
        }
      };
    } // namespace

    Matrix cross_matrix(const Vector &vector)
    {
      Matrix result;
      result[0][1] = -vector[2];
      result[0][2] = vector[1];
      result[1][0] = vector[2];
      result[1][2] = -vector[0];
      result[2][0] = -vector[1];
      result[2][1] = vector[0];
      return result;
    }

    Matrix exponential_less_one(const Vector &rotation)
    {
      const RotationFactors factors(rotation.norm());
      const Matrix cross = cross_matrix(rotation);
      return factors.sine * cross + factors.versine * (cross * cross);
    }

    Matrix exponential(const Vector &rotation)
    {
      Matrix result = exponential_less_one(rotation);
      for (unsigned int d = 0; d < 3; ++d)
        result[d][d] += 1.;
      return result;
    }

    Quaternion turned(const Quaternion &first, const Vector &then)
    {
      const double half = 0.5 * then.norm();
      const double cosine = std::cos(half), share = 0.5 * RotationFactors(half).sine;
      Vector u, w;
      for (unsigned int d = 0; d < 3; ++d)
      {
        u[d] = first[1 + d];
        w[d] = share * then[d];
      }
      const Vector vector = first[0] * w + cosine * u + cross_product_3d(u, w);
      Quaternion result{{first[0] * cosine - u * w, vector[0], vector[1], vector[2]}};
      double square = 0;
      for (const double component : result)
        square += component * component;
      for (double &component : result)
        component /= std::sqrt(square);
      return result;
    }

    Matrix matrix_of(const Quaternion &quaternion)
    {
      Vector vector;
      for (unsigned int d = 0; d < 3; ++d)
        vector[d] = quaternion[1 + d];
      const Matrix cross = cross_matrix(vector);
      Matrix result = 2. * quaternion[0] * cross + 2. * (cross * cross);
      for (unsigned int d = 0; d < 3; ++d)
        result[d][d] += 1.;
      return result;
    }

    Vector rotation_vector(const Quaternion &quaternion)
    {
      Vector vector;
      for (unsigned int d = 0; d < 3; ++d)
        vector[d] = quaternion[0] < 0. ? -quaternion[1 + d] : quaternion[1 + d];
      const double sine = vector.norm();
      return sine > 0. ? 2. * std::atan2(sine, std::abs(quaternion[0])) / sine * vector : Vector();
    }

    Vector discrete_momentum(const Matrix &inertia, const Vector &rotation)
    {
      const RotationFactors factors(rotation.norm());
      const Vector product = inertia * rotation;
      return factors.sine * product + factors.versine * cross_product_3d(rotation, product);
    }

    bool find_rotation(const Matrix &inertia, const Vector &momentum, Vector &rotation)
    {
      constexpr unsigned int most_iterations = 40;
      constexpr double tolerance = 1e-12;
      const double size = momentum.norm();
      rotation = invert(inertia) * momentum;
      double last = std::numeric_limits<double>::max();
      for (unsigned int iteration = 0; iteration < most_iterations; ++iteration)
      {
        const Vector residual = momentum - discrete_momentum(inertia, rotation);
        const double now = residual.norm();
        if (!std::isfinite(now))
          return false;
        // The last digits are reached where the residual falls no more.
        if (now == 0. || (now <= tolerance * size && now >= 0.25 * last))
          return rotation.norm() < numbers::PI;
        last = now;
        const RotationFactors factors(rotation.norm());
        const Vector product = inertia * rotation, gyroscopic = cross_product_3d(rotation, product);
        const Matrix derivative =
            factors.sine * inertia +
            outer_product(factors.slope_of_sine * product + factors.slope_of_versine * gyroscopic,
                          rotation) +
            factors.versine * (cross_matrix(rotation) * inertia - cross_matrix(product));
        rotation += invert(derivative) * residual;
      }
      return false;
    }
  } // namespace rigid_rotation
} // namespace tombolo
