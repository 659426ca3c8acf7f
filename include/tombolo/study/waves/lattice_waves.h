// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/study/waves/bloch_operator.h>

#include <array>
#include <complex>
#include <vector>

namespace tombolo
{
  enum class WaveType
  {
    P,
    S
  };

  /** A plane wave p exp(i (k_x x + k_y y - ω t)) that the discretization carries unchanged. */
  struct LatticeMode
  {
    double wave_number = 0;    ///< k_x [1/L], within the first Brillouin zone
    double eigenvalue = 0;     ///< of the update operator [1/T^2]
    double frequency = 0;      ///< ω under central differences [1/T]
    double group_velocity = 0; ///< ∂ω/∂k_x [L/T]
    std::array<std::complex<double>, 2> polarization = {}; ///< p of v̂, of length one
    WaveType type = WaveType::P;                           ///< which p is closer to
    /** Of the short branch, whose phase and energy travel against each other. */
    bool is_short = false;
  };

  /**
   * The exact waves of a uniform lattice: the update operator's eigenvectors at (k_x, k_y), with
   * the frequencies ω = (2/Δt) asin(Δt √λ / 2) that central differences give them.
   */
  class LatticeWaves
  {
  public:
    /** The lattice on one side of @p update, the reduced update operator at @p k_y, with columns
     * @p spacing apart. */
    LatticeWaves(const BlochOperator &update, ChainSide side, double spacing, double k_y,
                 double time_step);

    /** The wave of a type at @p k_x. Throws RunError where it is not stable under the time step. */
    LatticeMode mode(double k_x, WaveType type) const;

    /** The wave at @p k_x whose polarization is nearest to that of @p neighbour, with its phase:
     * the same branch, a little farther. */
    LatticeMode continued(const LatticeMode &neighbour, double k_x) const;

    /** All waves of a frequency whose energy travels to a side. */
    std::vector<LatticeMode> outgoing(double frequency, ChainSide to) const;

    double spacing() const
    {
      return column_spacing;
    }

  private:
    struct Eigenpair
    {
      double value;
      std::array<std::complex<double>, 2> vector;
    };

    /** In ascending order. */
    std::array<Eigenpair, 2> eigenpairs(double k_x) const;
    LatticeMode complete(double k_x, unsigned int branch) const;

    BlochOperator update;
    double column_spacing, k_y, time_step;
  };
} // namespace tombolo
