// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace tombolo
{
  /** How the velocity of the particles is smoothed (doc/method.md, section 3). */
  struct SmoothingSettings
  {
    bool is_active = true; ///< false: S = Φ = I
    bool affine = false;   ///< S reproduces linear fields; gamma is not used
    double gamma = 0;      ///< S (I + γ (I - ΦS)); 0 is the smoothing of Pan et al. 2019

    bool operator==(const SmoothingSettings &other) const
    {
      return is_active == other.is_active && affine == other.affine && gamma == other.gamma;
    }
  };
} // namespace tombolo
