// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/materials/material.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /** What an equation of state is evaluated at: n points, as arrays that do not overlap. n is a
   * multiple of n_lanes. The pressure is p = a(J) + b(J) E, with the internal energy E per unit of
   * initial volume [M/(L T^2)], zero in the initial state. */
  struct EquationOfStateBatch
  {
    unsigned int n;                ///< number of points
    const double *relative_volume; ///< J, volume over initial volume

    double *reference;          ///< out: a [M/(L T^2)]
    double *reference_modulus;  ///< out: -J da/dJ [M/(L T^2)]
    double *coefficient;        ///< out: b
    double *coefficient_change; ///< out: -J db/dJ
  };

  /**
   * The pressure of points by their volumes and internal energies, in batches, instead of that of
   * an elastic bulk modulus. The internal energy is E = e + W + Q: the pressure work e = -∫ p dJ,
   * the plastic work W and what artificial viscosity has dissipated, Q, all per unit of initial
   * volume; the elastic energy of the deviator is left out. With the trapezoidal rule for e, which
   * is that of the forces in the energy balance, p = a + b E is linear in p at the end of a step,
   * and solved exactly.
   */
  class EquationOfState
  {
  public:
    virtual ~EquationOfState() = default;

    /** The bulk modulus of the initial state [M/(L T^2)]. */
    virtual double bulk_modulus() const = 0;

    virtual void evaluate(EquationOfStateBatch &batch) const = 0;

    /** That of `Equation of state` in the section of a material; null for `none`. */
    static std::unique_ptr<const EquationOfState> create(const Entries &e);

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
  };

  template <>
  struct PluginKind<EquationOfState>
  {
    static constexpr const char *name = "equation of state";
  };
} // namespace tombolo
