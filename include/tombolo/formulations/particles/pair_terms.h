// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/radial_table.h>
#include <tombolo/formulations/particles/row_pairs.h>
#include <tombolo/materials/material.h>
#include <tombolo/state/material_points.h>

#include <functional>
#include <vector>

namespace tombolo
{
  /**
   * What acts between pairs of particles with radial kernels beyond their stresses
   * (doc/pair_terms.md), each off unless chosen. With x_ij = x_i - x_j, v_ij = v_i - v_j, the
   * smoothing length h, the speed c of P waves and ∇φ_j = (m_j/ρ_i) ∇_iW_ij at the present
   * distance, whatever the gradients of the rows are corrected to, row i gives
   *
   * @verbatim
   *   artificial viscosity  ½ m_i (-α c µ + β µ²) |∇φ_j| x_ij/|x_ij|
   *                         for v_ij·x_ij < 0, with µ = h v_ij·x_ij/(x_ij² + 0.01 h²)
   *   artificial stress     -ε V_i (W(x_ij)/W(dp))^n σ_i⁺ ∇φ_j, σ⁺ the tensile principal stresses
   *   XSPH                  ½ ε m_i m_j W(x_ij)/ρ_i (v_j - v_i)/m_i
   * @endverbatim
   *
   * to particle i and the opposite to j (XSPH: with m_j in place of the last m_i). The sum of both
   * rows are the usual terms, with the mean of 1/ρ_i and 1/ρ_j where those have the inverse of a
   * mean density. The viscosity acts along x_ij and conserves linear and angular momentum; the
   * artificial stress (Gray, Monaghan, Swift 2001) conserves linear momentum only. XSPH is a
   * velocity with which positions are moved in addition; velocities do not know it. Its weights are
   * symmetric, so that it keeps the centre of mass and the angular momentum.
   *
   * Nodal arrays are at the address of local node 0, node_stride doubles a node, with current
   * ghosts where they are read; forces are added at ghosts too.
   */
  template <int dim>
  class PairTerms
  {
  public:
    /** None. */
    PairTerms() = default;
    /** Reads the section of a formulation, where `Configuration` stands too. Throws InputError. */
    explicit PairTerms(const Entries &e);
    /** Lengths and moduli: @p kernel is W over the distance, normalized, for the smoothing length
     * h, zero beyond @p radius; @p spacing is dp. */
    void initialize(const Material &material, const std::function<double(double)> &kernel,
                    double radius, double smoothing_length, double spacing);

    bool has_viscosity() const
    {
      return linear > 0. || quadratic > 0.;
    }
    bool has_artificial_stress() const
    {
      return stress_factor > 0.;
    }
    bool has_xsph() const
    {
      return xsph_factor > 0.;
    }
    bool is_on() const
    {
      return has_viscosity() || has_artificial_stress() || has_xsph();
    }

    /** Adds the viscous forces of the rows, and to @p power by row what they take per
     * unit time, which is not negative. */
    void add_viscous_force(const PairRows &rows, const double *position, const double *velocity,
                           double *force, double *power) const;

    /** Adds @p factor C @p direction, where -C v is the force of small @p velocity differences of
     * all pairs, those that separate too. */
    void apply_viscosity(const PairRows &rows, const double *position, const double *velocity,
                         const double *direction, double factor, double *force) const;

    /** Adds the forces of the artificial stress. @p points have the stresses of the rows. */
    void add_artificial_stress(const PairRows &rows, const MaterialPoints &points,
                               const double *position, double *force) const;

    /** Adds the momenta ½ ε m_i m_j W/ρ_i (v_j - v_i) that XSPH exchanges. */
    void add_exchanged_momentum(const PairRows &rows, const double *position,
                                const double *velocity, double *momentum) const;

  private:
    double linear = 0., quadratic = 0.;
    double stress_factor = 0., stress_exponent = 0.;
    double xsph_factor = 0.;

    double smoothing_length = 0., wave_speed = 0.;
    double inertia_ratio = 1.; // inertial over true density
    RadialTable stress_weight; // (W/W(dp))^n
    RadialTable kernel_value;  // W
  };
} // namespace tombolo
