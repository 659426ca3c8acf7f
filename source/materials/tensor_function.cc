// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/kinematics.h>
#include <tombolo/materials/tensor_function.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    /** V diag(f(λ)) Vᵀ of a = V diag(λ) Vᵀ, by Jacobi's rotations, for any entries. */
    SymmetricTensor3 by_principal_values(const SymmetricTensor3 &a,
                                         double (*const function)(double))
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
            const Lanes old_p = v(i, p), old_q = v(i, q);
            v(i, p) = cosine * old_p - sine * old_q;
            v(i, q) = sine * old_p + cosine * old_q;
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
      SymmetricTensor3 result;
      for (unsigned int c = 0; c < 6; ++c)
        result.entry[c] = scaled(SymmetricTensor3::row[c], 0) * v(SymmetricTensor3::column[c], 0) +
                          scaled(SymmetricTensor3::row[c], 1) * v(SymmetricTensor3::column[c], 1) +
                          scaled(SymmetricTensor3::row[c], 2) * v(SymmetricTensor3::column[c], 2);
      return result;
    }

    /** The entries of @p from in the lanes of @p mask to @p to. */
    void assign_lanes(const LaneMask &mask, const SymmetricTensor3 &from, SymmetricTensor3 &to)
    {
      for (unsigned int c = 0; c < 6; ++c)
        where(mask, to.entry[c]) = from.entry[c];
    }
  } // namespace

  template <typename Function>
  SymmetricTensor3 function_by_size(const TensorArgument &argument, const LaneMask &is_small)
  {
    const LaneMask is_in_series = argument.is_below(Function::largest_of_long);
    SymmetricTensor3 result = argument.series(Function::long_series);
    if (!all_of(is_in_series || is_small))
      assign_lanes(!is_in_series, by_principal_values(argument.x, Function::scalar_value), result);
    assign_lanes(is_small, argument.series(Function::short_series), result);
    return result;
  }

  template SymmetricTensor3 function_by_size<InverseStretch>(const TensorArgument &,
                                                             const LaneMask &);
  template SymmetricTensor3 function_by_size<StrainOfInverseStretch>(const TensorArgument &,
                                                                     const LaneMask &);
} // namespace tombolo
