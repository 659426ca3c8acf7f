// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/registry.h>

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

  /** The pressure of a point by its volume and its internal energy, in batches. */
  class EquationOfState
  {
  public:
    virtual ~EquationOfState() = default;

    /** The bulk modulus of the initial state [M/(L T^2)]. */
    virtual double bulk_modulus() const = 0;

    virtual void evaluate(EquationOfStateBatch &batch) const = 0;
  };

  template <>
  struct PluginKind<EquationOfState>
  {
    static constexpr const char *name = "equation of state";
  };
} // namespace tombolo
