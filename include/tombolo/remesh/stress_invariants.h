// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace tombolo
{
  /** Of stresses with components xx, yy, zz, yz, zx, xy. */
  namespace StressInvariants
  {
    constexpr unsigned int n_components = 6;

    /** ½ of the product of the deviators of two stresses. */
    inline double mixed(const double *const a, const double *const b)
    {
      const double mean = (a[0] + a[1] + a[2]) / 3.;
      double sum = 0;
      for (unsigned int c = 0; c < n_components; ++c)
        sum += c < 3 ? 0.5 * (a[c] - mean) * b[c] : a[c] * b[c];
      return sum;
    }

    /** ½ s:s of the deviator of a stress. */
    inline double second(const double *const stress)
    {
      const double mean = (stress[0] + stress[1] + stress[2]) / 3.;
      double sum = 0;
      for (unsigned int c = 0; c < n_components; ++c)
        sum += c < 3 ? 0.5 * (stress[c] - mean) * (stress[c] - mean) : stress[c] * stress[c];
      return sum;
    }
  } // namespace StressInvariants
} // namespace tombolo
