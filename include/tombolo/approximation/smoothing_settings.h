// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace tombolo
{
  class Kernel;
  class Entries;

  /** How the velocity of the particles is smoothed (doc/method.md, section 3). */
  struct SmoothingSettings
  {
    bool is_active = true; ///< false: S = Φ = I
    bool affine = false;   ///< S reproduces linear fields; gamma is not used
    double gamma = 0;      ///< S (I + γ (I - ΦS)); 0 is the smoothing of Pan et al. 2019
    /** A node whose m is at most this share of its m̂ has too little: rows in which its φ is
     * negative lose their negative values. */
    double smallest_mass_share = 0.01;

    /** The entries `Smoothing` and `Smallest smoothed mass` of the section of a formulation;
     * sharpened smoothing depends on kernel and dilation. Throws InputError. */
    static SmoothingSettings read(const Entries &e, const Kernel &kernel, double dilation);

    bool operator==(const SmoothingSettings &other) const
    {
      return is_active == other.is_active && affine == other.affine && gamma == other.gamma &&
             smallest_mass_share == other.smallest_mass_share;
    }
  };

  /** The row of Φ and of the gradient of a particle in a uniform lattice, along one axis and summed
   * over the others, for spacing one: what the smoothing does to a plane wave. */
  struct LatticeRow
  {
    std::vector<double> value;    ///< φ at the offsets -n ... n
    std::vector<double> gradient; ///< G at the offsets -n ... n

    /** µ₂ = Σ φ_j x_j² */
    double second_moment() const;
    /** τ₃ = Σ G_j x_j³ */
    double third_moment() const;
  };

  /** The strength γ of the sharpened smoothing S (I + γ (I - ΦS)), doc/method.md, section 3. */
  namespace SmoothingStrength
  {
    /** Throws InputError for a dilation that is not above one: the particle has no neighbour. */
    LatticeRow lattice_row(const Kernel &kernel, double dilation);

    /** γ = ½ [1 + (τ₃/3 - 1/12) / µ₂]: the phase error of lumped linear finite elements. */
    double fe_matched(const LatticeRow &row);

    /** γ = ½ [1 + τ₃ / (3 µ₂)]: no phase error to fourth order. */
    double phase(const LatticeRow &row);
  } // namespace SmoothingStrength
} // namespace tombolo
