// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/materials/equation_of_state.h>
#include <tombolo/materials/material.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * The pressure of points by an EquationOfState, in the place of that of an elastic bulk modulus.
   * The internal energy is E = e + W + Q: the pressure work e = -∫ p dJ, the plastic work W and
   * what artificial viscosity has dissipated, Q, all per unit of initial volume; the elastic energy
   * of the deviator is left out. With the trapezoidal rule for e, which is that of the forces in
   * the energy balance, p = a + b E is linear in p at the end of a step, and solved exactly.
   */
  class EnergyPressure
  {
  public:
    /** That of `Equation of state` in the section of a material; null for `none`. */
    static std::unique_ptr<const EnergyPressure> create(const Entries &e);

    explicit EnergyPressure(std::unique_ptr<const EquationOfState> equation);

    double bulk_modulus() const
    {
      return equation->bulk_modulus();
    }

    /** "pressure work", "viscous work" and "bulk modulus", the isentropic one. */
    std::vector<FieldDescription> fields() const;

    /** Replaces the mean stress of @p n points from @p begin on, which an elastic step with the
     * bulk modulus @p elastic_bulk has advanced. Fields begin at number @p first_field of the
     * internal variables of @p batch; @p plastic_work is W of its points. */
    void advance(const MaterialBatch &batch, unsigned int begin, unsigned int n,
                 unsigned int first_field, const double *plastic_work, double elastic_bulk) const;

    /** Elastic energy of the deviator per unit of current volume, of @p n points. */
    static void deviatoric_energy_density(unsigned int n, const double *const stress[6],
                                          double shear_modulus, double *energy_density);

  private:
    std::unique_ptr<const EquationOfState> equation;
  };
} // namespace tombolo
