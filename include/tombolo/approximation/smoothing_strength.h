// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/kernel.h>

#include <vector>

namespace tombolo
{
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
    /** Throws InputError for a dilation that is not above one: the particle sees no other. */
    LatticeRow lattice_row(const Kernel &kernel, double dilation);

    /** γ = ½ [1 + (τ₃/3 - 1/12) / µ₂]: the phase error of lumped linear finite elements. */
    double fe_matched(const LatticeRow &row);

    /** γ = ½ [1 + τ₃ / (3 µ₂)]: no phase error to fourth order. */
    double phase(const LatticeRow &row);
  } // namespace SmoothingStrength
} // namespace tombolo
