// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace dealii
{
  class ParameterHandler;
}

namespace tombolo
{
  class Kernel;
  class Entries;
  class Section;

  /** How the velocity of the particles is smoothed (doc/method.md, section 3). */
  struct SmoothingSettings
  {
    bool is_active = true; ///< false: S = Φ = I
    bool affine = false;   ///< S reproduces linear fields; gamma is not used
    double gamma = 0;      ///< S (I + γ (I - ΦS)); 0 is the smoothing of Pan et al. 2019
    /** A node whose m is at most this share of its m̂ has too little: rows in which its φ is
     * negative lose their negative values. */
    double smallest_mass_share = 0.01;

    /** The entries `Smoothing` and `Smallest smoothed mass` of the section of a formulation. */
    static void declare_parameters(const Entries &e);
    /** Their values, where sharpened smoothing depends on kernel and dilation. Throws InputError.
     */
    static SmoothingSettings read(const Section &section, const Kernel &kernel, double dilation);

    bool operator==(const SmoothingSettings &other) const
    {
      return is_active == other.is_active && affine == other.affine && gamma == other.gamma &&
             smallest_mass_share == other.smallest_mass_share;
    }
  };
} // namespace tombolo
