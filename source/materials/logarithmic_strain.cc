// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/logarithmic_strain.h>

#include <tombolo/base/simd/unroll.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    /** A symmetric tensor: xx, yy, zz, yz, xz, xy. */
    struct Symmetric
    {
      Lanes entry[6];

      const Lanes &operator()(const unsigned int i, const unsigned int j) const
      {
        constexpr unsigned int place[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
        return entry[place[i][j]];
      }
    };

    constexpr unsigned int row[6] = {0, 1, 2, 1, 0, 0};
    constexpr unsigned int column[6] = {0, 1, 2, 2, 2, 1};

    /** a b, which is symmetric: they have the same principal directions. */
    TOMBOLO_ALWAYS_INLINE Symmetric product(const Symmetric &a, const Symmetric &b)
    {
      Symmetric result;
      TOMBOLO_UNROLL
      for (unsigned int c = 0; c < 6; ++c)
        result.entry[c] = a(row[c], 0) * b(0, column[c]) + a(row[c], 1) * b(1, column[c]) +
                          a(row[c], 2) * b(2, column[c]);
      return result;
    }

    /** a bᵀ, of which the symmetric part is the whole. */
    TOMBOLO_ALWAYS_INLINE Symmetric product_with_transposed(const Matrix3<Lanes> &a,
                                                            const Matrix3<Lanes> &b)
    {
      Symmetric result;
      TOMBOLO_UNROLL
      for (unsigned int c = 0; c < 6; ++c)
        result.entry[c] = a(row[c], 0) * b(column[c], 0) + a(row[c], 1) * b(column[c], 1) +
                          a(row[c], 2) * b(column[c], 2);
      return result;
    }

    TOMBOLO_ALWAYS_INLINE Matrix3<Lanes> product(const Matrix3<Lanes> &a, const Symmetric &b)
    {
      Matrix3<Lanes> result;
      TOMBOLO_UNROLL
      for (unsigned int i = 0; i < 3; ++i)
        TOMBOLO_UNROLL
      for (unsigned int j = 0; j < 3; ++j)
        result(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
      return result;
    }

    TOMBOLO_ALWAYS_INLINE void add_to_diagonal(Symmetric &a, const double value)
    {
      for (unsigned int d = 0; d < 3; ++d)
        a.entry[d] += value;
    }

    /** The largest entry of @p a, by lane. */
    TOMBOLO_ALWAYS_INLINE Lanes largest_entry(const Symmetric &a)
    {
      Lanes largest = abs(a.entry[0]);
      for (unsigned int c = 1; c < 6; ++c)
        largest = max(largest, abs(a.entry[c]));
      return largest;
    }

    /** Entries up to which series of the first and the second length are exact to round-off. */
    constexpr double largest_of_short_series_of_tensors = 0.005, largest_of_series = 0.04;

    /** The entries of @p from in the lanes of @p mask to @p to. */
    TOMBOLO_ALWAYS_INLINE void take_lanes(const LaneMask &mask, const Symmetric &from,
                                          Symmetric &to)
    {
      for (unsigned int c = 0; c < 6; ++c)
        where(mask, to.entry[c]) = from.entry[c];
    }

    /** A function of @p a, in each lane by the first of the three that is exact for its entries:
     * which points a lane has beside it, unused ones too, must not change a digit of it. */
    template <typename ShortSeries, typename Series, typename Function>
    TOMBOLO_ALWAYS_INLINE Symmetric by_size(const Symmetric &a, const ShortSeries &short_series,
                                            const Series &series, const Function &function)
    {
      const Lanes largest = largest_entry(a);
      const LaneMask is_small = largest < largest_of_short_series_of_tensors;
      const LaneMask is_in_series = largest < largest_of_series;
      Symmetric result = a;
      if (!all_of(is_in_series))
        result = function(a);
      if (any_of(is_in_series && !is_small))
        take_lanes(is_in_series, series(a), result);
      if (any_of(is_small))
        take_lanes(is_small, short_series(a), result);
      return result;
    }

    /** exp(x) - I = x (I + x/2 (I + x/3 (...))). */
    template <unsigned int degree>
    TOMBOLO_ALWAYS_INLINE Symmetric exponential_less_identity(const Symmetric &x)
    {
      Symmetric sum;
      for (unsigned int c = 0; c < 6; ++c)
        sum.entry[c] = x.entry[c] * (1. / degree);
      TOMBOLO_UNROLL
      for (unsigned int k = degree - 1; k > 0; --k)
      {
        add_to_diagonal(sum, 1.);
        sum = product(x, sum);
        for (unsigned int c = 0; k > 1 && c < 6; ++c)
          sum.entry[c] *= 1. / k;
      }
      return sum;
    }

    /** (2I + e)⁻¹, symmetric as e. */
    TOMBOLO_ALWAYS_INLINE Symmetric inverse_of_two_and(const Symmetric &e)
    {
      const Lanes xx = e.entry[0] + 2., yy = e.entry[1] + 2., zz = e.entry[2] + 2.;
      const Lanes &yz = e.entry[3], &xz = e.entry[4], &xy = e.entry[5];
      Symmetric result;
      result.entry[0] = yy * zz - yz * yz;
      result.entry[1] = xx * zz - xz * xz;
      result.entry[2] = xx * yy - xy * xy;
      result.entry[3] = xy * xz - xx * yz;
      result.entry[4] = xy * yz - yy * xz;
      result.entry[5] = xz * yz - zz * xy;
      const Lanes factor =
          1. / (xx * result.entry[0] + xy * result.entry[5] + xz * result.entry[4]);
      for (Lanes &entry : result.entry)
        entry *= factor;
      return result;
    }

    /** ½ ln(I + e) = atanh(z), z = e (2I + e)⁻¹, up to z^last. */
    template <unsigned int last>
    TOMBOLO_ALWAYS_INLINE Symmetric half_logarithm(const Symmetric &e)
    {
      const Symmetric z = product(e, inverse_of_two_and(e));
      const Symmetric squared = product(z, z);
      Symmetric sum;
      for (unsigned int c = 0; c < 6; ++c)
        sum.entry[c] = squared.entry[c] * (1. / last);
      TOMBOLO_UNROLL
      for (unsigned int k = last - 2; k > 1; k -= 2)
      {
        add_to_diagonal(sum, 1. / k);
        sum = product(squared, sum);
      }
      add_to_diagonal(sum, 1.);
      return product(z, sum);
    }

    /** V diag(f(λ)) Vᵀ of a = V diag(λ) Vᵀ, by Jacobi's rotations, for any entries. */
    template <typename Function>
    Symmetric function_of(const Symmetric &a, const Function &function)
    {
      Matrix3<Lanes> m, v;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
        {
          m(i, j) = a(i, j);
          v(i, j) = i == j ? 1. : 0.;
        }
      constexpr unsigned int most_sweeps = 12;
      for (unsigned int sweep = 0; sweep < most_sweeps; ++sweep)
      {
        const Lanes outside = abs(m(0, 1)) + abs(m(0, 2)) + abs(m(1, 2));
        const Lanes inside = abs(m(0, 0)) + abs(m(1, 1)) + abs(m(2, 2));
        const LaneMask is_found = outside <= 1e-17 * inside;
        if (all_of(is_found))
          break;
        for (unsigned int k = 0; k < 3; ++k)
        {
          const unsigned int p = k == 2 ? 1 : 0, q = k == 0 ? 1 : 2, r = 3 - p - q;
          const Lanes difference = m(q, q) - m(p, p), twice = 2. * m(p, q);
          const Lanes length = square_root(difference * difference + twice * twice);
          Lanes tangent = twice / (abs(difference) + length);
          where(difference < 0., tangent) = -tangent;
          where(is_found || !(length > 0.), tangent) = 0.;
          const Lanes cosine = 1. / square_root(tangent * tangent + 1.), sine = tangent * cosine;
          m(p, p) -= tangent * m(p, q);
          m(q, q) += tangent * m(p, q);
          m(p, q) = m(q, p) = 0.;
          const Lanes with_p = m(r, p), with_q = m(r, q);
          m(r, p) = m(p, r) = cosine * with_p - sine * with_q;
          m(r, q) = m(q, r) = sine * with_p + cosine * with_q;
          for (unsigned int i = 0; i < 3; ++i)
          {
            const Lanes of_p = v(i, p), of_q = v(i, q);
            v(i, p) = cosine * of_p - sine * of_q;
            v(i, q) = sine * of_p + cosine * of_q;
          }
        }
      }
      Matrix3<Lanes> scaled;
      for (unsigned int d = 0; d < 3; ++d)
      {
        alignas(64) double values[n_lanes];
        store_lanes(m(d, d), values);
        std::transform(values, values + n_lanes, values, function);
        const Lanes value = load_lanes(values);
        for (unsigned int i = 0; i < 3; ++i)
          scaled(i, d) = v(i, d) * value;
      }
      return product_with_transposed(scaled, v);
    }
  } // namespace

  MotionIncrement<Lanes> logarithmic_increment(const Matrix3<Lanes> &h,
                                               const Lanes (&elastic_strain)[6])
  {
    MotionIncrement<Lanes> motion = motion_increment(h);

    Matrix3<Lanes> to_begin;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        to_begin(i, j) = (i == j ? 1. : 0.) - h(i, j);
    Lanes det;
    const Matrix3<Lanes> f = inverse(to_begin, det);
    const Matrix3<Lanes> g = multiply(h, f); // f - I, with all its digits

    Symmetric twice, old;
    for (unsigned int c = 0; c < 6; ++c)
    {
      old.entry[c] = elastic_strain[c];
      twice.entry[c] = 2. * elastic_strain[c];
    }
    const Symmetric old_stretch = by_size(
        twice, [](const Symmetric &x) { return exponential_less_identity<6>(x); },
        [](const Symmetric &x) { return exponential_less_identity<10>(x); },
        [](const Symmetric &x)
        { return function_of(x, [](const double value) { return std::expm1(value); }); });

    // b - I = G + Gᵀ + G Gᵀ + f (b₀ - I) fᵀ, in which nothing is lost of small strains.
    Symmetric stretch = product_with_transposed(product(f, old_stretch), f);
    const Symmetric squared = product_with_transposed(g, g);
    for (unsigned int c = 0; c < 6; ++c)
      stretch.entry[c] += g(row[c], column[c]) + g(column[c], row[c]) + squared.entry[c];
    const Symmetric strain = by_size(
        stretch, [](const Symmetric &e) { return half_logarithm<7>(e); },
        [](const Symmetric &e) { return half_logarithm<15>(e); },
        [](const Symmetric &e)
        { return function_of(e, [](const double value) { return 0.5 * std::log1p(value); }); });

    rotate(motion.spin, old.entry);
    for (unsigned int c = 0; c < 6; ++c)
      motion.strain[c] = strain.entry[c] - old.entry[c];
    return motion;
  }
} // namespace tombolo
