// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/unroll.h>
#include <tombolo/base/simd/vectorization.h>

#include <array>
#include <cmath>
#include <cstddef>

namespace tombolo
{
  /** A symmetric tensor: xx, yy, zz, yz, xz, xy. */
  struct SymmetricTensor3
  {
    static constexpr unsigned int row[6] = {0, 1, 2, 1, 0, 0};
    static constexpr unsigned int column[6] = {0, 1, 2, 2, 2, 1};

    Lanes entry[6];

    const Lanes &operator()(const unsigned int i, const unsigned int j) const
    {
      constexpr unsigned int index[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
      return entry[index[i][j]];
    }
  };

  /** Forces the evaluation of @p value here. A compiler that moves a sum of products behind a
   * branch, to both sides, rounds another one of them first on each. */
  TOMBOLO_ALWAYS_INLINE void round_here([[maybe_unused]] Lanes &value)
  {
#if defined(__GNUC__) && defined(__x86_64__)
    auto in_register = internal::bit_cast<internal::LaneRegister>(value);
    asm("" : "+v"(in_register));
    value = internal::bit_cast<Lanes>(in_register);
#endif
  }

  /** A tensor with its adjugate A and its invariants, by which any polynomial of it is one of I,
   * x and A: x x = A + I₁ x - I₂ I and x A = I₃ I (Cayley-Hamilton). */
  struct TensorArgument
  {
    TOMBOLO_ALWAYS_INLINE explicit TensorArgument(const SymmetricTensor3 &x) : x(x)
    {
      const Lanes &xx = x.entry[0], &yy = x.entry[1], &zz = x.entry[2];
      const Lanes &yz = x.entry[3], &xz = x.entry[4], &xy = x.entry[5];
      adjugate.entry[0] = yy * zz - yz * yz;
      adjugate.entry[1] = xx * zz - xz * xz;
      adjugate.entry[2] = xx * yy - xy * xy;
      adjugate.entry[3] = xy * xz - xx * yz;
      adjugate.entry[4] = xy * yz - yy * xz;
      adjugate.entry[5] = xz * yz - zz * xy;
      first = xx + yy + zz;
      second = adjugate.entry[0] + adjugate.entry[1] + adjugate.entry[2];
      third = xx * adjugate.entry[0] + xy * adjugate.entry[5] + xz * adjugate.entry[4];
      round_here(third);
      TOMBOLO_UNROLL
      for (unsigned int c = 3; c < 6; ++c)
        round_here(adjugate.entry[c]);
    }

    /** Whether √(x : x) is below @p size, by lane. */
    TOMBOLO_ALWAYS_INLINE LaneMask is_below(const double size) const
    {
      return first * first - 2. * second < size * size;
    }

    /** Σ a_k x^k, k > 0, in Horner's way. */
    template <std::size_t n>
    TOMBOLO_ALWAYS_INLINE SymmetricTensor3 series(const std::array<double, n> &a) const
    {
      // Of I, x and A.
      Lanes identity_factor = a[n - 2], x_factor = a[n - 1], adjugate_factor = 0.;
      TOMBOLO_UNROLL
      for (std::size_t k = n - 2; k > 0; --k)
      {
        const Lanes next_factor = identity_factor + first * x_factor;
        identity_factor = (k == 1 ? 0. : a[k - 1]) + third * adjugate_factor - second * x_factor;
        adjugate_factor = x_factor;
        x_factor = next_factor;
      }
      SymmetricTensor3 sum;
      TOMBOLO_UNROLL
      for (unsigned int c = 0; c < 6; ++c)
      {
        sum.entry[c] = adjugate_factor * adjugate.entry[c] + (c < 3 ? identity_factor : Lanes(0.));
        sum.entry[c] += x_factor * x.entry[c];
      }
      return sum;
    }

    SymmetricTensor3 x, adjugate;
    Lanes first, second, third;
  };

  /** Of a series Σ a_k x^k, k > 0, those @p degree terms that come nearest to it, by its own size,
   * where |x| < @p radius: terms are replaced by Chebyshev's polynomials of lower degree. */
  template <std::size_t degree, std::size_t n>
  constexpr std::array<double, degree + 1> economize(std::array<double, n> a, const double radius)
  {
    // Of Σ a_k x^{k-1}, from the highest degree m on.
    for (std::size_t m = n - 2; m >= degree; --m)
    {
      double term = a[m + 1];
      for (std::size_t k = m; k >= 2; k -= 2)
      {
        term *= -radius * radius * double(k * (k - 1)) / double((m - k + 2) * (m + k - 2));
        a[k - 1] -= term;
      }
    }
    std::array<double, degree + 1> result = {};
    for (std::size_t k = 1; k <= degree; ++k)
      result[k] = a[k];
    return result;
  }

  /** Coefficients of exp(-2x). */
  constexpr std::array<double, 15> inverse_stretch_series()
  {
    std::array<double, 15> a = {{1.}};
    for (std::size_t k = 1; k < a.size(); ++k)
      a[k] = a[k - 1] * (-2. / double(k));
    return a;
  }

  /** Coefficients of -½ ln(1 + x). */
  constexpr std::array<double, 31> strain_series()
  {
    std::array<double, 31> a = {};
    for (std::size_t k = 1; k < a.size(); ++k)
      a[k] = (k % 2 == 0 ? 0.5 : -0.5) / double(k);
    return a;
  }

  /** exp(-2x) - 1: two series, exact to round-off up to some √(x : x), and of a number. */
  struct InverseStretch
  {
    static double scalar_value(const double x)
    {
      return std::expm1(-2. * x);
    }

    static constexpr double largest_of_short = 0.015, largest_of_long = 0.15;
    static constexpr std::array<double, 8> short_series =
        economize<7>(inverse_stretch_series(), largest_of_short);
    static constexpr std::array<double, 15> long_series = inverse_stretch_series();
  };

  /** Its inverse, -½ ln(1 + x). */
  struct StrainOfInverseStretch
  {
    static double scalar_value(const double x)
    {
      return -0.5 * std::log1p(x);
    }

    static constexpr double largest_of_short = 0.03, largest_of_long = 0.3;
    static constexpr std::array<double, 10> short_series =
        economize<9>(strain_series(), largest_of_short);
    static constexpr std::array<double, 31> long_series = strain_series();
  };

  /** A function of a tensor, in each lane by a series or by principal values, as its own size
   * requires: other lanes, unused ones too, must not change a digit of it. */
  template <typename Function>
  SymmetricTensor3 function_by_size(const TensorArgument &argument, const LaneMask &is_small);

  /** The same, without that distinction where the tensors of all lanes are small. */
  template <typename Function>
  TOMBOLO_ALWAYS_INLINE SymmetricTensor3 function_of(const SymmetricTensor3 &x)
  {
    const TensorArgument argument(x);
    const LaneMask is_small = argument.is_below(Function::largest_of_short);
    if (all_of(is_small))
      return argument.series(Function::short_series);
    const TensorArgument in_memory = argument;
    return function_by_size<Function>(in_memory, is_small);
  }
} // namespace tombolo
