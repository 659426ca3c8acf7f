// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/convex_basis.h>

#include <tombolo/base/simd/vector_math.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/numbers.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Γ, its derivative and its integral at one argument. */
    struct BasisValue
    {
      double value, slope, integral;
    };

    BasisValue convex_basis_at(const ConvexBasis basis, const double t)
    {
      switch (basis)
      {
      case ConvexBasis::exponential: {
        const double exponential = std::exp(t);
        return {exponential, exponential, exponential};
      }
      case ConvexBasis::inverse_tangent: {
        constexpr double scale = 2. / numbers::PI;
        // With 1 + atan(t) a small value at negative t would lose its sign.
        const double value = t < 0. ? scale * std::atan(-1. / t) : 1. + scale * std::atan(t);
        return {value, scale / (1. + t * t),
                t + scale * (t * std::atan(t) - 0.5 * std::log1p(t * t))};
      }
      case ConvexBasis::hyperbolic_tangent:
        break;
      }
      const double small = std::exp(-2. * std::abs(t));
      const double value = (t < 0. ? 2. * small : 2.) / (1. + small);
      return {value, value * (2. - value),
              std::log1p(small) - numbers::LN2 + (t < 0. ? 0. : 2. * t)};
    }
  } // namespace

  std::string convex_basis_selection()
  {
    return "exponential|inverse tangent|hyperbolic tangent";
  }

  ConvexBasis convex_basis_of(const std::string &name)
  {
    if (name == "exponential")
      return ConvexBasis::exponential;
    if (name == "inverse tangent")
      return ConvexBasis::inverse_tangent;
    AssertThrow(name == "hyperbolic tangent", ExcMessage("There is no basis \"" + name + "\"."));
    return ConvexBasis::hyperbolic_tangent;
  }

  void evaluate_convex_basis(const ConvexBasis basis, const std::size_t n, double *const value,
                             double *const slope, double *const integral)
  {
    if (basis == ConvexBasis::exponential)
    {
      for (std::size_t k = 0; k < n; ++k)
        value[k] = std::exp(value[k]);
      std::copy_n(value, n, slope);
      std::copy_n(value, n, integral);
      return;
    }
    for (std::size_t k = 0; k < n; ++k)
    {
      const BasisValue gamma = convex_basis_at(basis, value[k]);
      value[k] = gamma.value;
      slope[k] = gamma.slope;
      integral[k] = gamma.integral;
    }
  }
} // namespace tombolo
