// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>

namespace tombolo
{
  namespace internal
  {
    /** LDLᵀ factors of n_lanes symmetric matrices of n × n, one in each lane. */
    template <int n>
    struct Factors
    {
      Lanes lower[n][n]; ///< L below the diagonal
      Lanes inverse_pivot[n];
      Lanes pivot[n];

      /** @p a holds the lower triangle. */
      void factorize(const Lanes (&a)[n][n])
      {
        for (int j = 0; j < n; ++j)
        {
          Lanes scaled[n]; // L_jk D_k
          Lanes d = a[j][j];
          for (int k = 0; k < j; ++k)
          {
            scaled[k] = lower[j][k] * pivot[k];
            d -= lower[j][k] * scaled[k];
          }
          pivot[j] = d;
          inverse_pivot[j] = 1. / d;
          for (int i = j + 1; i < n; ++i)
          {
            Lanes sum = a[i][j];
            for (int k = 0; k < j; ++k)
              sum -= lower[i][k] * scaled[k];
            lower[i][j] = sum * inverse_pivot[j];
          }
        }
      }

      void solve(Lanes (&b)[n]) const
      {
        for (int i = 1; i < n; ++i)
          for (int k = 0; k < i; ++k)
            b[i] -= lower[i][k] * b[k];
        for (int i = 0; i < n; ++i)
          b[i] *= inverse_pivot[i];
        for (int i = n - 2; i >= 0; --i)
          for (int k = i + 1; k < n; ++k)
            b[i] -= lower[k][i] * b[k];
      }
    };
  } // namespace internal
} // namespace tombolo
