// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/energy_accounts.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/materials/material.h>
#include <tombolo/state/material_points.h>

#include <string>
#include <vector>

namespace tombolo
{
  class Entries;

  /**
   * A stiffness of what alternates from node to node, which nodal gradients hardly see. The
   * residual of a particle is what φ makes of the positions less its own, zero for any affine
   * motion, and has the energy of a spring:
   *
   * @verbatim
   *   r_I = Σ_J φ_J(x_I) x_J - x_I,   E = Σ_I ½ k_I |r_I - s_I|²,   k_I = 16 c G V_I / h_I²
   * @endverbatim
   *
   * with the shear modulus G and the square h² of the length of the edges of cells around the
   * particle, in the mean. Where the particle flows, what is above the energy l V σ²/(6 G), with
   * the equivalent stress σ, the larger of those at the ends of the step, decays with the plastic
   * strain of the step over σ/(10 G): the slip s_I, which turns with the particle, takes it, and
   * what is lost is artificial.
   */
  class ZeroEnergyControl
  {
  public:
    ZeroEnergyControl() = default;
    /** `Zero-energy stiffness` and `Zero-energy limit`. */
    explicit ZeroEnergyControl(const Entries &e);

    /** The first entry that has not its default; empty: all have. */
    std::string changed_entry() const
    {
      return coefficient != default_coefficient ? "Zero-energy stiffness"
             : limit != default_limit           ? "Zero-energy limit"
                                                : "";
    }

    bool is_wanted() const
    {
      return coefficient > 0.;
    }
    /** Whether reset() and set_material() gave it something to do, on some rank. */
    bool is_on() const
    {
      return is_wanted() && shear_modulus > 0. && has_particles;
    }

    /** Of particles with these V_I [L^dim] and h_I² [L^2]. */
    void reset(const std::vector<double> &volumes, const std::vector<double> &squared_lengths);
    void set_material(const Material &material);

    /** What points must hold; none if off. */
    std::vector<FieldDescription> variables() const;
    /** Finds the fields in @p points. */
    void initialize(const MaterialPoints &points);

    /** Remembers the plastic strains and stresses of the particles @p first, a multiple of n_lanes,
     * to @p last - 1 before the step. */
    void begin(const MaterialPoints &points, unsigned int first, unsigned int last);
    /** Advances their slip, with the spins of the step by component and particle, and turns their
     * r_I, node_stride doubles each, into k_I (r_I - s_I). */
    void advance(MaterialPoints &points, unsigned int first, unsigned int last,
                 const double *const spin[3], double *residuals) const;

    /** Adds K v to @p force. */
    void apply_stiffness(const Stencils &shape, const NodalVector &velocity,
                         NodalVector &force) const;

    /** Adds to the equations of the row of @p particle, in the block from @p first on, what its
     * residual adds, with a secant of what is limited and the slip of before the step. */
    void add_tangent(const Stencils &shape, const MaterialPoints &points, unsigned int first,
                     unsigned int particle, const NodalVector &position,
                     CellEquations &equations) const;

    /** Adds "hourglass energy" and "viscous dissipation". */
    void account(const MaterialPoints &points, EnergyAccounts &accounts) const;

  private:
    double stiffness(const unsigned int i) const
    {
      return factor * volume[i] / squared_length[i];
    }
    /** How far |r - s| of n_lanes particles can be elastic. */
    struct Range
    {
      Lanes length = 1e100; ///< [L]
      Lanes beyond = 1.;    ///< share of what is longer that stays
    };
    /** Of those from number @p p of the block from @p first on, after their stress is known. */
    Range elastic_range(const MaterialPoints &points, unsigned int first, unsigned int p) const;
    /** Turns the slip of these particles by @p spin, takes it from their residuals, and lets it
     * take what is beyond their range. */
    void let_slip(MaterialPoints &points, unsigned int first, unsigned int p,
                  const double *const spin[3], Lanes (&elastic)[3]) const;

    static constexpr double default_coefficient = 0.9, default_limit = 0.001;

    double coefficient = 0., limit = 0.;
    double shear_modulus = 0., factor = 0.;
    std::vector<double> volume, squared_length;
    unsigned int slip_field = 0, energy_field = 0, loss_field = 0, strain_field = 0;
    bool can_flow = false, has_particles = false;
    std::vector<double> strain_before, squared_stress_before; ///< of the block at hand
  };
} // namespace tombolo
