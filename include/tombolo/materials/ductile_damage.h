// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/registry.h>

namespace tombolo
{
  /** What a strain at failure is evaluated at: n points, as arrays that do not overlap. n is a
   * multiple of n_lanes. */
  struct FailureStrainBatch
  {
    unsigned int n;            ///< number of points
    const double *triaxiality; ///< mean stress, tension positive, over the von Mises stress
    const double *rate;        ///< of the effective plastic strain [1/T]
    const double *temperature; ///< nullptr if not needed

    double *failure_strain; ///< out: effective plastic strain at failure, larger than zero
  };

  /** The plastic strain at which a material fails, in batches: damage grows by the plastic strain
   * over it. */
  class DuctileDamage
  {
  public:
    virtual ~DuctileDamage() = default;

    virtual bool depends_on_temperature() const = 0;

    virtual void evaluate(FailureStrainBatch &batch) const = 0;
  };

  template <>
  struct PluginKind<DuctileDamage>
  {
    static constexpr const char *name = "damage";
  };
} // namespace tombolo
